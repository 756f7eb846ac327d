"""High orders are believed as far as the data ask for them: shrinking, its strength from the data.

The solver's covariance is ``P = U diag(d) U^T``, U unit upper triangular. ``zeta = U^-1 alpha``
are then the last coefficients of the nested models: zeta_m is what column m would get if it were
the highest order, d_m its variance over the rows' noise. Leaving out the columns from m on is
``zeta_m = ... = 0``; shrinking each by a weight between 0 and 1 lies between:

    alpha' = U (w zeta),    w = b L / (L + V),    b = 1 / (1 + (c V / zeta^2)^3),

V the variance of zeta_m with coloured residuals accounted for, and L the square of thrice the last
coefficient that is not shrunk: at full range no order is expected to be much larger than the
straight line. The threshold c is 1/2 for the first order; the next one's is 3 where this one is
believed (b = 1), ten times its own where it is not (b = 0): more orders are more chances of
chance, and a law that does without one order seldom needs the next. Weights are renewed as
evidence is.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import blocks
from rotatum.record import Record, integer, number, vector

FIRST = 0.5  # threshold of the first order: squared coefficient over variance that keeps half
NEXT = 3.0  # of the order after one that is believed
STEEPER = 10.0  # factor on it after one that is not
LARGEST = 3.0  # size of an order at full range, in straight lines, that is nothing special
STEEPEST = 108.0  # of any: ten standard deviations are sure


class ShrinkParams(Record):
    """Which columns are shrunk."""

    first = integer("first column that is shrunk; the one before it sets the scale")


class ShrinkState(Record):
    """Weights of the nested coefficients, and the coefficients they make."""

    alpha = vector("p", "coefficients after shrinking", unit="N m", symbol="alpha")
    weight = vector("p", "of each nested coefficient, 0 to 1", symbol="w")
    lost2 = vector("p", "square of what shrinking may have taken from it", unit="(N m)^2")
    zeta = vector("p", "nested coefficients", unit="N m", symbol="zeta")
    direction = vector("p", "scratch: what a unit of each score does to zeta_m")
    unshrunk = number("variance along it over the rows' noise had nothing been shrunk")
    bias2 = number("square of what shrinking may have taken, along the last direction asked for")


def init(params: Any, state: Any) -> None:
    """Orders that are shrunk start at zero, the others at what the solver says."""
    for i in range(len(state.weight)):
        state.weight[i] = 1.0
        if i >= params.first:
            state.weight[i] = 0.0


def apply(state: Any, solver: Any) -> None:
    """Make ``zeta`` and ``alpha`` of the solver's coefficients."""
    p = len(state.alpha)
    for i in range(p):
        state.zeta[i] = solver.alpha[i]
        state.alpha[i] = 0.0
    for k in range(p):
        m = p - 1 - k
        z = state.zeta[m]
        wz = state.weight[m] * z
        for i in range(m):
            state.zeta[i] = state.zeta[i] - solver.U[i, m] * z
            state.alpha[i] = state.alpha[i] + solver.U[i, m] * wz
        state.alpha[m] = state.alpha[m] + wz


def weigh(params: Any, state: Any, solver: Any, variance: float, sums: Any, at: int) -> None:
    """Renew the weights; ``variance`` is the rows', the scores are those of ``sums`` from ``at``.

    The score of column m moves zeta_m by ``d_m U[:, m]``, so that its variance with coloured
    residuals is the sandwich along that direction, and never less than ``variance d_m``. What
    shrinking takes is known only as well as zeta_m: ``(1 - w)^2 max(0, zeta^2 - V)``.
    """
    apply(state, solver)
    p = len(state.alpha)
    line = LARGEST * state.zeta[params.first - 1]
    threshold = FIRST
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
        believed = _believed(z2, V, threshold)
        state.weight[m] = believed * line * line / (line * line + V + 1e-300)
        threshold = believed * NEXT + (1.0 - believed) * STEEPER * threshold
        if threshold > STEEPEST:
            threshold = STEEPEST
        state.lost2[m] = 0.0
        if z2 > V:
            rest = 1.0 - state.weight[m]
            state.lost2[m] = rest * rest * (z2 - V)
    apply(state, solver)


def _believed(z2: float, V: float, threshold: float) -> float:
    if z2 <= 0.0:
        return 0.0
    r = threshold * V / z2
    return 1.0 / (1.0 + r * r * r)


def spread(state: Any, solver: Any, c: Any, first: int) -> float:
    """Return ``c^T U diag(w d) U^T c``, P with the prior the weights stand for; c is 0 before
    ``first``.

    Sets ``bias2``, and ``unshrunk``: a direction the data have never seen looks sure once its
    weights are 0, and only that says it is not.
    """
    total = 0.0
    bias2 = 0.0
    unshrunk = 0.0
    for j in range(first, len(state.alpha)):
        s = c[j]
        for i in range(first, j):
            s = s + solver.U[i, j] * c[i]
        own = solver.d[j] * s * s
        total = total + state.weight[j] * own
        unshrunk = unshrunk + own
        bias2 = bias2 + state.lost2[j] * s * s
    state.bias2 = bias2
    state.unshrunk = unshrunk
    return total


def multiply(state: Any, solver: Any, c: Any, out: Any) -> None:
    """Write ``U diag(w d) U^T c``, each score's effect on ``c^T alpha'``; set ``bias2``."""
    bias2 = 0.0
    for i in range(len(state.alpha)):
        out[i] = 0.0
    for j in range(len(state.alpha)):
        s = c[j]
        for i in range(j):
            s = s + solver.U[i, j] * c[i]
        bias2 = bias2 + state.lost2[j] * s * s
        s = s * solver.d[j] * state.weight[j]
        for i in range(j):
            out[i] = out[i] + solver.U[i, j] * s
        out[j] = out[j] + s
    state.bias2 = bias2
