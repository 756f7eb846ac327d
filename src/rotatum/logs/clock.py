"""The sample clock of a log: its period, how even it is, and where samples are missing."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

__all__ = ["Clock", "ClockWatch", "Gap", "median_period"]

_KEPT_GAPS = 1000  # gaps remembered one by one; beyond, only counted (constant memory)
_GAP = 1.5  # a step longer than this many periods has lost at least one sample
_UNEVEN = 0.02  # jitter worth a warning: the methods assume one period


@dataclass(frozen=True)
class Gap:
    """A hole in the log.

    Parameters
    ----------
    start : time of the last sample before it [s].
    seconds : from there to the next sample [s].
    missing : samples lost.
    """

    start: float
    seconds: float
    missing: int


@dataclass(frozen=True)
class Clock:
    """What is known of a log's clock.

    Parameters
    ----------
    period : median of the positive steps [s].
    jitter : standard deviation of step / period about its rounding (0.01 = 1 % of the period).
    gaps : the holes, the first thousand of them.
    gap_count : how many holes there are in all.
    missing : samples lost in all of them.
    repeated : steps of zero.
    backwards : steps below zero.
    invalid : samples whose time is not a finite number.
    """

    period: float
    jitter: float = 0.0
    gaps: tuple[Gap, ...] = ()
    gap_count: int = 0
    missing: int = 0
    repeated: int = 0
    backwards: int = 0
    invalid: int = 0

    def describe(self) -> list[str]:
        """Return a sentence for everything about the clock that a user should know."""
        said: list[str] = []
        if self.gap_count:
            longest = max(self.gaps, key=lambda gap: gap.seconds)
            said.append(
                f"the clock has {_times(self.gap_count, 'gap')}, {self.missing} samples missing in "
                f"all; the longest lasts {longest.seconds:.6g} s from {longest.start:.6g} s"
            )
        if self.repeated:
            said.append(f"the clock repeats itself: {_times(self.repeated, 'step')} of zero")
        if self.backwards:
            said.append(f"the clock runs backwards: {_times(self.backwards, 'step')} below zero")
        if self.invalid:
            said.append(f"{_times(self.invalid, 'sample')} without a time")
        if self.jitter > _UNEVEN:
            said.append(
                f"the clock is uneven: its steps scatter by {100.0 * self.jitter:.1f} % "
                f"of the period of {self.period:.6g} s"
            )
        return said


def median_period(time: NDArray[np.float64]) -> float | None:
    """Return the median positive step of a clock, or None if it mostly does not increase.

    Parameters
    ----------
    time : (N,) [s].
    """
    steps = np.diff(time)
    positive = steps[steps > 0.0]
    if positive.size == 0 or 2 * positive.size < steps.size:
        return None
    return float(np.median(positive))


class ClockWatch:
    """Follows a clock piece by piece, in constant memory.

    Parameters
    ----------
    period : the log's period [s].
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._last: float | None = None
        self._gaps: list[Gap] = []
        self._gap_count = self._missing = 0
        self._repeated = self._backwards = self._invalid = 0
        self._steps = 0
        self._sum = self._squares = 0.0

    def add(self, time: NDArray[np.float64]) -> None:
        """Take the next piece of the clock, (N,) [s]."""
        valid = np.isfinite(time)
        if not valid.all():
            self._invalid += int(time.size - np.count_nonzero(valid))
            time = time[valid]
        if self._last is not None:
            time = np.concatenate(([self._last], time))
        if time.size:
            self._last = float(time[-1])
        steps = np.diff(time)
        self._repeated += int(np.count_nonzero(steps == 0.0))
        self._backwards += int(np.count_nonzero(steps < 0.0))
        self._add_gaps(time, steps)
        in_periods = steps[steps > 0.0] / self._period
        off = in_periods - np.rint(in_periods)
        self._steps += int(off.size)
        self._sum += float(off.sum())
        self._squares += float(np.square(off).sum())

    def clock(self) -> Clock:
        """Return what has been seen so far."""
        mean = self._sum / self._steps if self._steps else 0.0
        variance = self._squares / self._steps - mean * mean if self._steps else 0.0
        return Clock(
            period=self._period,
            jitter=sqrt(max(variance, 0.0)),
            gaps=tuple(self._gaps),
            gap_count=self._gap_count,
            missing=self._missing,
            repeated=self._repeated,
            backwards=self._backwards,
            invalid=self._invalid,
        )

    def _add_gaps(self, time: NDArray[np.float64], steps: NDArray[np.float64]) -> None:
        """Note the steps that are too long."""
        at = np.flatnonzero(steps > _GAP * self._period)
        if not at.size:
            return
        missing = np.rint(steps[at] / self._period).astype(np.int64) - 1
        self._gap_count += int(at.size)
        self._missing += int(missing.sum())
        room = _KEPT_GAPS - len(self._gaps)
        for place, lost in zip(at[:room].tolist(), missing[:room].tolist(), strict=True):
            self._gaps.append(Gap(float(time[place]), float(steps[place]), int(lost)))


def _times(count: int, noun: str) -> str:
    """Write a count with its noun."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
