"""The answer over time: stiffness with its interval, and the verdict below it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.kernels.status import VERDICTS
from rotatum.report.palette import BAND, ESTIMATE, PART_BANDS, PARTS, TRUTH, VERDICT_SCALE
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.part import parts
from rotatum.report.thin import thin_runs
from rotatum.report.view import View

__all__ = ["stiffness_panel", "verdict_row"]

Array = NDArray[np.float64]

_NOTE = (
    "Stiffness at the deflection of the moment, with the interval that holds it in 95 of 100 "
    "cases if the model is right. The strip below says from when on it can be used."
)
_PAIR_NOTE = (
    " The joint's stiffness is the sum of both transmissions'; its interval knows what their "
    "errors have in common."
)


def stiffness_panel(shown: View) -> Panel:
    """Return stiffness and verdict over time; of an antagonistic joint each transmission's too.

    Parameters
    ----------
    shown : the joint.
    """
    paired = len(shown.estimate.parts) > 1
    rows = [_total_row(shown), verdict_row(shown)]
    if paired:
        rows.append(_parts_row(shown))
    return Panel("stiffness", "Stiffness and verdict", _NOTE + _PAIR_NOTE * paired, rows)


def _total_row(shown: View) -> Row:
    time, sigma, half = shown.time, shown.learned("stiffness"), shown.half
    traces = band("95 % interval", time, sigma - half, sigma + half, BAND)
    traces.append(line("stiffness", time, sigma, ESTIMATE, width=2.0))
    told = _worth_seeing(sigma, half)
    truth = shown.truth("stiffness")
    if truth is not None:
        traces.append(line("truth", time, truth, TRUTH, dash="dash"))
        told.append(truth)
    y = _limits(told) or _limits([sigma - half, sigma + half], keep=0.5)
    what = "total stiffness" if len(shown.estimate.parts) > 1 else "stiffness"
    return Row(f"{what}, {shown.stiffness_unit}", traces, y, 300)


def _parts_row(shown: View) -> Row:
    traces: list[Trace] = []
    truths: list[Trace] = []
    told: list[Array] = []
    for part, colour, area in zip(parts(shown), PARTS, PART_BANDS, strict=True):
        sigma, half = part.learned("stiffness"), 1.96 * part.learned("stiffness_std")
        edges = band(part.name, shown.time, sigma - half, sigma + half, area)
        traces += [{**edge, "showlegend": False} for edge in edges]
        traces.append(line(part.name, shown.time, sigma, colour, width=1.2))
        told += _worth_seeing(sigma, half)
        truth = part.truth("stiffness")
        if truth is not None:
            truths.append(line("truth", shown.time, truth, TRUTH, width=1.2, dash="dash"))
            told.append(truth)
    y = _limits(told)
    return Row(f"of each transmission, {shown.stiffness_unit}", traces + truths, y, 200)


def _worth_seeing(sigma: Array, half: Array) -> list[Array]:
    """Return the interval where it is narrow: the first, wild ones would flatten the rest."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = 100.0 * half / np.abs(sigma)
    narrow = relative < 10.0
    if not narrow.any():
        narrow = relative < 50.0
    return [np.where(narrow, edge, np.nan) for edge in (sigma - half, sigma + half)]


def _limits(told: list[Array], keep: float = 0.999) -> dict[str, list[float]]:
    limits = robust_range(*told, keep=keep)
    return {"range": limits} if limits else {}


def verdict_row(shown: View) -> Row:
    """Return the verdict over time as a coloured strip.

    Parameters
    ----------
    shown : the joint.
    """
    strip: list[Trace] = []
    if len(shown.time):
        levels = np.asarray(shown.field("verdict"), np.int64)
        edges, runs = thin_runs(shown.time, levels)
        strip.append(
            {
                "type": "heatmap",
                "x": edges,
                "y": [0.0, 1.0],
                "z": [runs],
                "zmin": -0.5,
                "zmax": len(VERDICTS) - 0.5,
                "colorscale": [list(step) for step in VERDICT_SCALE],
                "showscale": False,
                "text": [[VERDICTS[int(k)] for k in runs]],
                "hovertemplate": "%{text} from %{x} s<extra></extra>",
            }
        )
    return Row("verdict", strip, {"visible": False, "fixedrange": True}, 26)
