"""The window operator: weights on [t - T, t] over a set of terms side by side, every so often.

The terms are balances tested with hats, sample by sample. Weighted by ``w`` on the grid and summed,
a second difference under the hat becomes the second difference of the weights under the sum,

    sum_m w(m) (x(m+1) - 2 x(m) + x(m-1)) / T^2 = sum_m (w(m+1) - 2 w(m) + w(m-1)) / T^2 x(m),

with ``w = 0`` beyond its ends: summation by parts, exact on the grid. Constants and ramps of a
position therefore vanish to rounding, which a trapezoid over the derivatives of the window does
not give (its error is proportional to the signal's offset).
"""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, matrix, vector


class WindowParams(Record):
    """A window on the grid."""

    weight = vector("w", "oldest first, 0 beyond the window's length", symbol="w")
    length = integer("terms under the window")
    stride = integer("samples from one row to the next")
    phase = integer("samples by which this joint's rows come later than the first's")


class WindowState(Record):
    """The terms under the window, in a ring; the result."""

    ring = matrix("w", "c", "terms, a row each")
    head = integer("row the next ones go to")
    length = integer("sets of terms in the ring")
    wait = integer("samples until the next row")
    value = vector("c", "the result")
    ready = integer("1: a row is due now")
    settled = integer("1: the window is full")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    restart(params, state)


def restart(params: Any, state: Any) -> None:
    """Forget: a window across what is not adjacent has no meaning."""
    state.head = 0
    state.length = 0
    state.wait = params.length + params.phase
    state.ready = 0
    state.settled = 0


def idle(state: Any) -> None:
    """No new terms at this sample: the result stands, and is no new row."""
    state.ready = 0


def push(params: Any, state: Any, raw: Any) -> None:
    """Take one set of terms; once the window is full and ``phase`` is over, a row a stride."""
    for i in range(len(raw)):
        state.ring[state.head, i] = raw[i]
    state.head = state.head + 1
    if state.head >= params.length:
        state.head = 0
    state.ready = 0
    if state.length < params.length:
        state.length = state.length + 1
    state.wait = state.wait - 1
    if state.length >= params.length:
        state.settled = 1
    if state.wait == 0:
        _weigh(params, state)
        state.ready = 1
        state.wait = params.stride


def _weigh(params: Any, state: Any) -> None:
    """Sum from the oldest to the newest, in two stretches of the ring."""
    # An index that might be negative would be looked at twice at every term.
    head = state.head
    if head < 0:
        head = 0
    old = params.length - head
    if old < 0:
        old = 0
    for i in range(len(state.value)):
        state.value[i] = 0.0
    for m in range(old):
        w = params.weight[m]
        for i in range(len(state.value)):
            state.value[i] = state.value[i] + w * state.ring[head + m, i]
    for m in range(head):
        w = params.weight[old + m]
        for i in range(len(state.value)):
            state.value[i] = state.value[i] + w * state.ring[m, i]
