"""Two transmissions on one link: their sum, with what their errors have in common."""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import blocks
from rotatum.kernels.evidence import negative
from rotatum.kernels.readout import decide
from rotatum.kernels.status import PRIOR, WIDE
from rotatum.record import Record, integer, number, vector

LEAST = -0.5  # correlation: what is believed of errors that cancel


class PairState(Record):
    """How the errors of the two stiffnesses hang together."""

    correlation = number("of the two stiffnesses' errors", symbol="r")


class PairReading(Record):
    """One sample's result for an antagonistic joint: the total, then both transmissions."""

    time = number("of the sample", unit="s", symbol="t")
    stiffness = number("of the joint, the sum of both", unit="N m/rad", symbol="sigma_t")
    stiffness_std = number("its standard deviation, covariance included", unit="N m/rad")
    torque = number("elastic torque on the link, the sum of both", unit="N m", symbol="tau_e,t")
    torque_std = number("its standard deviation", unit="N m")
    dstiffness = number("derivative of the total by the link position", unit="N m/rad^2")
    deflection = number("mean of both deflections", unit="rad", symbol="phi")
    row_torque = number("sum of both rows' left sides", unit="N m", symbol="y")
    row_fit = number("sum of their fits", unit="N m", symbol="R^T alpha")
    noise = number("standard deviation of the rows' noise, both together", unit="N m", symbol="s")
    inflation = number("larger factor on variances for coloured residuals")
    informative_deflection = number("smaller rms deflection that nothing else explains", unit="rad")
    converged_at = number(
        "since when informative for the first time, where converged is 1", unit="s"
    )
    converged = integer("1: the verdict has been informative for long enough once")
    verdict = integer("of the total: 0 starved, 1 converging, 2 informative, 3 inconsistent")
    status = integer("status bits of both, and of the total")
    rows = integer("rows accepted since reset")
    correlation = number("of the errors of the two stiffnesses", symbol="r")
    coefficients = vector("v", "agonist first, in normalised coordinates", unit="N m")
    coefficients_std = vector("v", "their standard deviations", unit="N m")
    part_stiffness = vector(2, "of each transmission", unit="N m/rad", symbol="sigma_i")
    part_stiffness_std = vector(2, "their standard deviations", unit="N m/rad")
    part_torque = vector(2, "elastic torque of each", unit="N m", symbol="tau_e,i")
    part_dstiffness = vector(2, "derivative of each by its deflection", unit="N m/rad^2")
    part_deflection = vector(2, "deflection of each", unit="rad", symbol="phi_i")
    part_row_torque = vector(2, "left side of each row", unit="N m")
    part_row_fit = vector(2, "its fit", unit="N m")
    part_verdict = vector(2, "verdict of each", kind="int")
    part_status = vector(2, "status bits of each", kind="int")


def together(first: Any, second: Any) -> None:
    """Learn from both rows or from none, and start again together: their scores are compared."""
    valid = first.valid * second.valid
    fresh = first.fresh + second.fresh
    status = first.status | second.status
    first.valid = valid
    second.valid = valid
    first.fresh = fresh
    second.fresh = fresh
    first.status = status
    second.status = status


def relate(state: Any, sums: Any, first: Any, second: Any) -> None:
    """Renew the correlation of the two stiffnesses' errors.

    Both transmissions are deflected against the same link, so its encoder's errors enter both.
    With V_1, V_2 the variances of each and V the sandwich along both directions at once,
    ``r = (V - V_1 - V_2) / (2 sqrt(V_1 V_2))``, at most 1. Below -1/2 it is not believed: it rests
    on the few longest blocks, and errors that seem to cancel would leave no interval at all.
    """
    p = len(first.direction)
    for i in range(p):
        sums.direction[i] = first.direction[i]
        sums.direction[p + i] = second.direction[i]
    V1 = first.inflation * first.variance * first.spread
    V2 = second.inflation * second.variance * second.spread
    both = blocks.worst(sums, 0, sums.direction)
    state.correlation = 0.0
    if both > 0.0 and V1 > 0.0 and V2 > 0.0:
        r = (both - V1 - V2) / (2.0 * math.sqrt(V1 * V2))
        if r > 1.0:
            r = 1.0
        if r < LEAST:
            r = LEAST
        state.correlation = r


