"""Colours that stay apart for colour-blind eyes (Okabe and Ito), on light and dark ground."""

from __future__ import annotations

from rotatum.kernels.status import VERDICTS

__all__ = [
    "BAND",
    "DATA",
    "ESTIMATE",
    "MEASURED",
    "METHODS",
    "PARTS",
    "PART_BANDS",
    "SLICES",
    "SLICE_BANDS",
    "SURFACE",
    "THRESHOLD",
    "TRUTH",
    "VERDICT_COLOURS",
    "VERDICT_MEANINGS",
    "VERDICT_SCALE",
]

ESTIMATE = "#0072B2"
BAND = "rgba(0, 114, 178, 0.22)"
TRUTH = "#D55E00"
MEASURED = "#E69F00"
DATA = "#7A8794"
THRESHOLD = "#CC79A7"

# A comparison's methods; those of the same kind on both sides are near one another.
METHODS: dict[str, str] = {
    "weak, motor side": "#0072B2",
    "weak, window, motor side": "#56B4E9",
    "algebraic, motor side": "#CC79A7",
    "residual, motor side": "#7A8794",
    "weak, torque sensor, motor side": "#E69F00",
    "weak, link side": "#009E73",
    "weak, window, link side": "#8FB339",
    "rotatum, link side": "#7B6BB0",
}

# The two transmissions of an antagonistic joint, agonist first.
PARTS = ("#009E73", "#CC79A7")
PART_BANDS = ("rgba(0, 158, 115, 0.2)", "rgba(204, 121, 167, 0.25)")

# A characteristic at a low, a middle and a high set-point.
SLICES = ("#56B4E9", "#0072B2", "#009E73")
SLICE_BANDS = ("rgba(86, 180, 233, 0.22)", "rgba(0, 114, 178, 0.22)", "rgba(0, 158, 115, 0.22)")

# Torque from its lowest to its highest over a surface, no torque pale.
SURFACE: list[tuple[float, str]] = [(0.0, "#7B6BB0"), (0.5, "#F3F4F6"), (1.0, "#4DA3C7")]

VERDICT_COLOURS: dict[str, str] = {
    "starved": "#9AA5B1",
    "converging": "#E69F00",
    "informative": "#009E73",
    "inconsistent": "#D55E00",
}
VERDICT_MEANINGS: dict[str, str] = {
    "starved": "the interval is wider than half of the stiffness, or rests on the prior: the joint "
    "was not deflected enough to tell. The number is not an answer.",
    "converging": "the interval is above 10 % of the stiffness, or has been below for less than "
    "1 s: let it run longer, or move more.",
    "informative": "the interval has been below 10 % for at least 1 s and nothing speaks against "
    "the model: the number can be used.",
    "inconsistent": "the residuals are not noise: the model or the data are wrong, whatever the "
    "interval says. Wins over the other three.",
}

# Steps for the verdict's number; four equal parts of a scale from 0 to 1.
VERDICT_SCALE: list[tuple[float, str]] = [
    (edge, VERDICT_COLOURS[name])
    for k, name in enumerate(VERDICTS)
    for edge in (k / len(VERDICTS), (k + 1) / len(VERDICTS))
]
