"""The exponential operator: equal poles in cascade over a set of terms side by side."""

from __future__ import annotations

from typing import Any

from rotatum.kernels.lowpass import smooth
from rotatum.record import Record, integer, number, vector


class CascadeParams(Record):
    """A low-pass with two or three equal poles."""

    pole = number("pole of the low-pass, exp(-cutoff T)", symbol="a")
    order = integer("poles: 2 or 3")
    settle = integer("terms after a start until the first row is used")


class CascadeState(Record):
    """Memory of the low-pass of c terms; the result."""

    count = integer("terms since (re)start")
    first = vector("c", "after the first pole")
    second = vector("c", "after the second pole")
    value = vector("c", "the result")
    ready = integer("1: a row is due now")
    settled = integer("1: enough terms since the start")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    restart(params, state)


def restart(params: Any, state: Any) -> None:
    """Forget: what follows is not adjacent to what came before."""
    state.count = 0
    state.ready = 0
    state.settled = 0


def idle(state: Any) -> None:
    """No new terms at this sample: the result stands, and is no new row."""
    state.ready = 0


def push(params: Any, state: Any, raw: Any) -> None:
    """Take one set of terms, ``w(s) = (cutoff / (s + cutoff))^order``.

    Started at the first one, all terms of a balance alike: there is no transient to wait for, only
    noise to be averaged.
    """
    if state.count == 0:
        for i in range(len(raw)):
            state.first[i] = raw[i]
            state.second[i] = raw[i]
            state.value[i] = raw[i]
    a = params.pole
    if params.order == 2:
        for i in range(len(raw)):
            state.first[i] = smooth(a, state.first[i], raw[i])
            state.value[i] = smooth(a, state.value[i], state.first[i])
    else:
        for i in range(len(raw)):
            state.first[i] = smooth(a, state.first[i], raw[i])
            state.second[i] = smooth(a, state.second[i], state.first[i])
            state.value[i] = smooth(a, state.value[i], state.second[i])
    state.count = state.count + 1
    state.ready = 1
    if state.count > params.settle:
        state.settled = 1
