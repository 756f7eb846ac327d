"""How far an estimate can be trusted: noise level, coloured residuals, intervals."""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import blocks, probes
from rotatum.kernels.probes import MOMENTS, PROBES, RING
from rotatum.kernels.status import NEGATIVE
from rotatum.record import Record, integer, number, vector

DUE = 8  # blocks of level 0 between evaluations
SETTLED = 8  # evaluations before coefficients and noise level are to be relied on
FAINTEST = 0.99  # share of a column that noise may be: beyond, its coefficient says nothing


class EvidenceParams(Record):
    """What the interval has to account for, and when a model is called wrong."""

    forgetting = number("the solver's", symbol="lambda")
    memory = number("weight of a block of level 0 in the tests relative to the next one")
    lag = integer("samples between the residual tested and the torque on either side of it")
    common = number(
        "covariance of residual and acceleration that encoder noise gives them", unit="N m rad/s^2"
    )
    accuracy = number("systematic error of the deflection", unit="rad")
    scale2 = number("square of the relative error of the left side's scale")
    mute = vector(PROBES, "1: what this probe looks for is a column already", kind="int")
    bias = number("relative error of the stiffness from which a model may be called wrong")
    spread = vector("p", "prior variance", unit="(N m)^2", symbol="P(0)")
    noise = vector("p", "variance of the encoders' noise in each column")
    shared = vector("p", "covariance that this noise has with its share in y", unit="N m")
    given = vector("p", "what the coefficient adds to, in y already", unit="N m")
    known = vector(
        "p", "variance of what the device file says of a column, 0: nothing", unit="(N m)^2"
    )


class EvidenceState(Record):
    """Running sums. Scores are residual times regressor: their sum is what least squares zeroes."""

    rows = number("rows, faded by forgetting", symbol="n")
    squares = number("sum of squared residuals", unit="(N m)^2")
    anchored = number(
        "noise level against which what the device file says is absorbed", unit="(N m)^2"
    )
    evaluated = integer("evaluations since reset")
    variance = number("variance of a row's noise", unit="(N m)^2", symbol="s^2")
    inflation = number("factor on the read-out's variance for coloured residuals")
    spread = number("D^T P D where the inflation was renewed", unit="1/rad^2")
    deflection = number("rms deflection that nothing else explains", unit="rad")
    relative2 = number("square of the relative error that is systematic")
    noise = number("standard deviation of a row's noise", unit="N m", symbol="s")
    shift = number("how far the encoders' noise may have moved the stiffness", unit="N m/rad")
    direction = vector("p", "what a unit of each score does along the read-out direction")
    unit = vector("p", "scratch: a unit vector")
    column = vector("p", "scratch: a column of P")
    deviation = vector("p", "standard deviation of each coefficient", unit="N m")
    faint = vector("p", "share of each column's own information that is noise, 0 to 1")
    turn = integer("coefficient whose standard deviation is renewed next")
    e = vector(RING, "recent residuals", unit="N m")
    f = vector(RING, "recent fitted elastic torques", unit="N m")
    head = integer("where the next one goes")
    length = integer("how many there are")
    open = vector(
        MOMENTS,
        "sums of the open block: terms, torque, its square, acceleration times "
        "torque, squared shift, squared acceleration, velocity times torque, squared velocity",
    )
    weight = number("terms in the tests, faded")
    torque = number("sum of fitted torques", unit="N m")
    torque2 = number("sum of their squares", unit="(N m)^2")
    probe = vector(PROBES, "sums of residual times probe")
    probe2 = vector(PROBES, "sums of squared probes")
    pull = vector(RING, "recent accelerations of the motor", unit="rad/s^2")
    drag = vector(RING, "recent velocities of the link, times any constant")
    drag_cross = number("sum of these times torque")
    cross = number("sum of acceleration times torque", unit="N m rad/s^2")
    share = vector(PROBES, "relative error of the stiffness each probe hints at")
    doubt = vector(PROBES, "how sure that is, 2.5 is one in 700 by chance")
    streak = vector(PROBES, "evaluations in a row in which it spoke", kind="int")
    wrong = integer("status bits of the probes that found the model wrong")


def init(params: Any, state: Any) -> None:
    """No rows yet, so no noise level: the first evaluation sets it."""
    state.evaluated = 0
    state.inflation = 1.0


def cut(state: Any) -> None:
    """Drop the open block: what follows is not adjacent to what came before."""
    state.length = 0
    for i in range(MOMENTS):
        state.open[i] = 0.0


