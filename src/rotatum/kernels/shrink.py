"""High orders are believed as far as the data ask for them: shrinking, its strength from the data.

The solver's covariance is ``P = U diag(d) U^T``, U unit upper triangular. ``zeta = U^-1 alpha``
are then the last coefficients of the nested models: zeta_m is what column m would get if it were
the highest order, d_m its variance over the rows' noise. Leaving out the columns from m on is
``zeta_m = ... = 0``; shrinking each by a weight between 0 and 1 lies between:

    alpha' = U (w zeta),    w = 1 / (1 + (c V / zeta^2)^2) * L / (L + V),

V the variance of zeta_m with coloured residuals accounted for, c the threshold of its rank, and
L the square of the last coefficient that is not shrunk: at full range no order is expected to be
much larger than the straight line. Weights are renewed as evidence is.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import blocks
from rotatum.record import Record, integer, number, vector


class ShrinkParams(Record):
    """Which columns are shrunk and how sure they have to be."""

    first = integer("first column that is shrunk; the one before it sets the scale")
    threshold = vector("p", "squared coefficient over its variance at which half is kept")


class ShrinkState(Record):
    """Weights of the nested coefficients, and the coefficients they make."""

    alpha = vector("p", "coefficients after shrinking", unit="N m", symbol="alpha")
    weight = vector("p", "of each nested coefficient, 0 to 1", symbol="w")
    lost2 = vector("p", "square of what shrinking may have taken from it", unit="(N m)^2")
    zeta = vector("p", "nested coefficients", unit="N m", symbol="zeta")
    direction = vector("p", "scratch: what a unit of each score does to zeta_m")
    bias2 = number("square of what shrinking may have taken, along the last direction asked for")


def init(params: Any, state: Any) -> None:
    """Orders that are shrunk start at zero, the others at what the solver says."""
    for i in range(len(state.weight)):
        state.weight[i] = 1.0
        if i >= params.first:
            state.weight[i] = 0.0


def apply(params: Any, state: Any, solver: Any) -> None:
    """Make ``alpha`` of the solver's coefficients: ``alpha' = alpha - U ((1 - w) zeta)``."""
    p = len(state.alpha)
    for k in range(p - params.first):
        m = p - 1 - k
        z = solver.alpha[m]
        for j in range(m + 1, p):
            z = z - solver.U[m, j] * state.zeta[j]
        state.zeta[m] = z
    for i in range(p):
        value = solver.alpha[i]
        for j in range(params.first, p):
            if j >= i:
                value = value - (1.0 - state.weight[j]) * solver.U[i, j] * state.zeta[j]
        state.alpha[i] = value


def weigh(params: Any, state: Any, solver: Any, variance: float, sums: Any, at: int) -> None:
    """Renew the weights; ``variance`` is the rows', the scores are those of ``sums`` from ``at``.

    The score of column m moves zeta_m by ``d_m U[:, m]``, so that its variance with coloured
    residuals is the sandwich along that direction, and never less than ``variance d_m``. What
    shrinking takes is known only as well as zeta_m: ``(1 - w)^2 max(0, zeta^2 - V)``.
    """
    apply(params, state, solver)
    p = len(state.alpha)
    line = _nested(state, solver, params.first - 1)
    for m in range(params.first, p):
        for i in range(p):
            state.direction[i] = 0.0
            if i <= m:
                state.direction[i] = solver.d[m] * solver.U[i, m]
        V = variance * solver.d[m]
        worst = blocks.worst(sums, at, state.direction)
        if worst > V:
            V = worst
        z2 = state.zeta[m] * state.zeta[m]
        state.weight[m] = _weight(z2, V, params.threshold[m], line * line)
        state.lost2[m] = 0.0
        if z2 > V:
            rest = 1.0 - state.weight[m]
            state.lost2[m] = rest * rest * (z2 - V)
    apply(params, state, solver)


def _nested(state: Any, solver: Any, m: int) -> float:
    """zeta_m, those after it being known."""
    z: float = solver.alpha[m]
    for j in range(m + 1, len(state.zeta)):
        z = z - solver.U[m, j] * state.zeta[j]
    return z


def _weight(z2: float, V: float, threshold: float, line2: float) -> float:
    if z2 <= 0.0:
        return 0.0
    if V <= 0.0:
        return 1.0
    r = threshold * V / z2
    return line2 / ((1.0 + r * r) * (line2 + V))


def spread(state: Any, solver: Any, c: Any) -> float:
    """Return ``c^T U diag(w d) U^T c``, P with the prior the weights stand for; set ``bias2``."""
    total = 0.0
    bias2 = 0.0
    for j in range(len(state.alpha)):
        s = c[j]
        for i in range(j):
            s = s + solver.U[i, j] * c[i]
        total = total + state.weight[j] * solver.d[j] * s * s
        bias2 = bias2 + state.lost2[j] * s * s
    state.bias2 = bias2
    return total


def multiply(state: Any, solver: Any, c: Any, out: Any) -> None:
    """Write ``U diag(w d) U^T c`` to ``out``: what each score does to ``c^T alpha'``."""
    for i in range(len(state.alpha)):
        out[i] = 0.0
    for j in range(len(state.alpha)):
        s = c[j]
        for i in range(j):
            s = s + solver.U[i, j] * c[i]
        s = s * solver.d[j] * state.weight[j]
        for i in range(j):
            out[i] = out[i] + solver.U[i, j] * s
        out[j] = out[j] + s
