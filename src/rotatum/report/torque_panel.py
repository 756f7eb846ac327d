"""The elastic torque over time: what was measured, what the rows say, what fits them."""

from __future__ import annotations

import numpy as np

from rotatum.report.palette import BAND, DATA, ESTIMATE, MEASURED, PARTS, TRUTH
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.part import parts
from rotatum.report.view import View

__all__ = ["torque_panel"]


def torque_panel(shown: View) -> Panel:
    """Return elastic torques over time and the residual of the fit.

    Parameters
    ----------
    shown : the joint.
    """
    time = shown.time
    y, fit = shown.row("row_torque"), shown.row("row_fit")
    traces = []
    if shown.measured_torque is not None:
        traces.append(line("measured", time, shown.measured_torque, MEASURED, width=1.0))
    truth = shown.truth("torque")
    if truth is not None:
        traces.append(line("truth", time, truth, TRUTH, width=1.0, dash="dot"))
    traces.append(line("row y", time, y, DATA, width=1.5))
    traces.append(line("fit of the row", time, fit, ESTIMATE, width=1.2))
    noise = 1.96 * shown.learned("noise")
    rest = [*band("1.96 times its noise", time, -noise, noise, BAND)]
    rest.append(line("y - fit", time, y - fit, DATA, width=1.0))
    limits = robust_range(y - fit, -noise, noise, keep=0.995)
    rows = [
        Row(f"elastic torque, {shown.unit}", traces, _range(y, fit), 260),
        Row(f"left over, {shown.unit}", rest, {"range": limits} if limits else {}, 110),
    ]
    if len(shown.estimate.parts) > 1:
        rows.insert(1, _parts_row(shown))
    return Panel(
        "torque",
        "Elastic torque",
        "The row's left side y is the elastic torque as the method makes it out of the samples, "
        "through its filter; the fit is what stiffness and fitted quantities say it is. "
        "What is left over should look like noise; a pattern in it is a model that is wrong.",
        rows,
    )


def _parts_row(shown: View) -> Row:
    traces: list[Trace] = []
    truths: list[Trace] = []
    curves = []
    for part, colour in zip(parts(shown), PARTS, strict=True):
        y = part.row("row_torque")
        curves += [y, part.row("row_fit")]
        traces.append(line(part.name, shown.time, y, colour, width=1.2))
        truth = part.truth("torque")
        if truth is not None:
            truths.append(line("truth", shown.time, truth, TRUTH, width=1.0, dash="dot"))
    return Row(f"row y of each, {shown.unit}", traces + truths, _range(*curves), 170)


def _range(*curves: np.ndarray) -> dict[str, list[float]]:
    limits = robust_range(*curves, keep=0.9999)
    return {"range": limits} if limits else {}
