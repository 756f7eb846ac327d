"""Figures 17 to 20: how the arm moves, the stiffness of its joints, and what it is off by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Curve, Figure, Plot
from rotatum.evaluation.papers.flacco2012.arm_runs import METHODS, PARTS, JointRuns, run_joint
from rotatum.evaluation.papers.flacco2012.modality import SCORED_FROM
from rotatum.simulation.scenario import Scenario

__all__ = ["arm_figures"]

Array = NDArray[np.float64]

TIME = "time, s"
MILLI = 1e3
MARGIN = 0.5  # of the stiffness's range, above and below it
ERRORS = 10.0  # %, shown either way

NOTE_MOTION = "In the horizontal plane; deflections are those of the encoders."
NOTE_STIFFNESS = "Both springs, and their sum, which the link feels."
NOTE_ERRORS = f"Estimate less actual over actual; scores are from {SCORED_FROM:g} s on."


def arm_figures(scenario: Scenario, names: Sequence[str]) -> tuple[Figure, ...]:
    """Simulate the arm with seed 0; draw its motion, and stiffness and errors of each joint.

    Args:
        scenario: of the arm.
        names: of its joints.
    """
    log = scenario.run(0)
    t = log.time
    turns, bends, figures = [], [], []
    for name in names:
        joint = run_joint(scenario.device.only([name]), log)
        turns.append(Plot(f"{name}, rad", (Curve("link", t, joint.logged["q"]),)))
        ends = tuple(Curve(f"deflection {end}", t, joint.deflection(end)) for end in PARTS[:2])
        bends.append(Plot(f"{name}: deflections, rad", ends))
        stiffness = tuple(_stiffness(t, joint, part) for part in PARTS)
        errors = tuple(_errors(t, joint, part) for part in PARTS)
        title = f"Stiffness of the {name} (figs 17 to 20)"
        figures.append(Figure(f"stiffness-{name}", title, NOTE_STIFFNESS, TIME, stiffness))
        title = f"Relative error of the {name} (figs 17 to 20)"
        figures.append(Figure(f"errors-{name}", title, NOTE_ERRORS, TIME, errors))
    motion = Figure("motion", "Motion of the arm", NOTE_MOTION, TIME, (*turns, *bends))
    return (motion, *figures)


def _stiffness(t: Array, joint: JointRuns, part: str) -> Plot:
    truth = MILLI * joint.truth(part)
    curves = [Curve(method, t, MILLI * joint.stiffness(method, part)) for method in METHODS]
    curves.append(Curve("actual", t, truth, "dashed"))
    low, high = float(truth.min()), float(truth.max())
    margin = MARGIN * (high - low)
    return Plot(f"{part}, N mm/rad", tuple(curves), limits=(low - margin, high + margin))


def _errors(t: Array, joint: JointRuns, part: str) -> Plot:
    truth = joint.truth(part)
    curves = tuple(
        Curve(method, t, 100.0 * (joint.stiffness(method, part) / truth - 1.0))
        for method in METHODS
    )
    return Plot(f"{part}, %", curves, limits=(-ERRORS, ERRORS))
