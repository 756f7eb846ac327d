"""Recursive least squares in covariance form, on one triangle: the papers' solver."""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, matrix, number, vector


class RlsState(Record):
    """Memory of covariance recursive least squares."""

    alpha = vector("p", "coefficients in normalised coordinates", unit="unit of y", symbol="alpha")
    P = matrix(
        "p",
        "p",
        "covariance of the coefficients were the noise of variance R; only i <= j is kept",
        symbol="P",
    )
    g = vector("p", "scratch: P R", symbol="K (1 + rho)")
    innovation = number("y - R^T alpha before the update", unit="unit of y", symbol="epsilon")
    leverage = number("R^T P R before the update", symbol="rho")
    count = integer("rows accepted since reset")
    turn = integer("column whose prior is re-injected next")


def init(params: Any, state: Any) -> None:
    """alpha = alpha(0), P = P(0) diagonal."""
    for i in range(len(state.g)):
        state.alpha[i] = params.centre[i]
        for j in range(len(state.g)):
            state.P[i, j] = 0.0
        state.P[i, i] = params.spread[i]


def update(params: Any, state: Any, R: Any, y: float) -> None:
    """Take one row: flacco2012 eq. 23, with 1 replaced by the measurement variance.

    Departures: one triangle is updated, because ``P - K F^T P`` as printed loses symmetry and
    drifts; eqs 39-41 with constant c are ``variance = 1 / c``; forgetting and prior as in
    ``udrls.update``.
    """
    state.innovation = absorb(state, R, y, params.variance)
    state.count = state.count + 1
    if params.forgetting < 1.0:
        p = len(state.g)
        for i in range(p):
            for j in range(i, p):
                state.P[i, j] = state.P[i, j] / params.forgetting
        j = state.turn
        share = params.spread[j] / (p * (1.0 - params.forgetting))
        anchor(state, j, params.centre[j], share)
        state.turn = j + 1
        if state.turn >= p:
            state.turn = 0


def absorb(state: Any, R: Any, y: float, variance: float) -> float:
    """Absorb a row of the given variance; return its innovation. ``leverage`` is set."""
    multiply(state, R, state.g)
    e = y
    rho = 0.0
    for i in range(len(state.g)):
        e = e - R[i] * state.alpha[i]
        rho = rho + R[i] * state.g[i]
    state.leverage = rho
    _absorb(state, e, variance + rho)
    return e


def anchor(state: Any, j: int, value: float, variance: float) -> None:
    """Absorb what is known of one coefficient: ``alpha_j = value`` with that variance."""
    for i in range(len(state.g)):
        if i <= j:
            state.g[i] = state.P[i, j]
        else:
            state.g[i] = state.P[j, i]
    _absorb(state, value - state.alpha[j], variance + state.P[j, j])


def spread(state: Any, c: Any, first: int) -> float:
    """Return ``c^T P c`` for c that is 0 before ``first``; 0 where rounding made P indefinite."""
    total = 0.0
    for i in range(first, len(state.g)):
        total = total + c[i] * c[i] * state.P[i, i]
        for j in range(i + 1, len(state.g)):
            total = total + 2.0 * c[i] * c[j] * state.P[i, j]
    if total < 0.0:
        total = 0.0
    return total


def multiply(state: Any, c: Any, out: Any) -> None:
    """Write ``P c`` to ``out``."""
    for i in range(len(state.g)):
        s = 0.0
        for j in range(i):
            s = s + state.P[j, i] * c[j]
        for j in range(i, len(state.g)):
            s = s + state.P[i, j] * c[j]
        out[i] = s


def _absorb(state: Any, e: float, total: float) -> None:
    for i in range(len(state.g)):
        k = state.g[i] / total
        state.alpha[i] = state.alpha[i] + k * e
        for j in range(i, len(state.g)):
            state.P[i, j] = state.P[i, j] - k * state.g[j]
