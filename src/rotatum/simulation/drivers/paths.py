"""Where a joint is told to be: positions over time with their velocity and acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.fields import (
    refuse_infinite,
    refuse_not_growing,
    refuse_not_positive,
)

__all__ = ["FadeIn", "Path", "Ramps", "Superposed", "hold"]

Array = NDArray[np.float64]


@runtime_checkable
class Path(Protocol):
    """A position over time that knows its derivatives; also a drive, its value the position."""

    def __call__(self, time: ArrayLike, /) -> Array:
        """Return the position (N,) [rad] at times (N,) [s]."""

    def position(self, time: ArrayLike, /) -> Array:
        """Return the position (N,) [rad] at times (N,) [s]."""

    def velocity(self, time: ArrayLike, /) -> Array:
        """Return the velocity (N,) [rad/s] at times (N,) [s]."""

    def acceleration(self, time: ArrayLike, /) -> Array:
        """Return the acceleration (N,) [rad/s^2] at times (N,) [s]."""


@dataclass(frozen=True)
class Ramps:
    """A quintic path through points, from rest to rest, and held where two are equal.

    Between two points the value follows ``10 u^3 - 15 u^4 + 6 u^5``, which begins and ends without
    velocity and acceleration; before the first and after the last it stays. For positions and for
    set-points that are swept.

    >>> Ramps((0.0, 10.0, 20.0), (0.10, 0.08, 0.10))([0.0, 5.0, 10.0, 30.0])
    array([0.1 , 0.09, 0.08, 0.1 ])

    Parameters
    ----------
    times
        (n,) s, growing.
    values
        (n,) at those times.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for lists that differ in length, and times that do not grow."""
        if len(self.times) != len(self.values) or not self.times:
            raise RotatumError(
                "times and values of ramps must be as many, at least one",
                value=(len(self.times), len(self.values)),
            )
        refuse_infinite("ramps", times=self.times, values=self.values)
        refuse_not_growing("ramps", "times", self.times)

    def __call__(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        path = np.full_like(t, self.values[0])
        for begin, end, rise in self._pieces():
            u = np.clip((t - begin) / (end - begin), 0.0, 1.0)
            path += rise * u * u * u * (10.0 + u * (6.0 * u - 15.0))
        return path

    def position(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        return self(time)

    def velocity(self, time: ArrayLike) -> Array:
        """Return the first derivative (N,) [1/s] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        rate = np.zeros_like(t)
        for begin, end, rise in self._pieces():
            u = np.clip((t - begin) / (end - begin), 0.0, 1.0)
            rate += 30.0 * rise / (end - begin) * (u * (1.0 - u)) ** 2
        return rate

    def acceleration(self, time: ArrayLike) -> Array:
        """Return the second derivative (N,) [1/s^2] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        change = np.zeros_like(t)
        for begin, end, rise in self._pieces():
            u = np.clip((t - begin) / (end - begin), 0.0, 1.0)
            change += 60.0 * rise / (end - begin) ** 2 * u * (1.0 - u) * (1.0 - 2.0 * u)
        return change

    def _pieces(self) -> list[tuple[float, float, float]]:
        """Return begin [s], end [s] and rise of each piece."""
        knots = zip(self.times, self.values, strict=True)
        return [(begin, end, high - low) for (begin, low), (end, high) in pairwise(knots)]


def hold(value: float) -> Ramps:
    """Return a drive, or path, that does not change."""
    return Ramps((0.0,), (value,))


@dataclass(frozen=True)
class FadeIn:
    """A path that is entered smoothly from rest: ``rest + s(t) (path(t) - rest)``.

    s rises from 0 to 1 between `start` and `start + seconds` as `Ramps` do, so that position,
    velocity and acceleration have no jump even where the path is in full motion.
    """

    path: Path
    seconds: float  # [s]
    start: float = 0.0  # [s]
    rest: float = 0.0  # as the path

    def __post_init__(self) -> None:
        """Raise `RotatumError` unless it takes some time, and all numbers are finite."""
        refuse_not_positive("fade-in", seconds=self.seconds)
        refuse_infinite("fade-in", start=self.start, rest=self.rest)

    @property
    def _share(self) -> Ramps:
        return Ramps((self.start, self.start + self.seconds), (0.0, 1.0))

    def __call__(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        away: Array = self._share(time) * (self.path.position(time) - self.rest)
        return self.rest + away

    def position(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        return self(time)

    def velocity(self, time: ArrayLike) -> Array:
        """Return the first derivative (N,) at times (N,) [s]."""
        share = self._share
        rate: Array = share.velocity(time) * (self.path.position(time) - self.rest)
        return rate + share(time) * self.path.velocity(time)

    def acceleration(self, time: ArrayLike) -> Array:
        """Return the second derivative (N,) at times (N,) [s]."""
        share = self._share
        change: Array = share.acceleration(time) * (self.path.position(time) - self.rest)
        change = change + 2.0 * share.velocity(time) * self.path.velocity(time)
        return change + share(time) * self.path.acceleration(time)


@dataclass(frozen=True)
class Superposed:
    """A weighted sum of paths, ``sum_i w_i path_i(t)``.

    Parameters
    ----------
    paths
        (n,), at least one.
    weights
        (n,); none: all 1.
    """

    paths: tuple[Path, ...]
    weights: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Raise `RotatumError` for no path, or another number of weights than paths."""
        if not self.paths or len(self.weights) not in (0, len(self.paths)):
            raise RotatumError(
                "a sum of paths needs at least one, and as many weights or none",
                value=(len(self.paths), len(self.weights)),
            )
        refuse_infinite("sum", weights=self.weights)

    def __call__(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        return self._sum([path.position(time) for path in self.paths])

    def position(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        return self(time)

    def velocity(self, time: ArrayLike) -> Array:
        """Return the first derivative (N,) at times (N,) [s]."""
        return self._sum([path.velocity(time) for path in self.paths])

    def acceleration(self, time: ArrayLike) -> Array:
        """Return the second derivative (N,) at times (N,) [s]."""
        return self._sum([path.acceleration(time) for path in self.paths])

    def _sum(self, parts: list[Array]) -> Array:
        weights = self.weights or (1.0,) * len(parts)
        total = np.zeros_like(parts[0])
        for weight, part in zip(weights, parts, strict=True):
            total += weight * part
        return total
