"""Figures 26 to 32: section 8's experiment, on simulated data with a wrong nominal model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import awas
from rotatum.evaluation.papers.flacco2012.modality import (
    SCORED_FROM,
    Printed,
    channels,
    leading,
    printed,
    score,
    weak,
    weak_law,
)
from rotatum.evaluation.papers.flacco2012.serial_figures import coefficients, spring, surface
from rotatum.evaluation.papers.flacco2012.settings import AWAS
from rotatum.evaluation.papers.variants import with_basis, with_spring
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.simulation import sine

__all__ = ["CASE", "LEVER", "NOISE", "SPRING", "TORQUE", "devices"]

Array = NDArray[np.float64]

SPRING = 10_700.0  # N/m, what the paper finds
LEVER = awas.Sweep(high=0.09, low=0.05, period=20.0)
TORQUE = sine(15.0, 0.1)
NOISE = 0.1  # N m at the joint
TIME = "time, s"


def devices(orders: int) -> tuple[Device, Device]:
    """Return the nominal device (14,220 N/m) and the true one (10,700 N/m).

    Args:
        orders: odd powers of the deflection.
    """
    nominal = with_basis(
        awas.device(orders), setpoint_range=(LEVER.low, LEVER.high), deflection_range=0.03
    )
    return nominal, with_spring(nominal, SPRING)


def _run(progress: Progress, quick: bool) -> Outcome:
    papers, truly = devices(awas.PAPER_ORDERS)
    log = awas.motion(truly, 0, torque=TORQUE, lever=LEVER, noise=NOISE)
    logged = channels(papers, log)
    runs = {
        name: printed(papers, log, modality, AWAS)
        for name, modality in (("MODEL", "NOMINAL"), ("SENSOR", "SENSOR"), ("RESIDUAL", "RESIDUAL"))
    }
    progress(1, 2)
    device, _ = devices(3)
    best = {
        name: weak(device, log, torque=torque)
        for name, torque in (("SENSOR", "sensor"), ("RESIDUAL", "estimated"))
    }
    progress(2, 2)
    values = _scores(papers, log, logged, runs)
    sensed, residual = (best[name].records["stiffness"] for name in ("SENSOR", "RESIDUAL"))
    relative = score(log, residual, sensed)
    ours = score(log, runs["RESIDUAL"].out["stiffness"], runs["SENSOR"].out["stiffness"])
    values.append(Value("RESIDUAL against SENSOR, MSREP", "%", 1.55, ours[1], relative[1]))
    values.append(Value("RESIDUAL against SENSOR, MSE", SQUARE, 63.02, ours[0], relative[0]))
    truth = logged["stiffness_true"]
    for name in ("SENSOR", "RESIDUAL"):
        errors = (
            score(log, run, truth)[1]
            for run in (runs[name].out["stiffness"], best[name].records["stiffness"])
        )
        values.append(Value(f"{name} against the truth, MSREP", "%", None, *errors))
    phi = logged["q"] - logged["theta"]
    for name in ("SENSOR", "RESIDUAL"):
        (own,), (found,) = runs[name].laws, weak_law(device, best[name])
        told = 0.5 * leading(own), 0.5 * leading(found)
        values.append(Value(f"k_s from eta_02, {name}", "N/m", 10_700.0, *told))
        told = spring(own, phi, logged["lever"]), spring(found, phi, logged["lever"])
        values.append(Value(f"k_s from the whole law, {name}", "N/m", None, *told))
    figures = _figures(papers, log, logged, runs, residual)
    (law,) = weak_law(device, best["RESIDUAL"])
    figures.append(surface(law, phi, logged["lever"], logged["torque_measured"], "fig. 32"))
    return Outcome(tuple(values), tuple(figures), FINDINGS)


SQUARE = "(N m/rad)^2"


def _scores(
    papers: Device, log: Log, logged: dict[str, Array], runs: dict[str, Printed]
) -> list[Value]:
    nominal = _nominal(papers, logged)
    model = score(log, runs["MODEL"].out["stiffness"], nominal)
    wrong = score(log, nominal, logged["stiffness_true"])
    return [
        Value("MODEL against nominal, MSREP", "%", 0.034, model[1]),
        Value("MODEL against nominal, MSE", SQUARE, 9.36, model[0]),
        Value("nominal against the truth, MSREP", "%", None, wrong[1]),
    ]


def _nominal(papers: Device, logged: dict[str, Array]) -> Array:
    """The nominal stiffness (eq. 50) at the measured deflection and lever arm, N m/rad."""
    (joint,) = papers.joints
    phi = logged["q"] - logged["theta"]
    return np.asarray(joint.transmission.stiffness(phi, logged["lever"]))


def _figures(
    papers: Device,
    log: Log,
    logged: dict[str, Array],
    runs: dict[str, Printed],
    best: Array,
) -> list[Figure]:
    (joint,) = papers.joints
    t, lever = log.time, logged["lever"]
    phi = logged["q"] - logged["theta"]
    arm = Plot("lever arm, mm", (Curve("measured", t, 1e3 * lever),))
    moved = Plot("deflection, mrad", (Curve("measured", t, 1e3 * phi, "dotted"),))
    part = (t >= SCORED_FROM) & (t < SCORED_FROM + 10.0)
    nominal = np.asarray(joint.transmission.torque(phi[part], lever[part]))
    torques = (
        Curve("SENSOR", t[part], logged["torque_measured"][part], "dotted"),
        Curve("nominal", t[part], nominal, "dashed"),
    )
    stiff = _nominal(papers, logged)
    truth = logged["stiffness_true"]
    curves = [Curve(name, t, run.out["stiffness"]) for name, run in runs.items()]
    curves += [Curve("weak", t, best), Curve("nominal", t, stiff, "dotted")]
    curves.append(Curve("actual", t, truth, "dashed"))
    limits = 0.8 * float(truth.min()), 1.1 * float(stiff.max())
    shown = Plot("stiffness, N m/rad", tuple(curves), limits=limits)
    return [
        Figure("fig26-27", "Lever arm and deflection (figs 26, 27)", NOTE_26, TIME, (arm, moved)),
        Figure(
            "fig28", "Torque, 10 s of it (fig. 28)", NOTE_28, TIME, (Plot("torque, N m", torques),)
        ),
        Figure("fig29", "Stiffness (fig. 29)", NOTE_29, TIME, (shown,)),
        coefficients(t, runs["RESIDUAL"], "fig. 30"),
    ]


NOTE_26 = "The motion of both motors."
NOTE_28 = "The nominal spring is a third too stiff."
NOTE_29 = "MODEL follows the nominal stiffness it is fed with; SENSOR and RESIDUAL find the actual."
FINDINGS = (
    "The experiment is simulated: the recordings are not public. The true spring has the "
    "10,700 N/m the paper finds, the nominal one its 14,220 N/m.",
)

CASE = Case(
    "fig26-32",
    "section 8: a wrong nominal model against sensor and residual, simulated",
    "MODEL against nominal: MSE 9.36, MSREP 0.034 %; RESIDUAL against SENSOR: MSE 63.02, MSREP "
    "1.55 %; k_s = 0.0107 kN/mm.",
    (
        "The paper prints neither the torques nor the noise of its experiment: a motor torque of "
        "0.3 sin(0.2 pi t) N m, a lever arm that swings between 90 and 50 mm in 20 s, and 0.1 N m "
        "rms at the joint on motor torque and torque sensor are taken.",
        "Scores are from 2 s on.",
    ),
    _run,
)
