"""Figures 4 to 8: the VSA-II in motion, torques, stiffness, coefficients, characteristic."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import vsa2
from rotatum.evaluation.papers.flacco2012.kinematics import compared, rms
from rotatum.evaluation.papers.flacco2012.modality import (
    MODALITIES,
    SCORED_FROM,
    Printed,
    channels,
    printed,
    weak,
    weak_law,
)
from rotatum.evaluation.papers.flacco2012.settings import VSA2
from rotatum.evaluation.papers.frozen import FrozenLaw
from rotatum.models import Device

__all__ = ["MOTION", "SHAPE"]

Array = NDArray[np.float64]
Channels = dict[str, Array]

COUNTS = 4059.0
ENDS = ("1", "2")
TIME = "time, s"
MILLI = 1e3


def _motion(progress: Progress, quick: bool) -> Outcome:
    device = vsa2.device()
    log, ideal = vsa2.motion(device, 0), vsa2.motion(device, 0, ideal=True)
    logged, true = channels(device, log), channels(device, ideal)
    runs = {}
    for modality in MODALITIES:
        runs[modality] = printed(device, log, modality, VSA2)
        progress(len(runs), len(MODALITIES) + 1)
    sigma = weak(device, log).records
    progress(len(MODALITIES) + 1, len(MODALITIES) + 1)
    t, seen = log.time, log.time >= SCORED_FROM
    values, figures = [], []
    plots = []
    for i, end in enumerate(ENDS):
        actual = true["q"] - true[f"theta{end}"]
        found = runs["RESIDUAL"].out["part_deflection"][:, i]
        raw = logged["q"] - logged[f"theta{end}"]
        curves = (Curve("actual", t, actual, "dashed"), Curve("MKKF", t, found))
        plots.append(Plot(f"deflection {end}, rad", curves))
        label = f"deflection {end}: rms error"
        values.append(Value(f"{label}, encoders", "mrad", own=MILLI * rms((raw - actual)[seen])))
        values.append(Value(f"{label}, MKKF", "mrad", own=MILLI * rms((found - actual)[seen])))
    figures.append(Figure("fig4", "Deflections (fig. 4)", NOTE_4, TIME, tuple(plots)))
    told, speeds = compared("velocity of motor 2", t, logged["theta2"], true["theta2"], COUNTS)
    values += told
    figures.append(Figure("velocity", "Velocity of motor 2", NOTE_V, TIME, speeds))
    torques = _torques(t, logged, runs["RESIDUAL"], values, seen)
    figures.append(Figure("fig5", "Flexibility torques (fig. 5)", NOTE_5, TIME, torques))
    plots = [_stiffness(t, logged, runs, sigma, part) for part in (*ENDS, "total")]
    figures.append(Figure("fig6", "Stiffness (fig. 6)", NOTE_6, TIME, tuple(plots)))
    return Outcome(tuple(values), tuple(figures))


def _torques(
    t: Array, logged: Channels, run: Printed, values: list[Value], seen: NDArray[np.bool_]
) -> tuple[Plot, ...]:
    """Torque of both transmissions and their sum, in N mm."""
    plots = []
    for part in (*ENDS, "total"):
        if part == "total":
            actual = logged["torque_true"]
            sensed = logged["torque_measured1"] + logged["torque_measured2"]
            residual, fit = run.out["row_torque"], run.out["torque"]
        else:
            i = int(part) - 1
            actual, sensed = logged[f"torque{part}_true"], logged[f"torque_measured{part}"]
            residual, fit = run.out["part_row_torque"][:, i], run.out["part_torque"][:, i]
        found = {"sensor": sensed, "residual": residual, "RLS on the residual": fit}
        curves = [Curve(name, t, MILLI * x, "dotted") for name, x in found.items()]
        curves[-1] = curves[-1]._replace(style="line")
        curves.append(Curve("actual", t, MILLI * actual, "dashed"))
        plots.append(Plot(f"torque {part}, N mm", tuple(curves)))
        for name, x in found.items():
            error = MILLI * rms((x - actual)[seen])
            values.append(Value(f"torque {part}: rms error, {name}", "N mm", own=error))
    return tuple(plots)


def _stiffness(
    t: Array, logged: Channels, runs: dict[str, Printed], best: NDArray[np.void], part: str
) -> Plot:
    def pick(records: NDArray[np.void]) -> Array:
        if part == "total":
            return np.asarray(records["stiffness"])
        return np.asarray(records["part_stiffness"][:, int(part) - 1])

    truth = logged["stiffness_true" if part == "total" else f"stiffness{part}_true"]
    curves = [Curve(name, t, MILLI * pick(run.out)) for name, run in runs.items()]
    curves.append(Curve("weak", t, MILLI * pick(best)))
    curves.append(Curve("actual", t, MILLI * truth, "dashed"))
    low, high = MILLI * float(truth.min()), MILLI * float(truth.max())
    margin = 0.5 * (high - low)
    limits = (low - margin, high + margin)
    return Plot(f"stiffness {part}, N mm/rad", tuple(curves), limits=limits)


def _shape(progress: Progress, quick: bool) -> Outcome:
    device = vsa2.device()
    log = vsa2.motion(device, 0)
    run = printed(device, log, "RESIDUAL", VSA2)
    laws = weak_law(device, weak(device, log))
    progress(1, 1)
    values, figures = [], []
    for i, end in enumerate(ENDS):
        coefficients = run.out["coefficients"].reshape(log.samples, 2, -1)[:, i]
        powers = run.laws[i].powers
        plots = tuple(
            Plot(
                f"coefficient of phi^{p.deflection}, N mm/rad^{p.deflection}",
                (Curve("RESIDUAL", log.time, MILLI * coefficients[:, h]),),
            )
            for h, p in enumerate(powers)
        )
        title = f"Coefficients of transmission {end} (fig. 7)"
        figures.append(Figure(f"fig7-{end}", title, NOTE_7, TIME, plots))
        values += _terms(end, run.laws[i], laws[i], run, i)
    figures.append(_characteristic(device, run, laws))
    return Outcome(tuple(values), tuple(figures))


def _terms(end: str, own: FrozenLaw, best: FrozenLaw, run: Printed, i: int) -> list[Value]:
    """What each term contributes at the largest deflection, over the torque there."""
    largest = float(np.abs(run.out["part_deflection"][:, i]).max())
    found = []
    for h, power in enumerate(own.powers):
        shares = [
            100.0
            * float(law.coefficients[h])
            * largest**power.deflection
            / float(law.torque(largest))
            for law in (own, best)
        ]
        label = f"transmission {end}: phi^{power.deflection} in the torque at {largest:.2f} rad"
        found.append(Value(label, "%", None, *shares))
    return found


def _characteristic(device: Device, run: Printed, laws: tuple[FrozenLaw, ...]) -> Figure:
    (joint,) = device.joints
    plots = []
    for i, end in enumerate(ENDS):
        phi = run.out["part_deflection"][::40, i]
        data = MILLI * run.out["part_row_torque"][::40, i]
        x = np.linspace(phi.min(), phi.max(), 121)
        curves = (
            Curve("residual", phi, data, "points"),
            Curve("RESIDUAL", x, MILLI * run.laws[i].torque(x)),
            Curve("weak", x, MILLI * laws[i].torque(x)),
            Curve("actual", x, MILLI * joint.transmissions[i].torque(x), "dashed"),
        )
        plots.append(Plot(f"torque {end}, N mm", curves))
    title = "Characteristics at the end (fig. 8)"
    return Figure("fig8", title, NOTE_8, "deflection, rad", tuple(plots))


NOTE_4 = "Deflections from the filtered encoders lie on the actual ones."
NOTE_V = "One count in one sample is 1.5 rad/s: differencing shows little else."
NOTE_5 = "Sensor and residual are noisy; the fitted law has the noise averaged out."
NOTE_6 = "All modalities settle within about a second."
NOTE_7 = "In powers of rad, as the recursion of the paper has them."
NOTE_8 = "Every 40th sample of the residual, and the laws as they are at the end."

MOTION = Case(
    "fig4-6",
    "the VSA-II's deflections, torques and stiffness by time",
    "Figures 4 to 6, without numbers: deflections from the filtered encoders, noisy torques and "
    "a clean fit, stiffness that settles quickly.",
    vsa2.ASSUMED,
    _motion,
)
SHAPE = Case(
    "fig7-8",
    "the VSA-II's coefficients by time and its characteristics",
    "Figures 7 and 8, without numbers: coefficients become constant, the last is negligible.",
    vsa2.ASSUMED,
    _shape,
)
CASES = (MOTION, SHAPE)
