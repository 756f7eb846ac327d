"""Functions of time that drive a joint: torques and set-points, reproducible from a seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError

Drive = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Time (N,) [s] -> torque (N,) [N m] at the joint, or set-point (N,) in its own unit."""


@dataclass(frozen=True)
class Sines:
    """A sum of sines, ``sum_i A_i sin(2 pi f_i t + p_i)``; two of them add up with ``+``.

    Parameters
    ----------
    amplitudes, frequencies, phases
        (n,) each, in N m, Hz and rad.
    """

    amplitudes: tuple[float, ...]
    frequencies: tuple[float, ...]
    phases: tuple[float, ...]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for lists of different length."""
        lengths = {len(self.amplitudes), len(self.frequencies), len(self.phases)}
        if len(lengths) != 1:
            raise RotatumError(
                "amplitudes, frequencies and phases of a sum of sines differ in length",
                value=(len(self.amplitudes), len(self.frequencies), len(self.phases)),
            )

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        torque = np.zeros_like(t)
        # a loop over the few sines keeps memory at one array however long the log
        for a, f, p in zip(self.amplitudes, self.frequencies, self.phases, strict=True):
            torque += a * np.sin(2.0 * np.pi * f * t + p)
        return torque

    def __add__(self, other: Sines) -> Sines:
        """Return the sum of sines holding the terms of both."""
        return Sines(
            self.amplitudes + other.amplitudes,
            self.frequencies + other.frequencies,
            self.phases + other.phases,
        )


def sine(amplitude: float, frequency: float, phase: float = 0.0) -> Sines:
    """Return one sine of `amplitude` [N m] at `frequency` [Hz], starting at `phase` [rad]."""
    return Sines((amplitude,), (frequency,), (phase,))


def multisine(*, rms: float, low: float, high: float, count: int, seed: int) -> Sines:
    """Return `count` sines of equal amplitude and random phase, evenly spread over a band.

    Parameters
    ----------
    rms
        Root mean square of the sum [N m]; each sine has amplitude ``rms sqrt(2 / count)``.
    low, high
        First and last frequency [Hz], ``0 < low <= high``.
    count
        Number of sines, at least 1.
    seed
        Seed of the phases.
    """
    if not 0.0 < low <= high:
        raise RotatumError(
            "a multisine needs 0 < low <= high", value=(low, high), where="multisine band [Hz]"
        )
    if count < 1:
        raise RotatumError("a multisine needs at least one sine", value=count, where="count")
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, count)
    return Sines(
        (rms * float(np.sqrt(2.0 / count)),) * count,
        tuple(np.linspace(low, high, count).tolist()),
        tuple(phases.tolist()),
    )


@dataclass(frozen=True)
class After:
    """Rest, then a drive: zero before `start` [s], `torque` of the time since from there."""

    start: float
    torque: Drive

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        return np.where(t < self.start, 0.0, self.torque(np.maximum(t - self.start, 0.0)))


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency runs linearly from `low` to `high` in `seconds`, then stays.

    ``A sin(2 pi (low t + (high - low) t^2 / (2 seconds)))`` up to `seconds`, continued in phase.
    """

    amplitude: float  # A [N m]
    low: float  # [Hz]
    high: float  # [Hz]
    seconds: float  # duration of the sweep [s]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for a sweep without a positive duration."""
        if not self.seconds > 0.0:
            raise RotatumError(
                "a chirp needs a positive duration", value=self.seconds, where="seconds"
            )

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        swept = np.minimum(t, self.seconds)
        slope = (self.high - self.low) / self.seconds
        turns = self.low * swept + 0.5 * slope * swept * swept + self.high * (t - swept)
        return self.amplitude * np.sin(2.0 * np.pi * turns)


@dataclass(frozen=True)
class Sawtooth:
    """A ramp that starts over: from 0 up to `amplitude`, down at once to its negative, and so on.

    ``2 A (x - floor(x + 1/2))``, ``x = f t``.
    """

    amplitude: float  # A [N m]
    frequency: float  # f [Hz]

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        turns = self.frequency * np.asarray(time, dtype=np.float64)
        ramp: NDArray[np.float64] = turns - np.floor(turns + 0.5)
        return 2.0 * self.amplitude * ramp


@dataclass(frozen=True)
class Square:
    """A square wave: `amplitude` for the first half of each period, its negative for the second."""

    amplitude: float  # [N m]
    frequency: float  # [Hz]

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        turns = self.frequency * np.asarray(time, dtype=np.float64)
        return np.where(turns - np.floor(turns) < 0.5, self.amplitude, -self.amplitude)


@dataclass(frozen=True)
class Ramps:
    """A smooth path through points: a set-point that is swept, and held where two are equal.

    Between two points the value follows ``10 u^3 - 15 u^4 + 6 u^5``, which begins and ends without
    velocity and acceleration; before the first and after the last it stays.

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
        if np.any(np.diff(self.times) <= 0.0):
            raise RotatumError("the times of ramps must grow", value=self.times, where="times")

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the value (N,) at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        path = np.full_like(t, self.values[0])
        knots = list(zip(self.times, self.values, strict=True))
        for (begin, low), (end, high) in pairwise(knots):
            u = np.clip((t - begin) / (end - begin), 0.0, 1.0)
            path += (high - low) * u * u * u * (10.0 + u * (6.0 * u - 15.0))
        return path


def hold(value: float) -> Ramps:
    """Return a drive that does not change."""
    return Ramps((0.0,), (value,))
