"""First- and second-order matched low-pass filters, as functions on scalars and as stages."""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, number


class LowpassParams(Record):
    """A low-pass with all poles at one place."""

    pole = number("discrete pole, exp(-cutoff * period)", symbol="a")
    order = integer("1 or 2 equal poles in cascade")


class LowpassState(Record):
    """Memory of a low-pass."""

    first = number("after the first pole", symbol="x_1")
    second = number("after the second pole", symbol="x_2")
    count = integer("samples since reset")


class Sample(Record):
    """One number."""

    x = number("signal")


def init(params: Any, state: Any) -> None:
    """Start empty: the first sample becomes the steady state."""
    state.first = 0.0
    state.second = 0.0
    state.count = 0


def smooth(pole: float, before: float, x: float) -> float:
    """One pole: ``y(k) = a y(k-1) + (1 - a) x(k)``, a = exp(-cutoff T); unit gain at rest.

    The pole is matched exactly to that of ``1 / (1 + s / cutoff)``. Amplitude and phase differ
    from the continuous filter's near the Nyquist frequency, which does no harm where, as here,
    every term of a balance goes through the same filter.
    """
    return before + (1.0 - pole) * (x - before)


def step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Filter one sample. A sample that is not finite leaves the state; the output holds."""
    if u.x - u.x == 0.0:
        if state.count == 0:
            state.first = u.x
            state.second = u.x
        state.first = smooth(params.pole, state.first, u.x)
        state.second = smooth(params.pole, state.second, state.first)
        state.count = state.count + 1
    if params.order == 2:
        out.x = state.second
    else:
        out.x = state.first
