"""From coefficients to what users get: stiffness, torque, their deviations, and the verdict."""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels.status import (
    CONVERGING,
    DEFLECTION,
    INCONSISTENT,
    INFORMATIVE,
    PRIOR,
    STARVED,
    STILL,
    WIDE,
)
from rotatum.record import Record, integer, number, vector


class ReadoutParams(Record):
    """Thresholds of the verdict."""

    period = number("time between samples", unit="s", symbol="T")
    starved = number("relative half interval above which the joint is starved")
    informative = number("relative half interval below which it is informative")
    hold = number("time below before it is called so", unit="s")
    shrink = number("how much of the prior's variance may be left")
    link2 = number("variance of the link position's noise", unit="rad^2")
    motor2 = number("variance of the motor position's noise", unit="rad^2")


class ReadoutState(Record):
    """How long the interval has been narrow, and since when the verdict has been good."""

    narrow = integer("samples in a row with a narrow interval")
    good = integer("samples in a row with the verdict informative")
    since = number("when these began", unit="s")
    converged = integer("1: they lasted long enough once")
    converged_at = number("when that stretch began", unit="s")
    noise2 = number("variance of the stiffness from noise", unit="(N m/rad)^2")
    wrong2 = number("square of its systematic error", unit="(N m/rad)^2")


class Reading(Record):
    """One sample's result for one joint."""

    time = number("of the sample", unit="s", symbol="t")
    stiffness = number("of the joint at this deflection", unit="N m/rad", symbol="sigma")
    stiffness_std = number("its standard deviation", unit="N m/rad")
    torque = number("elastic torque, from the coefficients", unit="N m", symbol="tau_e")
    torque_std = number("its standard deviation", unit="N m")
    dstiffness = number("derivative of the stiffness by deflection", unit="N m/rad^2")
    deflection = number("q - theta less its zero", unit="rad", symbol="phi")
    row_torque = number("left side of the row", unit="N m", symbol="y")
    row_fit = number("its fit", unit="N m", symbol="R^T alpha")
    noise = number("standard deviation of a row's noise", unit="N m", symbol="s")
    inflation = number("factor on variances for coloured residuals")
    informative_deflection = number("rms deflection that nothing else explains", unit="rad")
    converged_at = number(
        "since when informative for the first time, where converged is 1", unit="s"
    )
    converged = integer("1: the verdict has been informative for long enough once")
    verdict = integer("0 starved, 1 converging, 2 informative, 3 inconsistent")
    status = integer("status bits")
    rows = integer("rows accepted since reset")
    coefficients = vector("p", "in normalised coordinates", unit="N m", symbol="alpha")
    coefficients_std = vector("p", "their standard deviations", unit="N m")


def init(params: Any, state: Any) -> None:
    """Not converged."""
    state.converged = 0


def read(row: Any, alpha: Any, out: Any) -> None:
    """``sigma = F_phi^T alpha``, ``tau_e = F^T alpha``, ``sigma' = F_phiphi^T alpha``
    (flacco2012 eqs 21, 24, 28)."""
    stiffness = 0.0
    torque = 0.0
    slope = 0.0
    fit = 0.0
    for i in range(len(alpha)):
        stiffness = stiffness + row.D[i] * alpha[i]
        torque = torque + row.F[i] * alpha[i]
        slope = slope + row.H[i] * alpha[i]
        fit = fit + row.R[i] * alpha[i]
        out.coefficients[i] = alpha[i]
    out.stiffness = stiffness
    out.torque = torque
    out.dstiffness = slope
    out.deflection = row.phi
    out.row_torque = row.y
    out.row_fit = fit


