"""Section 8's validation: a law frozen after one motion predicts the torque of another."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import awas, vsa2
from rotatum.evaluation.papers.flacco2012.kinematics import filtered, rms
from rotatum.evaluation.papers.flacco2012.modality import channels, printed, weak, weak_law
from rotatum.evaluation.papers.flacco2012.settings import AWAS, VSA2
from rotatum.evaluation.papers.frozen import FrozenLaw
from rotatum.models import Device
from rotatum.simulation import Drive, sine

__all__ = ["CASE"]

Array = NDArray[np.float64]
Channels = Mapping[str, Array]
Laws = Mapping[str, tuple[FrozenLaw, ...]]

# Other frequencies than in the paper's own motion, and a deflection about twice as large.
AWAS_TORQUE = sine(24.0, 0.23)
AWAS_LEVER = awas.Sweep(high=0.1, low=0.08, period=16.0)
VSA2_DRIVES: dict[str, Drive] = {
    "tau1": sine(0.04, 0.3) + sine(0.02, 0.11, 1.0),
    "tau2": sine(0.05, 0.7),
}
SEEN = ("at the true deflection", "at the filtered deflection", "at the encoders' deflection")


def _run(progress: Progress, quick: bool) -> Outcome:
    values, figures = [], []
    for number, part in enumerate((_serial, _antagonistic)):
        name, log_time, predictions, actual = part()
        progress(1 + number, 2)
        for seen in SEEN:
            errors = (
                100.0 * rms(predictions[method, seen] - actual) / rms(actual)
                for method in ("RESIDUAL", "weak")
            )
            label = f"{name}: rms error over rms torque, {seen}"
            values.append(Value(label, "%", None, *errors))
        curves = (
            Curve("weak", log_time, predictions["weak", SEEN[1]]),
            Curve("actual", log_time, actual, "dashed"),
        )
        error = (Curve("weak", log_time, predictions["weak", SEEN[1]] - actual),)
        plots = (Plot("torque, N m", curves), Plot("error, N m", error))
        title = f"{name}: torque of a motion not learned from"
        figures.append(Figure(name, title, NOTE, "time, s", plots))
    return Outcome(tuple(values), tuple(figures), FINDINGS)


Predicted = tuple[str, Array, dict[tuple[str, str], Array], Array]


def _serial() -> Predicted:
    papers, device = awas.device(awas.PAPER_ORDERS), awas.device()
    first = awas.motion(device, 0)
    laws: Laws = {
        "RESIDUAL": printed(papers, first, "RESIDUAL", AWAS).laws,
        "weak": weak_law(device, weak(device, first)),
    }
    second, ideal = (
        awas.motion(device, 1, torque=AWAS_TORQUE, lever=AWAS_LEVER, ideal=each)
        for each in (False, True)
    )
    logged, true = channels(device, second), channels(device, ideal)
    return "awas", second.time, _predict(device, laws, logged, true, ("",)), true["torque_true"]


def _antagonistic() -> Predicted:
    device = vsa2.device()
    first = vsa2.motion(device, 0)
    laws: Laws = {
        "RESIDUAL": printed(device, first, "RESIDUAL", VSA2).laws,
        "weak": weak_law(device, weak(device, first)),
    }
    second, ideal = (
        vsa2.motion(device, 1, drives=VSA2_DRIVES, ideal=each) for each in (False, True)
    )
    logged, true = channels(device, second), channels(device, ideal)
    found = _predict(device, laws, logged, true, ("1", "2"))
    return "vsa-ii", second.time, found, true["torque_true"]


def _predict(
    device: Device, laws: Laws, logged: Channels, true: Channels, ends: tuple[str, ...]
) -> dict[tuple[str, str], Array]:
    """Torque of the joint: (method, how the deflection is known) to (N,) N m."""
    (joint,) = device.joints
    counts = joint.encoders.motor or 1.0
    smooth = {
        role: filtered(logged[role], vsa2.PERIOD, counts)[0]
        for role in ("q", *(f"theta{end}" for end in ends))
    }
    found = {}
    for seen, source in zip(SEEN, (true, smooth, logged), strict=True):
        lever = (true if seen == SEEN[0] else logged).get("lever", np.zeros(1))
        for method, pair in laws.items():
            found[method, seen] = sum(
                (
                    law.torque(source["q"] - source[f"theta{end}"], lever)
                    for law, end in zip(pair, ends, strict=True)
                ),
                np.zeros(len(true["q"])),
            )
    return found


NOTE = "The law was fixed before this motion; its deflection is that of the filtered encoders."
FINDINGS = (
    "The first line is the law's own error. The others add what the encoders do not know of the "
    "deflection: a count of the AwAS is 0.16 mrad of its 10 mrad, whatever the law.",
)

CASE = Case(
    "validation",
    "section 8's protocol: coefficients from one motion, torque of another, simulated",
    'Figures 33 to 36, without numbers: "a good match" of predicted and measured torque.',
    (
        "The paper prints no torques of its second experiment. Second motion of the AwAS: "
        "0.48 sin(2 pi 0.23 t) N m at the motor, lever arm swinging in 16 s; of the VSA-II: other "
        "frequencies and sums of sines.",
    ),
    _run,
)
