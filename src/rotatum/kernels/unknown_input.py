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
    K = matrix(
        "c", "o", "estimates from the window, transposed", unit="unit of the estimate / unit of y"
    )
    rest = matrix("n", "p", "state of outputs that stand still", unit="unit of x / unit of y")
    first = integer("columns of F and rows of K before it are room that this design does not use")
    driven = integer("columns of F from this one on are zero")
    settle = integer("steps from the first full window until the start is forgotten")


class UnknownInputState(Record):
    """Memory of an observer."""

    x = vector("n", "state of the recursion", unit="unit of x", symbol="X")
    ahead = vector("n", "scratch: the state of the next step", unit="unit of x")
    Y = vector("c", "ring of outputs", unit="unit of y", symbol="Y")
    estimate = vector("o", "the last estimates: states, then inputs", unit="unit of the estimate")
    head = integer("where the next outputs go: the oldest are there, once the window is full")
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
    restart(state)


def restart(state: Any) -> None:
    """Forget: a window across what is not adjacent has no meaning. Estimates are held."""
    state.head = 0
    state.length = 0
    state.steps = 0
    state.valid = 0
    state.settled = 0


def idle(state: Any) -> None:
    """No new sample: the estimates stand, and are not new."""
    state.valid = 0


def push(params: Any, state: Any, y: Any) -> None:
    """Take one set of outputs; make the estimates of the window's delayed instant.

    With a full window ``Y = (y(k-w+1), ..., y(k))``: ``estimate = G x + K Y``, then
    ``x <- E x + F Y``. trumic2022 eq. 6 (Sundaram and Hadjicostis 2008) is of this form with

    ``X^ = x``, ``U^ = J [x(k+1) - A x; Y(k-L) - C x]``, w = L + 1:
    the state there estimates that of the instant k - L, so that the residual of the output takes
    the *oldest* of the window. Eq. 6 prints ``Y_k``; for L > 0 and D != 0 that mixes instants
    (where D = 0, as in eq. 8, the columns of J that multiply it are zero and nothing is lost).
    """
    p = len(y)
    size = len(state.Y) - params.first
    for i in range(p):
        state.Y[state.head + i] = y[i]
    state.head = state.head + p
    if state.head >= size:
        state.head = 0
    if state.length < size:
        state.length = state.length + p
    state.valid = 0
    if state.length >= size:
        if state.steps == 0 and state.settled == 0:
            _begin(params, state)
        _estimate(params, state, size)
        _advance(params, state, size)
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
            a = a + params.rest[i, j] * state.Y[state.head + j]
        state.x[i] = a


def _estimate(params: Any, state: Any, size: int) -> None:
    """Sum from the oldest to the newest, in two stretches of the ring."""
    for i in range(len(state.estimate)):
        state.estimate[i] = 0.0
    for n in range(len(state.x)):
        for i in range(len(state.estimate)):
            state.estimate[i] = state.estimate[i] + params.G[i, n] * state.x[n]
    old = size - state.head
    _weigh(params, state, params.first, state.head, old)
    _weigh(params, state, params.first + old, 0, state.head)


def _weigh(params: Any, state: Any, first: int, at: int, count: int) -> None:
    """Add a stretch of the window, four outputs at a time: four do not wait for each other."""
    # An index that might be negative would be looked at twice at every term.
    if first < 0:
        first = 0
    if at < 0:
        at = 0
    quads = 0
    # Compilers warn of rows beyond a smaller window, where this is never reached.
    if len(state.Y) >= 4:
        quads = int(count * 0.25)
    for k in range(quads):
        m = first + 4 * k
        j = at + 4 * k
        a = state.Y[j]
        b = state.Y[j + 1]
        c = state.Y[j + 2]
        d = state.Y[j + 3]
        for i in range(len(state.estimate)):
            early = params.K[m, i] * a + params.K[m + 1, i] * b
            late = params.K[m + 2, i] * c + params.K[m + 3, i] * d
            state.estimate[i] = state.estimate[i] + (early + late)
    for k in range(4 * quads, count):
        for i in range(len(state.estimate)):
            state.estimate[i] = state.estimate[i] + params.K[first + k, i] * state.Y[at + k]


def _advance(params: Any, state: Any, size: int) -> None:
    for i in range(len(state.x)):
        a = 0.0
        for j in range(len(state.x)):
            a = a + params.E[i, j] * state.x[j]
        for m in range(params.driven - params.first):
            at = state.head + m
            if at >= size:
                at = at - size
            a = a + params.F[i, params.first + m] * state.Y[at]
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
            restart(state)
            out.status = RESTARTED
        push(params, state, u.y)
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
