"""Functions of time that drive a joint: sums of sines, sweeps and periodic waves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.fields import refuse_infinite, refuse_not_positive

__all__ = [
    "After",
    "Chirp",
    "Drive",
    "Sawtooth",
    "Sines",
    "Square",
    "multisine",
    "sine",
]

Array = NDArray[np.float64]
Drive = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Time (N,) [s] -> torque (N,) [N m] at the joint, or set-point (N,) in its own unit."""


@dataclass(frozen=True)
class Sines:
    """A sum of sines, ``O + sum_i A_i sin(2 pi f_i t + p_i)``; two of them add up with ``+``.

    A torque, or a path: it knows its derivatives.

    Parameters
    ----------
    amplitudes, frequencies, phases
        (n,) each, in N m (rad of a path), Hz and rad.
    offset
        O, as the amplitudes.
    """

    amplitudes: tuple[float, ...]
    frequencies: tuple[float, ...]
    phases: tuple[float, ...]
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Raise `RotatumError` for lists of different length and numbers that are not finite."""
        lengths = {len(self.amplitudes), len(self.frequencies), len(self.phases)}
        if len(lengths) != 1:
            raise RotatumError(
                "amplitudes, frequencies and phases of a sum of sines differ in length",
                value=(len(self.amplitudes), len(self.frequencies), len(self.phases)),
            )
        refuse_infinite(
            "sines",
            amplitudes=self.amplitudes,
            frequencies=self.frequencies,
            phases=self.phases,
            offset=self.offset,
        )

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        torque = np.full_like(t, self.offset)
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
            self.offset + other.offset,
        )

    def position(self, time: ArrayLike) -> Array:
        """Return the value (N,) [rad] at times (N,) [s]."""
        return self(time)

    def velocity(self, time: ArrayLike) -> Array:
        """Return the first derivative (N,) [rad/s] at times (N,) [s]."""
        return self._derivative(time, 1)

    def acceleration(self, time: ArrayLike) -> Array:
        """Return the second derivative (N,) [rad/s^2] at times (N,) [s]."""
        return self._derivative(time, 2)

    def _derivative(self, time: ArrayLike, order: int) -> Array:
        rates = [2.0 * np.pi * f for f in self.frequencies]
        grown = tuple(a * w**order for a, w in zip(self.amplitudes, rates, strict=True))
        # each derivative leads by a quarter of a turn
        ahead = tuple(p + 0.5 * np.pi * order for p in self.phases)
        return Sines(grown, self.frequencies, ahead)(time)


def sine(amplitude: float, frequency: float, phase: float = 0.0, offset: float = 0.0) -> Sines:
    """Return one sine of `amplitude` [N m] at `frequency` [Hz], starting at `phase` [rad]."""
    return Sines((amplitude,), (frequency,), (phase,), offset)


def multisine(
    *, rms: float, low: float, high: float, count: int, seed: int, offset: float = 0.0
) -> Sines:
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
    offset
        Added to the sum [N m].
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
        offset,
    )


@dataclass(frozen=True)
class After:
    """Rest, then a drive: zero before `start` [s], `torque` of the time since from there."""

    start: float
    torque: Drive

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        return np.where(t < self.start, 0.0, self.torque(np.maximum(t - self.start, 0.0)))


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency runs linearly from `low` to `high` in `seconds`, then stays.

    ``O + A sin(2 pi (low t + (high - low) t^2 / (2 seconds)))`` up to `seconds`, continued in
    phase.
    """

    amplitude: float  # A [N m]
    low: float  # [Hz]
    high: float  # [Hz]
    seconds: float  # duration of the sweep [s]
    offset: float = 0.0  # O [N m]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for a sweep without a positive duration, and infinite numbers."""
        refuse_not_positive("chirp", seconds=self.seconds)
        refuse_infinite(
            "chirp", amplitude=self.amplitude, low=self.low, high=self.high, offset=self.offset
        )

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        t = np.asarray(time, dtype=np.float64)
        swept = np.minimum(t, self.seconds)
        slope = (self.high - self.low) / self.seconds
        turns = self.low * swept + 0.5 * slope * swept * swept + self.high * (t - swept)
        wave: Array = self.offset + self.amplitude * np.sin(2.0 * np.pi * turns)
        return wave


@dataclass(frozen=True)
class _Wave:
    """A periodic wave: its size, how often a second, and where in its period it starts."""

    amplitude: float  # A [N m]
    frequency: float  # f [Hz]
    phase: float = 0.0  # p [rad]
    offset: float = 0.0  # O [N m]

    def __post_init__(self) -> None:
        """Raise `RotatumError` unless the frequency is positive and all numbers are finite."""
        kind = type(self).__name__.lower()
        refuse_not_positive(kind, frequency=self.frequency)
        refuse_infinite(kind, amplitude=self.amplitude, phase=self.phase, offset=self.offset)

    def _turns(self, time: ArrayLike) -> Array:
        t = np.asarray(time, dtype=np.float64)
        return self.frequency * t + self.phase / (2.0 * np.pi)


@dataclass(frozen=True)
class Sawtooth(_Wave):
    """A ramp that starts over: from 0 up to `amplitude`, down at once to its negative, and so on.

    ``O + 2 A (x - floor(x + 1/2))``, ``x = f t + p / (2 pi)``.
    """

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        turns = self._turns(time)
        ramp: Array = turns - np.floor(turns + 0.5)
        return 2.0 * self.amplitude * ramp + self.offset


@dataclass(frozen=True)
class Square(_Wave):
    """A square wave: `amplitude` for the first half of each period, its negative for the second.

    About `offset`; the first period began `phase` / (2 pi f) before t = 0.
    """

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        turns = self._turns(time)
        high = turns - np.floor(turns) < 0.5
        return self.offset + np.where(high, self.amplitude, -self.amplitude)
