"""The spring's law: elastic torque over deflection, with the data it rests on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.report.palette import BAND, DATA, ESTIMATE, TRUTH
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range
from rotatum.report.view import View

__all__ = ["characteristic_panel", "law"]

Array = NDArray[np.float64]
_CLOUD = 4000  # points shown of the data
_BINS = 60  # over the deflection, for the band and the truth


def characteristic_panel(shown: View) -> Panel:
    """Return torque over deflection: the fitted law, its band, the truth, the data.

    Parameters
    ----------
    shown : the joint.
    """
    phi = np.where(shown.known, shown.field("deflection"), np.nan)
    traces: list[Trace] = []
    torque = np.empty(0)
    if np.isfinite(phi).any():
        grid = np.linspace(np.nanmin(phi), np.nanmax(phi), 200)
        torque = law(shown, phi) + shown.row("row_torque") - shown.row("row_fit")
        traces.append(_cloud(phi, torque))
        half = 1.96 * _deviation(shown, phi, grid)
        curve = law(shown, grid)
        traces += band("95 % interval", 1e3 * grid, curve - half, curve + half, BAND)
        traces.append(line("fitted law", 1e3 * grid, curve, ESTIMATE, width=2.5))
        traces += _truth(shown, phi, grid)
    limits = robust_range(torque, keep=0.998)
    return Panel(
        "characteristic",
        "Torque over deflection",
        "The slope of the fitted law is the stiffness. Every point is the law plus what is left "
        "over of one row: the cloud shows where the joint has been deflected, and how far the data "
        "are from the law. Outside the cloud nothing is known.",
        [Row(f"elastic torque, {shown.unit}", traces, {"range": limits} if limits else {}, 380)],
        {"title": {"text": "deflection q - theta, mrad"}},
    )


def law(shown: View, phi: Array) -> Array:
    """Return the elastic torque of the final coefficients at deflections [rad].

    Parameters
    ----------
    shown : the joint.
    phi : (N,) rad.
    """
    torque = np.zeros_like(phi)
    found = shown.estimate
    for column, coefficient in zip(found.columns, found.coefficients, strict=True):
        if column == "constant":
            torque += coefficient
        elif column.startswith("phi^"):
            torque += coefficient * phi ** int(column.removeprefix("phi^"))
    return torque


def _deviation(shown: View, phi: Array, grid: Array) -> Array:
    """Return the standard deviation of the law: with a single power it is proportional to it."""
    powers = [c for c in shown.estimate.columns if c == "constant" or c.startswith("phi^")]
    if powers == ["phi^1"]:
        return np.abs(grid) * shown.estimate.stiffness_std
    return np.interp(grid, *_by_deflection(phi, shown.field("torque_std")))


def _cloud(phi: Array, torque: Array) -> Trace:
    # Evenly over the deflection rather than over time, so that rare deflections are seen.
    there = np.flatnonzero(np.isfinite(phi) & np.isfinite(torque))
    if len(there) > _CLOUD:
        along = there[np.argsort(phi[there], kind="stable")]
        there = along[np.linspace(0, len(along) - 1, _CLOUD).astype(int)]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "data",
        "x": (1e3 * phi[there]).astype(np.float32),
        "y": torque[there].astype(np.float32),
        "marker": {"size": 4, "color": DATA, "opacity": 0.35},
        "hoverinfo": "skip",
    }


def _truth(shown: View, phi: Array, grid: Array) -> list[Trace]:
    torque = shown.truth("torque")
    if torque is not None:
        x, y = _by_deflection(phi, torque)
        return [line("truth", 1e3 * x, y, TRUTH, dash="dash")]
    spring = shown.joint.transmission
    if spring.law is None:
        return []
    told = spring.torque(grid)
    return [line("device file's law", 1e3 * grid, told, TRUTH, dash="dash")]


def _by_deflection(phi: Array, values: Array) -> tuple[Array, Array]:
    """Return the latest value in each bin of the deflection that was visited, and where it was."""
    good = np.flatnonzero(np.isfinite(phi) & np.isfinite(values))
    edges = np.linspace(phi[good].min(), phi[good].max(), _BINS + 1)
    place = np.clip(np.digitize(phi[good], edges) - 1, 0, _BINS - 1)
    latest = np.full(_BINS, -1)
    latest[place] = good  # later samples overwrite earlier ones
    chosen = latest[latest >= 0]
    chosen = chosen[np.argsort(phi[chosen], kind="stable")]
    return phi[chosen], values[chosen]
