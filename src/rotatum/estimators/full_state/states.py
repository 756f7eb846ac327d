"""What an observer of the full state tells at a sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["FullState"]

Array = NDArray[np.float64]


class FullState:
    """What one ``StateObserver.update`` returns: (n,) arrays in the order of the device's joints.

    The arrays are filled anew by the next update.
    """

    def __init__(self, records: NDArray[np.void], zero: Array) -> None:
        self._records = records
        self._zero = zero

    def __getitem__(self, field: str) -> Array:
        return np.asarray(self._records[field])

    @property
    def q(self) -> Array:
        """Link positions [rad]."""
        return self["q_hat"]

    @property
    def dq(self) -> Array:
        """Link velocities [rad/s]."""
        return self["dq_hat"]

    @property
    def theta(self) -> Array:
        """Motor positions at the joints [rad]."""
        return self["theta_hat"] - self._zero

    @property
    def dtheta(self) -> Array:
        """Motor velocities at the joints [rad/s]."""
        return self["dtheta_hat"]

    @property
    def deflection(self) -> Array:
        """Deflections q - theta, from the spring's zero [rad]."""
        return self["deflection"]

    @property
    def torque(self) -> Array:
        """Elastic torques [N m], growing with the deflection, without the spring's damping."""
        return self["torque"]

    @property
    def transmission_torque(self) -> Array:
        """Elastic torques and the springs' damping [N m]."""
        return self["transmission_torque"]

    @property
    def status(self) -> NDArray[np.int64]:
        """Status bits, see ``rotatum.kernels.status``."""
        return np.asarray(self._records["status"])