def read(state: Any, first: Any, second: Any, out: Any) -> None:
    """Sum up: ``sigma_t = sigma_1 + sigma_2``, ``tau_t = tau_1 + tau_2`` (flacco2012 eqs 9-11)."""
    a = first.reading
    b = second.reading
    out.stiffness = a.stiffness + b.stiffness
    out.torque = a.torque + b.torque
    out.dstiffness = a.dstiffness + b.dstiffness
    out.deflection = 0.5 * (a.deflection + b.deflection)
    out.row_torque = a.row_torque + b.row_torque
    out.row_fit = a.row_fit + b.row_fit
    out.noise = math.sqrt(a.noise * a.noise + b.noise * b.noise)
    out.inflation = a.inflation
    if b.inflation > a.inflation:
        out.inflation = b.inflation
    out.informative_deflection = a.informative_deflection
    if b.informative_deflection < a.informative_deflection:
        out.informative_deflection = b.informative_deflection
    out.rows = a.rows
    out.correlation = state.correlation
    _part(a, out, 0)
    _part(b, out, 1)


def _part(reading: Any, out: Any, i: int) -> None:
    out.part_stiffness[i] = reading.stiffness
    out.part_stiffness_std[i] = reading.stiffness_std
    out.part_torque[i] = reading.torque
    out.part_dstiffness[i] = reading.dstiffness
    out.part_deflection[i] = reading.deflection
    out.part_row_torque[i] = reading.row_torque
    out.part_row_fit[i] = reading.row_fit
    out.part_verdict[i] = reading.verdict
    out.part_status[i] = reading.status
    p = len(reading.coefficients)
    for j in range(p):
        out.coefficients[i * p + j] = reading.coefficients[j]
        out.coefficients_std[i * p + j] = reading.coefficients_std[j]


def read2(params: Any, out: Any) -> float:
    """Variance of the sum from the noise of the positions its laws are read at."""
    first = out.part_dstiffness[0]
    second = out.part_dstiffness[1]
    both = first + second
    apart = first * first + second * second
    variance: float = both * both * params.link2 + apart * params.motor2
    return variance


def tell(
    params: Any, state: Any, pair: Any, first: Any, second: Any, time: float, counted: int, out: Any
) -> None:
    """Standard deviation and verdict of the sum.

    ``std^2 = n_1 + n_2 + 2 r sqrt(n_1 n_2) + (w_1 + w_2)^2 + read^2``: noise n with its
    correlation, systematic errors w as if they added up, and where the laws are read: the link's
    noise moves both deflections, each motor's its own.
    """
    a = first.readout
    b = second.readout
    common = 2.0 * pair.correlation * math.sqrt(a.noise2 * b.noise2)
    wrong = a.wrong2 + b.wrong2 + 2.0 * math.sqrt(a.wrong2 * b.wrong2)
    variance = a.noise2 + b.noise2 + common + wrong + read2(params, out)
    out.stiffness_std = 0.0
    if variance > 0.0:
        out.stiffness_std = math.sqrt(variance)
    s = first.reading.torque_std
    t = second.reading.torque_std
    # Its sign follows the deflections', and what is systematic is in it too: the worse of both.
    common = 2.0 * math.fabs(pair.correlation) * s * t
    out.torque_std = math.sqrt(s * s + t * t + common)
    status = first.reading.status | second.reading.status
    status = status - (status & WIDE)
    amiss = first.evidence.wrong | second.evidence.wrong
    if status & PRIOR == 0:
        amiss = amiss | negative(out.stiffness, out.stiffness_std)
    decide(params, state, status, amiss, time, counted, out)
