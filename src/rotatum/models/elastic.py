"""An elastic law at one deflection: its torque and three derivatives, whoever knows it."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from rotatum.models.transmission import Transmission

__all__ = ["Elastic", "ElasticLaw", "KnownLaw"]


class Elastic(NamedTuple):
    """A transmission at a deflection.

    Parameters
    ----------
    torque : tau_e [N m].
    stiffness : sigma, its derivative by the deflection [N m/rad].
    slope : dsigma/dphi [N m/rad^2].
    curvature : d2sigma/dphi2 [N m/rad^3].
    offset : what acts on its motor beside the spring, ``B theta'' + D theta' - tau_e - offset = u``
        [N m].
    """

    torque: float
    stiffness: float
    slope: float
    curvature: float
    offset: float = 0.0


class ElasticLaw(Protocol):
    """Something that knows a transmission: a law with its constants, or an estimate."""

    def evaluate(self, phi: float) -> Elastic:
        """Return the transmission at q - theta [rad]."""


class KnownLaw:
    """The law of a device file, without a set-point.

    Parameters
    ----------
    transmission
        Its law, constants and preload.

    Raises `DeviceError` for a transmission without a law.
    """

    def __init__(self, transmission: Transmission) -> None:
        self._law = transmission.model
        self._constants = transmission.constants.tolist()
        self._preload = transmission.preload

    def evaluate(self, phi: float) -> Elastic:
        """Return the transmission at q - theta [rad]."""
        law, c, x = self._law, self._constants, phi + self._preload
        return Elastic(
            law.torque(c, x, 0.0),
            law.stiffness(c, x, 0.0),
            law.slope(c, x, 0.0),
            law.curvature(c, x, 0.0),
        )
