"""Colours that stay apart for colour-blind eyes (Okabe and Ito), on light and dark ground."""

from __future__ import annotations

from rotatum.kernels.status import VERDICTS

__all__ = [
    "BAND",
    "DATA",
    "ESTIMATE",
    "MEASURED",
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
