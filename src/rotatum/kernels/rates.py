"""Rates of many signals, by one observer: each is what ``unknown_input`` makes of it alone.

Signals that pass through one and the same linear operator keep every linear relation between
them. The terms of a spring do so where they are formed before they are observed: ``d/dt F(phi)``
made of an observed deflection, ``F_phi(phi^) phi^'``, is another signal than the observed rate of
``F(phi)``, by what the observer takes off the deflection, and a spring that hardens shows it.
"""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, matrix, vector


class RatesState(Record):
    """Memory of one observer for all signals; its parameters are ``UnknownInputParams``, p = 1."""

    x = matrix("n", "c", "state of the recursion, a column for each signal")
    ahead = matrix("n", "c", "scratch: the state of the next step")
    ring = matrix("w", "c", "signals, a row each sample")
    value = vector("c", "the rates, of one delayed instant")
    head = integer("row the next ones go to: that of the oldest, once the window is full")
    length = integer("rows in the ring since the (re)start")
    steps = integer("steps with a full window since then, settle at most")
    valid = integer("1: rates were made of the last sample")
    settled = integer("1: the start is forgotten")


def init(state: Any) -> None:
    """Nothing seen yet."""
    for i in range(len(state.value)):
        state.value[i] = 0.0
    restart(state)


def restart(state: Any) -> None:
    """Forget: a window across what is not adjacent has no meaning. Rates are held."""
    state.head = 0
    state.length = 0
    state.steps = 0
    state.valid = 0
    state.settled = 0


def push(params: Any, state: Any, raw: Any, place: int) -> None:
    """Take one set of signals; make of each the estimate that ``place`` numbers.

    With a full window ``Y``, the oldest first, ``value = G[place] x + K[place] Y``, then
    ``x <- E x + F Y``: column by column what ``unknown_input.push`` does.
    """
    size = len(state.ring) - params.first
    for i in range(len(raw)):
        state.ring[state.head, i] = raw[i]
    state.head = state.head + 1
    if state.head >= size:
        state.head = 0
    if state.length < size:
        state.length = state.length + 1
    state.valid = 0
    if state.length >= size:
        if state.steps == 0 and state.settled == 0:
            _begin(params, state)
        _weigh(params, state, place, size)
        _advance(params, state, size)
        state.valid = 1
        state.settled = 0
        if state.steps >= params.settle:
            state.settled = 1
        else:
            state.steps = state.steps + 1


def _begin(params: Any, state: Any) -> None:
    """Start at rest where the oldest signals of the window stand."""
    for n in range(len(state.x)):
        for i in range(len(state.value)):
            state.x[n, i] = params.rest[n, 0] * state.ring[state.head, i]


def _weigh(params: Any, state: Any, place: int, size: int) -> None:
    """Sum from the oldest to the newest, in two stretches of the ring."""
    for i in range(len(state.value)):
        state.value[i] = 0.0
    for n in range(len(state.x)):
        g = params.G[place, n]
        for i in range(len(state.value)):
            state.value[i] = state.value[i] + g * state.x[n, i]
    old = size - state.head
    _stretch(params, state, place, params.first, state.head, old)
    _stretch(params, state, place, params.first + old, 0, state.head)


def _stretch(params: Any, state: Any, place: int, first: int, at: int, count: int) -> None:
    """Add ``count`` rows of the ring from ``at`` on, four at a time: they need not wait."""
    # An index that might be negative would be looked at twice at every term.
    if first < 0:
        first = 0
    if at < 0:
        at = 0
    quads = int(count * 0.25)
    for k in range(quads):
        m = first + 4 * k
        j = at + 4 * k
        a = params.K[m, place]
        b = params.K[m + 1, place]
        c = params.K[m + 2, place]
        d = params.K[m + 3, place]
        for i in range(len(state.value)):
            early = a * state.ring[j, i] + b * state.ring[j + 1, i]
            late = c * state.ring[j + 2, i] + d * state.ring[j + 3, i]
            state.value[i] = state.value[i] + (early + late)
    for k in range(4 * quads, count):
        w = params.K[first + k, place]
        for i in range(len(state.value)):
            state.value[i] = state.value[i] + w * state.ring[at + k, i]


def _advance(params: Any, state: Any, size: int) -> None:
    for n in range(len(state.x)):
        for i in range(len(state.value)):
            state.ahead[n, i] = 0.0
        for j in range(len(state.x)):
            e = params.E[n, j]
            for i in range(len(state.value)):
                state.ahead[n, i] = state.ahead[n, i] + e * state.x[j, i]
        for m in range(params.driven - params.first):
            at = state.head + m
            if at >= size:
                at = at - size
            f = params.F[n, params.first + m]
            for i in range(len(state.value)):
                state.ahead[n, i] = state.ahead[n, i] + f * state.ring[at, i]
    for n in range(len(state.x)):
        for i in range(len(state.value)):
            state.x[n, i] = state.ahead[n, i]
