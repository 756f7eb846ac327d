"""Figures 11 to 16: the AwAS in motion, what is read from eta_02, the characteristic surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.columns import Power
from rotatum.evaluation.papers.case import Case, Curve, Figure, Map, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import awas
from rotatum.evaluation.papers.flacco2012.kinematics import compared, rms
from rotatum.evaluation.papers.flacco2012.modality import (
    MODALITIES,
    SCORED_FROM,
    Printed,
    channels,
    leading,
    printed,
    weak,
    weak_law,
)
from rotatum.evaluation.papers.flacco2012.settings import AWAS
from rotatum.evaluation.papers.frozen import FrozenLaw

__all__ = ["CASE", "coefficients", "spring", "surface"]

Array = NDArray[np.float64]

COUNTS = 40_000.0
TIME = "time, s"
# (i, j) of eta_ij, with the powers of deflection and lever arm it belongs to.
SHOWN = {(0, 0): Power(1, 0), (0, 1): Power(1, 1), (0, 2): Power(1, 2), (1, 1): Power(3, 1)}


def _run(progress: Progress, quick: bool) -> Outcome:
    papers, device = awas.device(awas.PAPER_ORDERS), awas.device()
    log, ideal = awas.motion(papers, 0), awas.motion(papers, 0, ideal=True)
    logged, true = channels(papers, log), channels(papers, ideal)
    runs: dict[str, Printed] = {}
    for modality in MODALITIES:
        runs[modality] = printed(papers, log, modality, AWAS)
        progress(len(runs), len(MODALITIES) + 1)
    joint = weak(device, log)
    progress(len(MODALITIES) + 1, len(MODALITIES) + 1)
    (best,) = weak_law(device, joint)
    (own,) = runs["RESIDUAL"].laws
    phi = true["q"] - true["theta"]
    values = [Value("largest deflection", "rad", 0.005, float(np.abs(phi).max()))]
    figures = [_deflection(log.time, phi, runs["RESIDUAL"])]
    told, plots = compared("motor velocity", log.time, logged["theta"], true["theta"], COUNTS)
    values += told
    figures.append(Figure("fig12", "Velocity of the motor (fig. 12)", NOTE_12, TIME, plots))
    figures.append(_torque(log.time, logged, runs["RESIDUAL"], values))
    figures.append(_stiffness(log.time, logged["stiffness_true"], runs, joint.records["stiffness"]))
    figures.append(coefficients(log.time, runs["RESIDUAL"], "fig. 15"))
    figures.append(surface(best, phi, true["lever"], logged["torque_measured"], "fig. 16"))
    etas = leading(own), leading(best)
    values.append(Value("eta_02", "kN/mm", 0.0284, *(1e-6 * eta for eta in etas)))
    values.append(Value("k_s = eta_02 / 2", "N/m", 14220.0, *(0.5 * eta for eta in etas)))
    lawful = spring(own, phi, true["lever"]), spring(best, phi, true["lever"])
    values.append(Value("k_s from the whole law", "N/m", 14220.0, *lawful))
    share = _others(own, phi, true["lever"]), _others(best, phi, true["lever"])
    label = "largest torque of all coefficients but eta_02"
    values.append(Value(label, "N m", None, *share))
    return Outcome(tuple(values), tuple(figures), FINDINGS)


def spring(law: FrozenLaw, phi: Array, lever: Array) -> float:
    """Return the k_s whose ``k_s r^2 sin 2 phi`` is nearest to a law over a motion, N/m.

    Args:
        law: fitted.
        phi, lever: (N,) rad, m.
    """
    shape = lever**2 * np.sin(2.0 * phi)
    return float(shape @ law.torque(phi, lever) / (shape @ shape))


def _others(law: FrozenLaw, phi: Array, lever: Array) -> float:
    """Largest torque over the motion that is not eta_02's, N m."""
    alone = leading(law) * phi * lever**2
    return float(np.abs(law.torque(phi, lever) - alone).max())


def _deflection(t: Array, phi: Array, run: Printed) -> Figure:
    found = Curve("MKKF", t, 1e3 * run.out["deflection"])
    plot = Plot("deflection, mrad", (found, Curve("actual", t, 1e3 * phi, "dashed")))
    return Figure("fig11", "Deflection (fig. 11)", NOTE_11, TIME, (plot,))


