"""One transmission's share of a joint's result, as plots need it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.columns import setpoint_scale
from rotatum.evaluation.parts import PartEstimate
from rotatum.kernels.status import PRIOR, SETTLING
from rotatum.models.transmission import Transmission
from rotatum.report.view import View

__all__ = ["Part", "law", "parts"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """A transmission's result ready to be drawn; a series or serial joint has one.

    Parameters
    ----------
    shown : the joint.
    place : 0, or 1 for the antagonist's.
    """

    shown: View
    place: int

    @property
    def result(self) -> PartEstimate:
        """What the run says of it."""
        return self.shown.estimate.parts[self.place]

    @property
    def paired(self) -> bool:
        """Whether the joint has another one."""
        return len(self.shown.estimate.parts) > 1

    @property
    def name(self) -> str:
        """Its name beside the other's, or nothing."""
        return f"transmission {self.result.end}" if self.paired else ""

    @property
    def spring(self) -> Transmission:
        """As the device file describes it."""
        return self.shown.joint.transmissions[self.place]

    @cached_property
    def status(self) -> NDArray[np.int64]:
        """Status bits of each sample."""
        if not self.paired:
            return self.shown.status
        records = self.shown.estimate.records
        return np.asarray(records["part_status"][self.shown.order, self.place])

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Whether the data, and not the prior, say something about its stiffness."""
        return np.asarray((self.status & PRIOR) == 0)

    def field(self, name: str) -> Array:
        """Return a field of the readings at each sample.

        Parameters
        ----------
        name : of a field of ``Reading``, which a ``PairReading`` has as ``part_`` and the name.
        """
        if not self.paired:
            return self.shown.field(name)
        records = self.shown.estimate.records
        return np.asarray(records[f"part_{name}"][self.shown.order, self.place], np.float64)

    def learned(self, name: str) -> Array:
        """Return a field; NaN while it rests on the prior.

        Parameters
        ----------
        name : as for `field`.
        """
        return np.where(self.known, self.field(name), np.nan)

    def row(self, name: str) -> Array:
        """Return a field of the rows; NaN while there was none.

        Parameters
        ----------
        name : "row_torque", "row_fit" or "deflection".
        """
        return np.where(self.status & SETTLING, np.nan, self.field(name))

    def truth(self, name: str) -> Array | None:
        """Return the log's truth at each sample, None where it does not know.

        Parameters
        ----------
        name : "stiffness" or "torque".
        """
        return self.shown.truth(f"{name}{self.result.end}")


def parts(shown: View) -> list[Part]:
    """Return the transmissions of a joint, the agonist's first.

    Parameters
    ----------
    shown : the joint.
    """
    return [Part(shown, place) for place in range(len(shown.estimate.parts))]


def law(part: Part, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
    """Return the elastic torque of the final coefficients [N m], arguments broadcast.

    ``sum_ij c_ij phi^i (s - s0)^j``, s0 the middle of the set-point's range.

    Parameters
    ----------
    part : the transmission.
    phi : deflections [rad].
    setpoint : set-points in the unit of the law; only looked at where the basis has powers of it.
    """
    deflection = np.asarray(phi, np.float64)
    s = np.asarray(setpoint, np.float64) - setpoint_scale(part.shown.joint).middle
    powers = part.shown.estimate.powers
    own = part.result.coefficients[len(part.result.coefficients) - len(powers) :]
    terms = (
        c * deflection**power.deflection * s**power.setpoint
        for c, power in zip(own, powers, strict=True)
    )
    return np.asarray(sum(terms, np.zeros(np.broadcast(deflection, s).shape)))