def deviations(
    params: Any,
    state: Any,
    evidence: Any,
    sigma_spread: float,
    sigma_bias2: float,
    torque_spread: float,
    torque_bias2: float,
    out: Any,
) -> None:
    """Standard deviations: coloured noise, and what the encoders' errors do to the stiffness.

    ``std^2 = inflation s^2 D^T P D + (sigma a / phi)^2 + shift^2 + bias^2 + (sigma' n)^2``: a
    systematic error ``a`` of the deflection may be fully correlated with it, phi being the rms
    deflection that informs the stiffness; ``shift`` bounds the bias from encoder noise in the
    columns, ``bias`` is what shrinking may have taken; n is the noise of the deflection at which
    the law is read.
    """
    variance = evidence.variance
    if evidence.evaluated == 0:
        # Not judged yet: the residuals so far, or anything while there is none.
        variance = 1.0
        if evidence.rows > 0.0:
            variance = evidence.squares / evidence.rows
    scale = evidence.inflation * variance
    relative = evidence.relative2
    state.noise2 = scale * sigma_spread
    state.wrong2 = out.stiffness * out.stiffness * relative + evidence.shift * evidence.shift
    state.wrong2 = state.wrong2 + sigma_bias2
    read2 = out.dstiffness * out.dstiffness * (params.link2 + params.motor2)
    out.stiffness_std = math.sqrt(state.noise2 + state.wrong2 + read2)
    wrong = out.torque * out.torque * relative + torque_bias2
    read2 = out.stiffness * out.stiffness * (params.link2 + params.motor2)
    out.torque_std = math.sqrt(scale * torque_spread + wrong + read2)
    out.noise = evidence.noise
    out.inflation = evidence.inflation
    out.informative_deflection = evidence.deflection
    for i in range(len(evidence.deviation)):
        out.coefficients_std[i] = evidence.deviation[i]


def status_of(
    params: Any,
    evidence: Any,
    evidence_params: Any,
    row: Any,
    unshrunk: float,
    out: Any,
) -> int:
    """Status bits: what the row says, and whether the data have told anything at all.

    ``unshrunk`` is the stiffness' variance over the rows' had nothing been shrunk.
    """
    prior = 0.0
    for i in range(len(row.D)):
        prior = prior + evidence_params.spread[i] * row.D[i] * row.D[i]
    status: int = row.status
    if evidence.evaluated == 0 or unshrunk > params.shrink * prior:
        status = status | PRIOR
    wide = 1.96 * out.stiffness_std > params.starved * math.fabs(out.stiffness)
    if wide and 1.96 * evidence_params.accuracy > params.starved * evidence.deflection:
        status = status | DEFLECTION
    return status


def decide(
    params: Any, state: Any, status: int, wrong: int, time: float, counted: int, out: Any
) -> None:
    """Set verdict, status and ``converged_at``.

    Starved: half the interval exceeds ``starved`` of the estimate, or more than ``shrink`` of the
    prior's variance is left in this read-out direction, or updates are held for long. Informative:
    below ``informative`` for ``hold`` seconds. Inconsistent: a probe of the model speaks; wins over
    the others. A read-out that is only repeated is not ``counted``.
    """
    half = 1.96 * out.stiffness_std
    if half > params.starved * math.fabs(out.stiffness):
        status = status | WIDE
    if counted != 0:
        state.narrow = state.narrow + 1
    if half >= params.informative * out.stiffness:
        state.narrow = 0
    verdict = CONVERGING
    if status & (PRIOR | WIDE | STILL) != 0:
        verdict = STARVED
    elif state.narrow * params.period >= params.hold:
        verdict = INFORMATIVE
    if wrong != 0:
        verdict = INCONSISTENT
    out.verdict = verdict
    out.status = status | wrong
    if counted != 0:
        _since(params, state, verdict, time)
    out.converged = state.converged
    out.converged_at = state.converged_at


def _since(params: Any, state: Any, verdict: int, time: float) -> None:
    if verdict == INFORMATIVE:
        if state.good == 0:
            state.since = time
        state.good = state.good + 1
        if state.converged == 0 and state.good * params.period >= params.hold:
            state.converged = 1
            state.converged_at = state.since
    else:
        state.good = 0
