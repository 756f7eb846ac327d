"""Torques that move a joint: functions of time, reproducible from a seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError

Torque = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Time (N,) [s] -> torque (N,) [N m], joint side."""


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
    """Rest, then another torque: zero before `start` [s], `torque` of the time since from there."""

    start: float
    torque: Torque

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
