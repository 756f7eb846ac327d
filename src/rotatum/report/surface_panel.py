"""A serial joint's characteristic: torque over deflection and set-point, and slices of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.report.cloud import by_deflection, cloud, evenly
from rotatum.report.palette import (
    DATA,
    ESTIMATE,
    SLICE_BANDS,
    SLICES,
    SURFACE,
    TRUTH,
)
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.part import Part, law, parts
from rotatum.report.setpoints import Slice, setpoint_axis, slices
from rotatum.report.view import View

__all__ = ["DEFLECTION", "surface_panel"]

Array = NDArray[np.float64]

DEFLECTION: Mapping[str, Any] = {"title": {"text": "deflection q - theta, mrad"}}
_ACROSS, _UP = 61, 31  # points of the surface over deflection and set-point
_MARGIN = 0.065  # of the visited range
_LEVELS = 8  # steps of the torque between its lowest and its highest, at least
_POINTS = 1200  # of the data on the surface
_SLICE_POINTS = 600  # of the data of a slice


def surface_panel(shown: View) -> Panel:
    """Return the fitted law over deflection and set-point, and at a few set-points.

    As in flacco2012, figures 16 and 32, seen from above.

    Parameters
    ----------
    shown : a joint whose set-point moved.
    """
    part = parts(shown)[0]
    phi, s = _places(part)
    return Panel(
        "characteristic",
        "Torque over deflection and set-point",
        "Lines of equal elastic torque of the fitted law, and the path of the data across "
        "them, in the colour of their own torque: outside of it nothing is known. Below, slices "
        "at three set-points: their slope is the stiffness. Every point there is the law plus "
        "what is left over of one row nearby.",
        [_surface_row(part, phi, s), _slices_row(part, phi, s)],
        DEFLECTION,
    )


def _places(part: Part) -> tuple[Array, Array]:
    """Return deflection and set-point at each sample, NaN in both where they tell nothing."""
    setpoint = part.shown.setpoint
    assert setpoint is not None  # moves() was asked first
    phi = part.learned("deflection")
    known = np.isfinite(phi) & np.isfinite(setpoint)
    return np.where(known, phi, np.nan), np.where(known, setpoint, np.nan)


def _surface_row(part: Part, phi: Array, s: Array) -> Row:
    axis = setpoint_axis(part.shown)
    across, up = _spread(phi, _ACROSS), _spread(s, _UP)
    height = law(part, across, up[:, None])
    top = float(np.abs(height).max()) or 1.0
    step = _round(2.0 * top / _LEVELS)
    x, y = 1e3 * across, axis.factor * up
    traces = [_contours("fitted law", x, y, height, top, step)]
    if part.spring.law is not None and part.shown.unit == "N m":
        told = part.spring.torque(across, up[:, None])
        traces.append(_lines("device file's law", x, y, told, top, step))
    traces.append(_points(part, phi, s, top, axis.factor))
    title = f"{axis.title}; lines of equal torque, {part.shown.unit}"
    return Row(title, traces, {"range": [float(y[0]), float(y[-1])]}, 300)


def _spread(values: Array, points: int) -> Array:
    """Return points over the visited range and a little beyond, to the edges of the plot."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    margin = _MARGIN * (high - low)
    return np.linspace(low - margin, high + margin, points)


def _contours(name: str, x: Array, y: Array, z: Array, top: float, step: float) -> Trace:
    trace = _lines(name, x, y, z, top, step)
    levels = {**trace["contours"], "coloring": "heatmap", "showlabels": True}
    return {
        **trace,
        "contours": {**levels, "labelfont": {"size": 11, "color": "#1C2733"}},
        "line": {"width": 1.5, "color": ESTIMATE},
        "colorscale": [list(stop) for stop in SURFACE],
        "zmin": -top,
        "zmax": top,
        "hovertemplate": "%{z:.3g} at %{x:.3g} mrad, s = %{y:.4g}<extra></extra>",
    }


def _lines(name: str, x: Array, y: Array, z: Array, top: float, step: float) -> Trace:
    last = step * np.floor(top / step)
    return {
        "type": "contour",
        "name": name,
        "x": x.astype(np.float32),
        "y": y.astype(np.float32),
        "z": z.astype(np.float32),
        "contours": {"coloring": "none", "start": -last, "end": last, "size": step},
        "line": {"width": 1.5, "dash": "dash", "color": TRUTH},
        "showscale": False,
        "showlegend": True,
        "hoverinfo": "skip",
    }


def _points(part: Part, phi: Array, s: Array, top: float, factor: float) -> Trace:
    torque = law(part, phi, s) + part.row("row_torque") - part.row("row_fit")
    there = evenly(phi, np.isfinite(torque), _POINTS)
    return {
        **cloud("data", phi[there], factor * s[there], DATA),
        "marker": {
            "size": 5,
            "color": torque[there].astype(np.float32),
            "colorscale": [list(stop) for stop in SURFACE],
            "cmin": -top,
            "cmax": top,
            "line": {"width": 0.6, "color": DATA},
        },
    }


def _slices_row(part: Part, phi: Array, s: Array) -> Row:
    chosen = slices(part.shown, s)
    grid = _spread(phi, 100)
    traces: list[Trace] = []
    curves: list[Trace] = []
    truths: list[Trace] = []
    torques = []
    for cut, colour, area in zip(chosen, SLICES, SLICE_BANDS, strict=True):
        left = part.row("row_torque") - part.row("row_fit")
        torque = np.where(cut.near, law(part, phi, cut.setpoint) + left, np.nan)
        curve = law(part, grid, cut.setpoint)
        torques += [torque, curve]
        points = cloud(cut.name, phi, torque, colour, _SLICE_POINTS)
        traces.append({**points, "showlegend": False})
        traces += _interval(part, phi, cut, area)
        curves.append(line(cut.name, 1e3 * grid, curve, colour, width=2.0))
        if part.spring.law is not None and part.shown.unit == "N m":
            told = part.spring.torque(grid, cut.setpoint)
            name = "device file's law"
            truths.append(line(name, 1e3 * grid, told, TRUTH, width=1.2, dash="dash"))
    limits = robust_range(*torques, keep=0.998)
    y = {"range": limits} if limits else {}
    return Row(f"slices of it: elastic torque, {part.shown.unit}", traces + curves + truths, y, 250)


def _interval(part: Part, phi: Array, cut: Slice, area: str) -> list[Trace]:
    near = np.where(cut.near & part.shown.settled, phi, np.nan)
    if not np.isfinite(near).any():
        return []
    x, std = by_deflection(near, part.field("torque_std"))
    curve = law(part, x, cut.setpoint)
    edges = band("95 % interval", 1e3 * x, curve - 1.96 * std, curve + 1.96 * std, area)
    return [{**edge, "showlegend": False} for edge in edges]


def _round(step: float) -> float:
    """Return 1, 2 or 5 times a power of ten, the largest that is not above a step."""
    power = 10.0 ** np.floor(np.log10(step))
    return float(power * max(d for d in (1.0, 2.0, 5.0) if d == 1.0 or power * d <= step))
