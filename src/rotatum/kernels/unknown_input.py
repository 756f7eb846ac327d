"""A linear observer over a window of outputs: states and unknown inputs of a delayed instant."""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels.guard import BEYOND
from rotatum.kernels.status import NOT_FINITE, RESTARTED, SETTLING
from rotatum.record import Record, integer, matrix, vector


class UnknownInputParams(Record):
    """Matrices of one observer; ``Y`` is a window of c / p outputs, the oldest first.

    Sizes: n states of the recursion, p outputs, c = p times the room for the window, s states and m
    inputs estimated, o = s + m.
    """

    E = matrix("n", "n", "what the state does on its own", unit="unit of x", symbol="E")
    F = matrix("n", "c", "how the window drives the state", unit="unit of x / unit of y")
    G = matrix("o", "n", "estimates from the state", unit="unit of the estimate / unit of x")
    K = matrix("o", "c", "estimates from the window", unit="unit of the estimate / unit of y")
    rest = matrix("n", "p", "state of outputs that stand still", unit="unit of x / unit of y")
    first = integer("columns of F and K before it are room that this design does not use")
    driven = integer("columns of F from this one on are zero")
    settle = integer("steps from the first full window until the start is forgotten")


class UnknownInputState(Record):
    """Memory of an observer."""

    x = vector("n", "state of the recursion", unit="unit of x", symbol="X")
    ahead = vector("n", "scratch: the state of the next step", unit="unit of x")
    Y = vector("c", "outputs, the oldest first, at the end", unit="unit of y", symbol="Y")
    estimate = vector("o", "the last estimates: states, then inputs", unit="unit of the estimate")
    length = integer("numbers in the window since the (re)start")
    steps = integer("steps with a full window since then, settle at most")
    valid = integer("1: estimates were made of this sample")
    settled = integer("1: the start is forgotten")


class OutputSample(Record):
    """One sample of all outputs of the observed system."""

    y = vector("p", "outputs", unit="unit of y", symbol="Y")
    fresh = integer("1: what came before this sample does not adjoin: start here")


class UnknownInputEstimate(Record):
    """States and inputs of the delayed instant; held where ``valid`` is 0."""

    x = vector("s", "states", unit="unit of x", symbol="X")
    u = vector("m", "unknown inputs", unit="unit of u", symbol="U")
    valid = integer("1: made of this sample")
    settled = integer("1: the start is forgotten")
    status = integer("status bits")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    for i in range(len(state.estimate)):
        state.estimate[i] = 0.0
    restart(params, state)


def restart(params: Any, state: Any) -> None:
    """Forget: a window across what is not adjacent has no meaning. Estimates are held."""
    state.length = params.first
    state.steps = 0
    state.valid = 0
    state.settled = 0


def idle(state: Any) -> None:
    """No new sample: the estimates stand, and are not new."""
    state.valid = 0


def push(params: Any, state: Any, y: Any, wanted: int) -> None:
    """Take one set of outputs; make the first ``wanted`` of the estimates.

    With a full window ``Y = (y(k-w+1), ..., y(k))``: ``estimate = G x + K Y``, then
    ``x <- E x + F Y``. trumic2022 eq. 6 (Sundaram and Hadjicostis 2008) is of this form with

    ``X^ = x``, ``U^ = J [x(k+1) - A x; Y(k-L) - C x]``, w = L + 1:
    the state there estimates that of the instant k - L, so that the residual of the output takes
    the *oldest* of the window. Eq. 6 prints ``Y_k``; for L > 0 and D != 0 that mixes instants
    (where D = 0, as in eq. 8, the columns of J that multiply it are zero and nothing is lost).
    """
    p = len(y)
    c = len(state.Y)
    if state.length == c:
        for i in range(params.first, c - p):
            state.Y[i] = state.Y[i + p]
        state.length = c - p
    for i in range(p):
        state.Y[state.length + i] = y[i]
    state.length = state.length + p
    state.valid = 0
    if state.length == c:
        if state.steps == 0 and state.settled == 0:
            _begin(params, state)
        _estimate(params, state, wanted)
        _advance(params, state)
        state.valid = 1
        state.settled = 0
        if state.steps >= params.settle:
            state.settled = 1
        else:
            state.steps = state.steps + 1


def _begin(params: Any, state: Any) -> None:
    """Start at rest where the oldest outputs of the window stand."""
    for i in range(len(state.x)):
        a = 0.0
        for j in range(len(params.rest[i])):
            a = a + params.rest[i, j] * state.Y[params.first + j]
        state.x[i] = a


def _estimate(params: Any, state: Any, wanted: int) -> None:
    for i in range(wanted):
        a = _weighed(params.K, state.Y, i, params.first)
        for j in range(len(state.x)):
            a = a + params.G[i, j] * state.x[j]
        state.estimate[i] = a


def _weighed(K: Any, Y: Any, i: int, first: int) -> float:
    """Sum a row of K times the window, in four sums that do not wait for each other."""
    a = 0.0
    b = 0.0
    c = 0.0
    d = 0.0
    quads = int((len(Y) - first) * 0.25)
    for k in range(quads):
        j = first + 4 * k
        a = a + K[i, j] * Y[j]
        b = b + K[i, j + 1] * Y[j + 1]
        c = c + K[i, j + 2] * Y[j + 2]
        d = d + K[i, j + 3] * Y[j + 3]
    for j in range(first + 4 * quads, len(Y)):
        a = a + K[i, j] * Y[j]
    return (a + b) + (c + d)


def _advance(params: Any, state: Any) -> None:
    for i in range(len(state.x)):
        a = 0.0
        for j in range(len(state.x)):
            a = a + params.E[i, j] * state.x[j]
        for j in range(params.first, params.driven):
            a = a + params.F[i, j] * state.Y[j]
        state.ahead[i] = a
    for i in range(len(state.x)):
        state.x[i] = state.ahead[i]


def step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Observe one sample. Outputs that are not finite leave the state; the estimates hold.

    Samples are taken for equidistant: where some are lost, raise ``fresh`` or fill them.
    """
    good = 1
    for i in range(len(u.y)):
        if not math.fabs(u.y[i]) <= BEYOND:
            good = 0
    out.status = 0
    if good == 1:
        if u.fresh != 0:
            restart(params, state)
            out.status = RESTARTED
        push(params, state, u.y, len(state.estimate))
        if state.settled == 0:
            out.status = out.status | SETTLING
    else:
        idle(state)
        out.status = NOT_FINITE
    s = len(out.x)
    for i in range(s):
        out.x[i] = state.estimate[i]
    for i in range(len(out.u)):
        out.u[i] = state.estimate[s + i]
    out.valid = state.valid
    out.settled = state.settled
