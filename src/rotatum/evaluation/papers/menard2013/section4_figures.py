"""Figure 2 of the paper with every method, and their errors against the noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Curve, Figure, Plot
from rotatum.evaluation.papers.menard2013.methods import METHODS, every_method, motion, truth_of
from rotatum.evaluation.papers.menard2013.scores import LAW, SCORED_FROM, Medians

__all__ = ["section4_figures"]

Array = NDArray[np.float64]

TIME = "time, s"
SHOWN = 1e-3, 0.002  # rad and N m, noise of the motion that is drawn
ERRORS = 10.0  # %, shown either way
NOTE_MOTION = "One run, 1 mrad of noise on positions and 2 mN m on torques."
NOTE_TIME = (
    "Total stiffness of the same run, and its error over the truth; scores are from 2 s on. The "
    "band of algebraic and weak is the noise of the deflection they are read out at."
)
NOTE_NOISE = (
    "Medians over the seeds. Thin: the same laws read out at the true deflection. No noise has "
    "no place on this axis; the table has it."
)


def section4_figures(medians: Medians, torques: Sequence[float]) -> tuple[Figure, ...]:
    """Draw one run, and MSREP by noise of the positions, a plot for each noise of the torques.

    Args:
        medians: of all conditions.
        torques: standard deviations of the torques' noise, N m.
    """
    device, log = motion(*SHOWN, 0)
    (joint,) = device.joints
    logged, t = log.joints[joint.name], log.time
    inputs = tuple(Curve(f"motor {end}", t, logged[f"tau{end}"]) for end in ("1", "2"))
    bends = tuple(
        Curve(f"motor {end}", t, logged["q"] - logged[f"theta{end}"]) for end in ("1", "2")
    )
    plots = (Plot("torque, N m", inputs), Plot("deflection, rad", bends))
    moved = Figure("motion", "Torques and deflections (figs 2a and 2b)", NOTE_MOTION, TIME, plots)
    truth = truth_of(device, log, "total")
    found = every_method(device, log)
    each = [Curve(method, t, _late(t, found[method].stiffness)) for method in METHODS]
    errors = tuple(
        Curve(method, t, _late(t, _relative(found[method].stiffness, truth))) for method in METHODS
    )
    each.append(Curve("actual", t, truth, "dashed"))
    stiffness = Plot("stiffness, N m/rad", tuple(each), limits=(0.0, 1.2 * float(truth.max())))
    plots = (stiffness, Plot("error, %", errors, limits=(-ERRORS, ERRORS)))
    shown = Figure("fig2", "Total stiffness (figs 2c and 2d)", NOTE_TIME, TIME, plots)
    noise = tuple(_against_noise(medians, torque) for torque in torques)
    title = "MSREP against the noise of the positions"
    swept = Figure("noise", title, NOTE_NOISE, "noise of the positions, rad", noise, True)
    return moved, shown, swept


def _against_noise(medians: Medians, torque: float) -> Plot:
    noises = [noise for noise in medians.levels(torque) if noise > 0.0]
    x = np.array(noises)
    curves: list[Curve] = []
    for what in ("total", LAW):
        # algebraic last and dashed: it often lies on weak.
        for method in sorted(METHODS, key="algebraic".__eq__):
            y = np.array([medians.of(noise, torque, method, what) for noise in noises])
            style = "dashed" if method == "algebraic" else "line"
            curves.append(Curve(method, x, y, "dotted" if what == LAW else style))
    title = f"MSREP, %; torque noise {1e3 * torque:g} mN m"
    return Plot(title, tuple(curves), logarithmic=True)


def _late(t: Array, values: Array) -> Array:
    """Nothing before the scores begin: the first laws are wild."""
    return np.where(t >= t[0] + SCORED_FROM, values, np.nan)


def _relative(sigma: Array, truth: Array) -> Array:
    return 100.0 * (sigma / np.maximum(truth, 1e-9) - 1.0)
