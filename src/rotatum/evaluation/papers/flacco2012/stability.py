"""Figures 21 and 22: the stability factor of eq. 41 against constant factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.rowstages import rows_stage
from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import awas
from rotatum.evaluation.papers.flacco2012.modality import SCORED_FROM, channels, score
from rotatum.evaluation.papers.flacco2012.settings import AWAS, as_printed
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.record import Records
from rotatum.runtime.bank import Bank

__all__ = ["CASE", "Recursion", "recursion", "rows_of"]

Array = NDArray[np.float64]

CONSTANT = (1e-8, 1e-6, 1e-4, 1e-2, 1.0)


class Recursion(NamedTuple):
    """What eqs 23 and 39 did.

    Args:
        factor: (N,) a(k).
        stiffness: (N,) read out after each sample, N m/rad.
    """

    factor: Array
    stiffness: Array


def recursion(
    F: Array, D: Array, y: Array, spread: float, *, c: float = 0.0, factor: float | None = None
) -> Recursion:
    """Run eqs 23 and 39 over rows.

    ``K = P F / (1 + rho)``, ``alpha += a K e``, ``P -= a K F^T P``, ``rho = F^T P F``, with
    ``a = (c + c rho) / (1 + c rho)`` (eq. 41) or constant. A constant factor is a measurement
    variance ``(1 + rho - a rho) / a`` that changes with rho, which no solver here has: hence this
    loop. P is kept symmetric; otherwise it is as printed.

    Args:
        F, D: (N, b) basis and its derivative by deflection.
        y: (N,) torque.
        spread: P(0), times the identity.
        c: of eq. 41.
        factor: constant a; None: eq. 41.
    """
    P = spread * np.eye(F.shape[1])
    alpha = np.zeros(F.shape[1])
    factors, sigma = np.empty(len(y)), np.empty(len(y))
    for k, (row, slope, torque) in enumerate(zip(F, D, y, strict=True)):
        g = P @ row
        rho = float(row @ g)
        a = (c + c * rho) / (1.0 + c * rho) if factor is None else factor
        gain = a / (1.0 + rho)
        alpha += gain * (torque - float(row @ alpha)) * g
        P -= gain * np.outer(g, g)
        factors[k], sigma[k] = a, float(slope @ alpha)
    return Recursion(factors, sigma)


def rows_of(device: Device, log: Log) -> Records:
    """Return the rows (N,) of the paper's method, before any solver.

    Args:
        device: of one joint.
        log: of its motion.
    """
    prepared = as_printed(device, AWAS, period=log.period)
    stage = rows_stage(prepared.shape)
    params = stage.params.zeros(1)
    params[0] = prepared.parts[0]["rows"]
    logged = channels(device, log)
    u = stage.input.zeros(log.samples, 1)
    u["time"][:, 0], u["enable"] = log.time, 1
    for role, channel in (("q", "q"), ("theta", "theta"), ("setpoint", "setpoint")):
        u[role][:, 0] = logged[channel]
    u["torque"][:, 0] = logged["tau"]
    rows: Records = Bank(stage, params).run(u)[:, 0]
    return rows


def _run(progress: Progress, quick: bool) -> Outcome:
    device = awas.device(awas.PAPER_ORDERS)
    log = awas.motion(device, 0)
    rows, truth = rows_of(device, log), channels(device, log)["stiffness_true"]
    constant = CONSTANT[::4] if quick else CONSTANT
    data = np.asarray(rows["F"]), np.asarray(rows["D"]), np.asarray(rows["y"])
    varying = recursion(*data, AWAS.spread, c=AWAS.c)
    progress(1, 1 + len(constant))
    t, seen = log.time, log.time >= SCORED_FROM
    error = score(log, varying.stiffness, truth)[1]
    values = [Value("MSREP, a(k) of eq. 41", "%", None, error)]
    lowest, middle = float(varying.factor[seen].min()), float(np.median(varying.factor[seen]))
    values.append(Value("a(k): lowest", "1", None, lowest))
    values.append(Value("a(k): median", "1", None, middle))
    curves = [Curve("a(k)", t, varying.stiffness)]
    for number, a in enumerate(constant):
        with np.errstate(all="ignore"):  # a constant factor may run away; that is the point
            sigma = recursion(*data, AWAS.spread, factor=a).stiffness
        error = score(log, sigma, truth)[1]
        values.append(Value(f"MSREP, constant a = {a:g}", "%", None, error))
        curves.append(Curve(f"a = {a:g}", t, sigma))
        progress(2 + number, 1 + len(constant))
    phi = np.abs(np.asarray(rows["phi"]))
    factor = Curve("a(k)", t, np.maximum(varying.factor, 1e-12))
    plots = (
        Plot("a(k)", (factor,), logarithmic=True),
        Plot("size of the deflection, mrad", (Curve("deflection", t, 1e3 * phi),)),
    )
    limits = 0.5 * float(truth.min()), 1.5 * float(truth.max())
    stiffness = Plot(
        "stiffness, N m/rad", (*curves, Curve("actual", t, truth, "dashed")), limits=limits
    )
    figures = (
        Figure("fig21", "Stability factor (fig. 21)", NOTE_21, "time, s", plots),
        Figure("fig22", "Constant factors (fig. 22)", NOTE_22, "time, s", (stiffness,)),
    )
    return Outcome(tuple(values), figures, FINDINGS)


NOTE_21 = "Low where the deflection is near zero: such rows tell little and change little."
NOTE_22 = "Small constant factors are slow, large ones follow the noise of poor rows."
FINDINGS = (
    "With eq. 41 the recursion is plain least squares with measurement variance 1/c: a(k) is not "
    "a factor to be tuned, it follows from P(0) and c.",
)

CASE = Case(
    "fig21-22",
    "the AwAS with the stability factor a(k) and with constant factors",
    "Figures 21 and 22, without numbers: a(k) falls where the deflection passes zero; constant "
    "factors are slow or sensitive.",
    (*awas.ASSUMED, "The constant factors are not printed; powers of ten are taken."),
    _run,
)
