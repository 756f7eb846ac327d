"""The spring's law: elastic torque over deflection, with the data it rests on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.report.cloud import by_deflection, cloud, deviation
from rotatum.report.palette import BAND, DATA, ESTIMATE, TRUTH
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.part import Part, law, parts
from rotatum.report.setpoints import moves
from rotatum.report.surface_panel import DEFLECTION, surface_panel
from rotatum.report.view import View

__all__ = ["characteristic_panel"]

Array = NDArray[np.float64]


def characteristic_panel(shown: View) -> Panel:
    """Return torque over deflection: the fitted law, its band, the truth, the data.

    One plot for each transmission; where the law hangs on a set-point that moved, a surface over
    deflection and set-point with slices of it.

    Parameters
    ----------
    shown : the joint.
    """
    if moves(shown):
        return surface_panel(shown)
    own = parts(shown)
    each = " of each transmission" if len(own) > 1 else ""
    offset = (
        " The fitted offset is not part of the law."
        if any("offset" in part.result.fitted for part in own)
        else ""
    )
    return Panel(
        "characteristic",
        f"Torque over deflection{each}",
        "The slope of the fitted law is the stiffness. Every point is the law plus what is left "
        "over of one row: the cloud shows where the joint has been deflected, and how far the data "
        f"are from the law. Outside the cloud nothing is known.{offset}",
        [_row(part, 380 if len(own) == 1 else 280) for part in own],
        DEFLECTION,
    )


def _row(part: Part, height: int) -> Row:
    phi = part.learned("deflection")
    setpoint = _usual_setpoint(part.shown)
    traces: list[Trace] = []
    torque = np.empty(0)
    if np.isfinite(phi).any():
        grid = np.linspace(np.nanmin(phi), np.nanmax(phi), 200)
        torque = law(part, phi, setpoint) + part.row("row_torque") - part.row("row_fit")
        traces.append(cloud("data", phi, torque, DATA))
        half = 1.96 * deviation(part, phi, grid)
        curve = law(part, grid, setpoint)
        traces += band("95 % interval", 1e3 * grid, curve - half, curve + half, BAND)
        traces.append(line("fitted law", 1e3 * grid, curve, ESTIMATE, width=2.5))
        traces += _truth(part, phi, grid, setpoint)
    limits = robust_range(torque, keep=0.998)
    what = f"{part.name}: elastic torque" if part.paired else "elastic torque"
    return Row(f"{what}, {part.shown.unit}", traces, {"range": limits} if limits else {}, height)


def _usual_setpoint(shown: View) -> float:
    """Return the set-point the joint stood at, in the middle of its values."""
    if shown.setpoint is None or not np.isfinite(shown.setpoint).any():
        return 0.0
    return float(np.nanmedian(shown.setpoint))


def _truth(part: Part, phi: Array, grid: Array, setpoint: float) -> list[Trace]:
    torque = part.truth("torque")
    if torque is not None:
        x, y = by_deflection(phi, torque)
        return [line("truth", 1e3 * x, y, TRUTH, dash="dash")]
    if part.spring.law is None or part.shown.unit != "N m":
        return []
    told = part.spring.torque(grid, setpoint)
    return [line("device file's law", 1e3 * grid, told, TRUTH, dash="dash")]
