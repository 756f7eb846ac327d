"""Recursive least squares in UD form: P = U diag(d) U^T, the solver users get."""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, matrix, number, vector


class SolverParams(Record):
    """Prior and memory of recursive least squares."""

    forgetting = number(
        "weight of a row relative to the next one, 1: none is forgotten", symbol="lambda"
    )
    variance = number("measurement variance of a row", unit="(unit of y)^2", symbol="R")
    centre = vector("p", "prior mean of the coefficients", unit="unit of y", symbol="alpha(0)")
    spread = vector("p", "prior variance", unit="(unit of y)^2", symbol="P(0)")


class UdState(Record):
    """Memory of UD recursive least squares."""

    alpha = vector("p", "coefficients in normalised coordinates", unit="unit of y", symbol="alpha")
    U = matrix("p", "p", "unit upper triangular factor of P", symbol="U")
    d = vector("p", "diagonal factor of P", symbol="d")
    f = vector("p", "scratch: U^T R")
    g = vector("p", "scratch: gain before division")
    innovation = number("y - R^T alpha before the update", unit="unit of y", symbol="epsilon")
    leverage = number("R^T P R before the update", symbol="rho")
    count = integer("rows accepted since reset")
    turn = integer("column whose prior is re-injected next")


def init(params: Any, state: Any) -> None:
    """alpha = alpha(0), P = P(0) diagonal."""
    for i in range(len(state.d)):
        state.alpha[i] = params.centre[i]
        state.d[i] = params.spread[i]
        for j in range(len(state.d)):
            state.U[i, j] = 0.0
        state.U[i, i] = 1.0


def update(params: Any, state: Any, R: Any, y: float) -> None:
    """Take one row ``y = R^T alpha + noise``.

    flacco2012 eq. 23 with measurement variance, in Bierman's UD form: the orthogonal
    factorisation the paper names as future work. The stability factor of eqs 39-41 with constant
    c is exactly ``variance = 1 / c`` (``(1 + rho - a rho) / a = 1 / c``). With forgetting,
    ``P <- P / lambda`` after the update, and the prior of one column in turn is re-injected with
    the information forgetting took from it, so that P never exceeds a multiple of P(0).
    """
    state.innovation = absorb(state, R, y, params.variance)
    state.count = state.count + 1
    if params.forgetting < 1.0:
        p = len(state.d)
        for i in range(len(state.d)):
            state.d[i] = state.d[i] / params.forgetting
        j = state.turn
        for i in range(len(state.d)):
            state.f[i] = state.U[j, i]
        share = params.spread[j] / (p * (1.0 - params.forgetting))
        _absorb(state, params.centre[j] - state.alpha[j], share)
        state.turn = j + 1
        if state.turn >= p:
            state.turn = 0


def absorb(state: Any, R: Any, y: float, variance: float) -> float:
    """Absorb a row of the given variance; return its innovation. ``leverage`` is set."""
    e = y
    for j in range(len(state.d)):
        e = e - R[j] * state.alpha[j]
        s = R[j]
        for i in range(j):
            s = s + state.U[i, j] * R[i]
        state.f[j] = s
    state.leverage = _absorb(state, e, variance)
    return e


def anchor(state: Any, j: int, value: float, variance: float) -> None:
    """Absorb what is known of one coefficient: ``alpha_j = value`` with that variance."""
    for i in range(len(state.d)):
        state.f[i] = state.U[j, i]
    _absorb(state, value - state.alpha[j], variance)


def spread(state: Any, c: Any, first: int) -> float:
    """Return ``c^T P c`` for c that is 0 before ``first``."""
    total = 0.0
    for j in range(first, len(state.d)):
        s = c[j]
        for i in range(first, j):
            s = s + state.U[i, j] * c[i]
        total = total + state.d[j] * s * s
    return total


def multiply(state: Any, c: Any, out: Any) -> None:
    """Write ``P c`` to ``out``."""
    for i in range(len(state.d)):
        out[i] = 0.0
    for j in range(len(state.d)):
        s = c[j]
        for i in range(j):
            s = s + state.U[i, j] * c[i]
        s = s * state.d[j]
        for i in range(j):
            out[i] = out[i] + state.U[i, j] * s
        out[j] = out[j] + s


def _absorb(state: Any, e: float, variance: float) -> float:
    """Bierman's update for innovation ``e`` and ``state.f = U^T R``; returns ``R^T P R``."""
    a = variance
    inverse = 1.0 / a
    for j in range(len(state.d)):
        fj = state.f[j]
        v = state.d[j] * fj
        k = -fj * inverse
        b = a
        a = a + fj * v
        inverse = 1.0 / a
        state.d[j] = state.d[j] * b * inverse
        state.g[j] = v
        for i in range(j):
            old = state.U[i, j]
            state.U[i, j] = old + state.g[i] * k
            state.g[i] = state.g[i] + v * old
    w = e * inverse
    for i in range(len(state.d)):
        state.alpha[i] = state.alpha[i] + state.g[i] * w
    return a - variance
