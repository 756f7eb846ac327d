"""What one update of all joints returns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.groups import Group
from rotatum.kernels.status import VERDICTS


class Readings:
    """What one ``Estimator.update`` returns: arrays over the device's joints, in its order.

    ``readings["stiffness"]`` (or any scalar field of ``Reading``) is an ``(n,)`` array; the usual
    ones are properties. The arrays are filled anew by the next update.
    """

    def __init__(self, groups: Sequence[Group], joints: int) -> None:
        self._groups = groups
        self._joints = joints

    def __getitem__(self, field: str) -> NDArray[Any]:
        if len(self._groups) == 1:
            return np.asarray(self._groups[0].out[field])
        first = self._groups[0].out[field]
        values = np.empty(self._joints, first.dtype)
        for group in self._groups:
            values[group.places] = group.out[field]
        return values

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Stiffness, N m/rad."""
        return self["stiffness"]

    @property
    def stiffness_std(self) -> NDArray[np.float64]:
        """Its standard deviation, N m/rad."""
        return self["stiffness_std"]

    @property
    def torque(self) -> NDArray[np.float64]:
        """Elastic torque from the fitted law, N m."""
        return self["torque"]

    @property
    def dstiffness(self) -> NDArray[np.float64]:
        """Derivative of the stiffness by deflection, N m/rad^2."""
        return self["dstiffness"]

    @property
    def status(self) -> NDArray[np.int64]:
        """Status bits, see ``rotatum.kernels.status``."""
        return self["status"]

    @property
    def verdict(self) -> tuple[str, ...]:
        """One of ``starved``, ``converging``, ``informative``, ``inconsistent`` per joint."""
        return tuple(VERDICTS[int(v)] for v in self["verdict"])