def _torque(t: Array, logged: dict[str, Array], run: Printed, values: list[Value]) -> Figure:
    actual, seen = logged["torque_true"], t >= SCORED_FROM
    found = {
        "sensor": logged["torque_measured"],
        "residual": run.out["row_torque"],
        "RLS on the residual": run.out["torque"],
    }
    for name, x in found.items():
        values.append(Value(f"torque: rms error, {name}", "N m", own=rms((x - actual)[seen])))
    curves = [Curve(name, t, x, "dotted") for name, x in found.items()]
    curves[-1] = curves[-1]._replace(style="line")
    plot = Plot("torque, N m", (*curves, Curve("actual", t, actual, "dashed")))
    return Figure("fig13", "Flexibility torque (fig. 13)", NOTE_13, TIME, (plot,))


def _stiffness(t: Array, truth: Array, runs: dict[str, Printed], best: Array) -> Figure:
    curves = [Curve(name, t, run.out["stiffness"]) for name, run in runs.items()]
    curves += [Curve("weak", t, best), Curve("actual", t, truth, "dashed")]
    limits = 0.8 * float(truth.min()), 1.2 * float(truth.max())
    plot = Plot("stiffness, N m/rad", tuple(curves), limits=limits)
    return Figure("fig14", "Stiffness (fig. 14)", NOTE_14, TIME, (plot,))


def coefficients(t: Array, run: Printed, figure: str) -> Figure:
    """Draw the eta_ij the paper calls most relevant, in N m, mm and rad.

    Args:
        t: (N,) s.
        run: with the paper's settings.
        figure: of the paper.
    """
    (law,) = run.laws
    plots = []
    for (i, j), power in SHOWN.items():
        eta = run.out["coefficients"][:, law.powers.index(power)]
        title = f"eta_{i}{j}, N m/(rad^{power.deflection} mm^{power.setpoint})"
        plots.append(Plot(title, (Curve("RESIDUAL", t, eta),)))
    key = figure.replace(". ", "")
    return Figure(key, f"Coefficients ({figure})", NOTE_15, TIME, tuple(plots))


def surface(law: FrozenLaw, phi: Array, lever: Array, torque: Array, figure: str) -> Figure:
    """Draw the final law over deflection and lever arm, and slices of it with data.

    Args:
        law: to draw.
        phi, lever, torque: (N,) data: rad, m, N m.
        figure: of the paper.
    """
    x = np.linspace(phi.min(), phi.max(), 81)
    r = np.linspace(lever.min(), lever.max(), 61)
    plane = Map("torque, N m", 1e3 * x, 1e3 * r, law.torque(x[None, :], r[:, None]))
    data = Curve("data", 1e3 * phi[::50], 1e3 * lever[::50], "points")
    plots = [Plot("lever arm, mm", (data,), map=plane)]
    for at in np.linspace(r[0], r[-1], 3):
        near = np.abs(lever - at) < 0.02 * (r[-1] - r[0])
        curves = (
            Curve("data", 1e3 * phi[near][::20], torque[near][::20], "points"),
            Curve("law", 1e3 * x, law.torque(x, at)),
        )
        plots.append(Plot(f"torque at {1e3 * at:.0f} mm, N m", curves))
    key, title = figure.replace(". ", ""), f"Characteristic surface ({figure})"
    return Figure(key, title, NOTE_16, "deflection, mrad", tuple(plots))


NOTE_11 = "Of the order of 0.005 rad: a count of the encoders is 0.16 mrad."
NOTE_12 = "One count in one sample is 0.16 rad/s."
NOTE_13 = "The residual is noisy, the law fitted to it is not."
NOTE_14 = "The first second shows the recursion finding its way."
NOTE_15 = "In rad and mm: with these units eta_02 dominates and the others are negligible."
NOTE_16 = (
    "Colour: torque of the law found by weak. Crosses: where the motion was. Below: the law at "
    "three lever arms, with measured torques near them."
)
FINDINGS = (
    "eta_02 is read after the law has been expanded in powers of r itself. Between 80 and 100 mm "
    "r^2 is nearly a straight line, so the data hardly tell eta_02 from eta_00 and eta_01: the "
    "paper's recursion finds it because its prior in millimetres asks for it, weak leaves it out. "
    "What the data do tell is the k_s nearest to the whole law.",
)

CASE = Case(
    "fig11-16",
    "the AwAS by time, k_s from eta_02, the characteristic surface",
    "Figures 11 to 16: deflections of the order of 0.005 rad, eta_02 = 0.0284 kN/mm = 2 k_s.",
    awas.ASSUMED,
    _run,
)
