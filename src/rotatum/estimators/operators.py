"""The operators that rows go through: their weights, delays, and what noise they let pass."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.observers.figures import fallen
from rotatum.estimators.observers.jerk import JerkObserver, jerk_observer

Array = NDArray[np.float64]

EXPONENTIAL = "exponential"
WINDOW = "window"
OBSERVER = "observer"
REACH = 12.0
"""What a smoothed observer looks at on either side of its instant, in 1 / cutoff: 99 % of it."""
CENTRED = {
    0: (0.0, 1.0, 0.0),
    1: (0.5, 0.0, -0.5),
    2: (1.0, -2.0, 1.0),
    3: (0.5, -1.0, 0.0, 1.0, -0.5),
}
"""Centred derivatives of order 0 to 3, newest first, times T^order; 1 and 2 are a hat's."""


@dataclass(frozen=True)
class Operator:
    """A causal linear operator with as much gain as a mean has.

    Args:
        kind: ``"exponential"``: ``(cutoff / (s + cutoff))^order``; ``"window"``: weights
            ``(u (1 - u))^order``, u from 0 to 1 over the last ``window`` seconds; ``"observer"``:
            of position and its derivatives (``observers.jerk``).
        order: 2 or 3 poles; power 2 to 5 of the window; samples by which the observer is late.
        width: cutoff in rad/s, of an observer infinite where it is deadbeat; or window in s.
        period: T, s.
        derivative: 1: the derivative of the window instead (menard2013), whose mean is 0.
        every: samples from one row to the next; 1 with poles.
    """

    kind: str
    order: int
    width: float
    period: float
    derivative: int = 0
    every: int = 1

    @property
    def cutoff(self) -> float:
        """Bandwidth, rad/s: of a window, that of the poles with its delay."""
        if self.kind == OBSERVER:
            return self.observer.bandwidth
        return self.width if self.kind == EXPONENTIAL else 4.0 / self.width

    @property
    def passband(self) -> float:
        """Frequency where what the rows are made of is 3 dB down, Hz; Nyquist's: nowhere below.

        Of the slope of a window, beside the signal's own derivative.
        """
        if self.kind == OBSERVER:
            return self.cutoff / (2.0 * math.pi)
        if self.kind == EXPONENTIAL:
            return self.width * math.sqrt(2.0 ** (1.0 / self.order) - 1.0) / (2.0 * math.pi)
        weights = replace(self, derivative=0).weights()
        steps = np.arange(len(weights))

        def gain(angles: Array) -> Array:
            return np.asarray(np.abs(np.exp(-1j * np.outer(angles, steps)) @ weights))

        return fallen(gain, 0.1 / len(weights)) / (2.0 * math.pi * self.period)

    @property
    def observer(self) -> JerkObserver:
        """The observer, for noise of 1 rad."""
        return _observer(self.width, self.order, self.period)

    @property
    def pole(self) -> float:
        """Of an exponential operator, exp(-cutoff T)."""
        return math.exp(-self.width * self.period)

    @property
    def length(self) -> int:
        """Samples under a window."""
        return round(self.width / self.period) - 1

    @property
    def delay(self) -> float:
        """Seconds by which a row's centre lags behind its last sample, the hat's included."""
        if self.kind == WINDOW:
            return 0.5 * (self.length + 1) * self.period
        if self.kind == OBSERVER:
            return self.order * self.period
        lag = self.pole / (1.0 - self.pole)
        return (1.0 + self.order * lag) * self.period

    @property
    def made_of(self) -> tuple[float, float]:
        """Seconds back from a row's last sample between which lies what it is made of.

        Of a window all of it; of poles, and of an observer that smooths, 99 %: twice the delay back
        to now, and 12 / cutoff on either side of its instant.
        """
        if self.kind == OBSERVER and math.isfinite(self.width):
            reach = REACH / self.width
            return self.delay + reach, max(0.0, self.delay - reach)
        return 2.0 * self.delay, 0.0

    @property
    def row_period(self) -> float:
        """Seconds from one row to the next."""
        return self.every * self.period

    def weights(self) -> Array:
        """Weights of a window, newest first; their absolute values add up to 1.

        ``w(m) = (u (1 - u))^order`` at the ``length`` inner points of the grid; with ``derivative``
        its central difference on that grid: see ``kernels.window`` for why these are exact.
        """
        n = self.length + 1
        u = np.arange(n + 1) / n
        bump = (u * (1.0 - u)) ** self.order
        if self.derivative:
            # Newest first: later in time is towards the front.
            inner = bump[:-2] - bump[2:]
        else:
            inner = bump[1:-1]
        found: Array = inner / np.abs(inner).sum()
        return found

    def response(self) -> Array:
        """Impulse response, newest first; of poles as long as it matters (1e-9 of its sum)."""
        if self.kind == WINDOW:
            return self.weights()
        a, n = self.pole, 1
        while math.exp(-self.width * self.period * n) * (1.0 + n * (1.0 - a)) ** 2 > 1e-9:
            n = n + 1 + n // 2
        found = np.zeros(n)
        found[0] = 1.0
        for _ in range(self.order):
            for k in range(n):
                found[k] = (1.0 - a) * found[k] + (a * found[k - 1] if k else 0.0)
        return found

    def noise_gain(self, difference: int, taps: Array | None = None) -> float:
        """Power gain of white noise through a derivative of that order and the operator.

        Args:
            difference: 0, 1 or 2.
            taps: of the derivative in place of the hat's, times T^difference.
        """
        chosen = CENTRED[difference] if taps is None else taps
        through = np.convolve(self.response(), chosen) / self.period**difference
        return float(through @ through)

    def cross_gain(self, first: Array, second: Array) -> float:
        """Mean product of white noise through two differences, each followed by the operator."""
        response = self.response()
        a, b = (np.convolve(response, taps) for taps in (first, second))
        n = max(len(a), len(b))
        return float(np.pad(a, (0, n - len(a))) @ np.pad(b, (0, n - len(b))))

    def __str__(self) -> str:
        """As notes say it."""
        if self.kind == OBSERVER:
            kind = f"{self.width:g} rad/s" if math.isfinite(self.width) else "deadbeat"
            return f"{kind}, {1e3 * self.delay:g} ms late"
        if self.kind == EXPONENTIAL:
            return f"{self.width:g} rad/s, {self.order} pole{'s' if self.order > 1 else ''}"
        shape = f"(u (1 - u))^{self.order}"
        slope = "the slope of " if self.derivative else ""
        return (
            f"{slope}{shape} over {self.width:g} s, a row every {1e3 * self.row_period:g} ms, "
            f"{1e3 * self.delay:g} ms late"
        )


@lru_cache(maxsize=32)
def _observer(bandwidth: float, lag: int, period: float) -> JerkObserver:
    wanted = bandwidth if math.isfinite(bandwidth) else None
    return jerk_observer(period, bandwidth=wanted, lag=lag)
