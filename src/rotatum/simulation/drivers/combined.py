"""Drives made of drives: their sum, and their multiple."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.fields import refuse_infinite
from rotatum.simulation.drivers.waves import Drive

__all__ = ["Scaled", "Together"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Together:
    """The sum of drives of any kind, ``sum_i drive_i(t)``."""

    drives: tuple[Drive, ...]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for no drive."""
        if not self.drives:
            raise RotatumError("a sum needs at least one drive", where="sum.of")

    def __call__(self, time: ArrayLike) -> Array:
        """Return the sum (N,) at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        total = np.zeros_like(t)
        for drive in self.drives:
            total += drive(t)
        return total


@dataclass(frozen=True)
class Scaled:
    """A drive times a factor."""

    factor: float
    drive: Drive

    def __post_init__(self) -> None:
        """Raise `RotatumError` for a factor that is not finite."""
        refuse_infinite("scaled", factor=self.factor)

    def __call__(self, time: ArrayLike) -> Array:
        """Return the multiple (N,) at times (N,) [s]."""
        return self.factor * self.drive(np.asarray(time, dtype=np.float64))