def add(
    params: Any, state: Any, sums: Any, row: Any, solver: Any, terms: int, at: int, first: int
) -> None:
    """Take the row just absorbed by the solver.

    The squared residuals add up to ``sum e(k)^2 / (1 + rho(k))``, exactly the least-squares
    objective; scores use the residual after the update, so that the first rows, whose innovation
    is the whole torque, do not drown the rest. The last ``terms`` columns are the spring's. Scores
    go into ``sums`` from ``at`` on, probes from ``first`` on.
    """
    shrink = 1.0 / (1.0 + solver.leverage)
    state.squares = params.forgetting * state.squares
    state.squares = state.squares + solver.innovation * solver.innovation * shrink
    state.rows = params.forgetting * state.rows + 1.0
    e = solver.innovation * shrink
    f = 0.0
    p = len(row.R)
    for i in range(p):
        sums.part[at + i] = sums.part[at + i] + e * row.R[i]
    for i in range(p - terms, p):
        f = f + row.R[i] * solver.alpha[i]
    state.e[state.head] = e
    state.f[state.head] = f
    state.pull[state.head] = row.suspect
    state.drag[state.head] = row.drag
    if state.length <= 2 * params.lag:
        state.length = state.length + 1
    # Torques fitted with the first, wild coefficients would outweigh the later ones for long.
    if state.length > 2 * params.lag and state.evaluated >= SETTLED:
        probes.take(params, state, sums, first, f)
    state.head = state.head + 1
    if state.head >= RING:
        state.head = 0


def due(state: Any, sums: Any) -> int:
    """Return 1, and count the evaluation, when enough blocks have been closed since the last."""
    if sums.closed < (state.evaluated + 1) * DUE:
        return 0
    state.evaluated = state.evaluated + 1
    return 1


def noise_level(state: Any) -> None:
    """``s^2 = J / (n - p)`` with J the sum of squared residuals."""
    free = state.rows - len(state.deviation)
    if free > 0.0:
        state.variance = state.squares / free


def judge(params: Any, state: Any, sums: Any, alpha: Any, D: Any, at: int, first: int) -> None:
    """Renew inflation and informative deflection for the direction D, ``direction`` being P D.

    ``inflation = v^T S v / (s^2 D^T P D)``, v = P D, S the scores' variance over blocks: the
    sandwich estimate, never below 1. ``deflection^2 = 1 / (n D^T P D)``: for one column the mean
    square of the deflection, for more the part of it that no other column explains. The scores are
    those from ``at`` on, the probes those from ``first`` on.
    """
    q = 0.0
    for i in range(len(state.direction)):
        q = q + D[i] * state.direction[i]
    state.inflation = 1.0
    state.spread = q
    if q > 0.0 and state.variance > 0.0:
        worst = blocks.worst(sums, at, state.direction)
        if worst > state.variance * q:
            state.inflation = worst / (state.variance * q)
        state.deflection = math.sqrt(1.0 / (state.rows * q))
        a = params.accuracy / state.deflection
        state.relative2 = a * a + params.scale2
    state.noise = math.sqrt(state.variance)
    state.shift = _shift(params, state, state.direction, alpha)
    probes.weigh(state, sums, first)


def _shift(params: Any, state: Any, direction: Any, alpha: Any) -> float:
    """Bound of the bias along ``direction`` from noise in the columns themselves.

    Noise of variance v in a column attenuates its coefficient: least squares is off by
    ``-P n (v (given + alpha) - c)`` with the true alpha; ``given`` because y carries the same noise
    times what is known, c because other derivatives of it do too. What is seen of
    ``given + alpha`` is attenuated by ``1 - a``, ``a = n v P_jj``: where a column is nearly all
    noise its true size could be anything.
    """
    total = 0.0
    for j in range(len(direction)):
        true = (params.given[j] + alpha[j]) / (1.0 - state.faint[j])
        pull = state.rows * (params.noise[j] * true - params.shared[j])
        total = total + math.fabs(direction[j] * pull)
    return total


def coefficient(
    params: Any, state: Any, sums: Any, alpha: Any, j: int, at: int, bias2: float
) -> None:
    """Renew one coefficient's standard deviation, ``column`` being P's column j.

    ``bias2`` is the square of what shrinking may have taken from it.
    """
    own = state.variance * state.column[j]
    worst = blocks.worst(sums, at, state.column)
    if worst > own:
        own = worst
    a = state.rows * params.noise[j] * state.column[j]
    if a > FAINTEST:
        a = FAINTEST
    state.faint[j] = a
    shift = _shift(params, state, state.column, alpha)
    state.deviation[j] = math.sqrt(own + shift * shift + bias2)


def anchoring(state: Any) -> float:
    """How much the noise level exceeds the one absorbed so far, 0 while it is not yet settled.

    A fitted quantity with a known standard deviation is a row among others, but its weight is
    relative to the rows' noise, which only the data tell. Where the level rises later, the
    difference in weight is absorbed then.
    """
    level = state.variance * state.inflation
    if state.evaluated < SETTLED or level <= 1.01 * state.anchored:
        return 0.0
    more: float = level - state.anchored
    state.anchored = level
    return more


def negative(stiffness: float, std: float) -> int:
    """Status bit of a stiffness below zero beyond doubt (three standard deviations)."""
    if stiffness + 3.0 * std < 0.0:
        return NEGATIVE
    return 0
