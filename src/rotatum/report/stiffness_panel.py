"""The answer over time: stiffness with its interval, and the verdict below it."""

from __future__ import annotations

import numpy as np

from rotatum.kernels.status import VERDICTS
from rotatum.report.palette import ESTIMATE, TRUTH, VERDICT_SCALE
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.thin import thin_runs
from rotatum.report.view import View

__all__ = ["stiffness_panel", "verdict_row"]


def stiffness_panel(shown: View) -> Panel:
    """Return stiffness and verdict over time.

    Parameters
    ----------
    shown : the joint.
    """
    time, sigma, half = shown.time, shown.learned("stiffness"), shown.half
    traces = band("95 % interval", time, sigma - half, sigma + half)
    traces.append(line("stiffness", time, sigma, ESTIMATE, width=2.0))
    # The first, wild estimates would make the rest a flat line.
    narrow = shown.relative < 10.0
    if not narrow.any():
        narrow = shown.relative < 50.0
    told = [np.where(narrow, edge, np.nan) for edge in (sigma - half, sigma + half)]
    truth = shown.truth("stiffness")
    if truth is not None:
        traces.append(line("truth", time, truth, TRUTH, dash="dash"))
        told.append(truth)
    limits = robust_range(*told, keep=0.999) or robust_range(sigma - half, sigma + half, keep=0.5)
    y = {"range": limits} if limits else {}
    return Panel(
        "stiffness",
        "Stiffness and verdict",
        "Stiffness at the deflection of the moment, with the interval that holds it in 95 of 100 "
        "cases if the model is right. The strip below says from when on it can be used.",
        [Row(f"stiffness, {shown.stiffness_unit}", traces, y, 300), verdict_row(shown)],
    )


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
