"""What a plot is made of: rows of traces over one horizontal axis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.report.palette import BAND
from rotatum.report.thin import thin, thin_band

__all__ = ["TIME", "Panel", "Row", "Trace", "band", "level", "line", "robust_range"]

Array = NDArray[np.float64]
Trace = dict[str, Any]
"""A trace as plotly's JSON has it: building one needs no plotly."""

TIME: Mapping[str, Any] = {"title": {"text": "time, s"}}


class Row(NamedTuple):
    """One plot of a panel.

    Parameters
    ----------
    title : what the vertical axis shows, with its unit.
    traces : drawn in order.
    y : vertical axis, as plotly's layout has it.
    height : pixels.
    """

    title: str
    traces: list[Trace]
    y: Mapping[str, Any]
    height: int


class Panel(NamedTuple):
    """Plots that belong together.

    Parameters
    ----------
    key : a short name.
    title : its heading.
    note : how to read it.
    rows : from top to bottom.
    x : horizontal axis all rows share, as plotly's layout has it.
    """

    key: str
    title: str
    note: str
    rows: list[Row]
    x: Mapping[str, Any] = TIME


def line(
    name: str,
    x: Array,
    y: Array,
    colour: str,
    *,
    width: float = 1.5,
    dash: str = "solid",
    legend: bool = True,
) -> Trace:
    """Return a curve, thinned.

    Parameters
    ----------
    name : in the legend.
    x, y : (N,); NaN in y is a gap.
    colour, width, dash : of the line.
    legend : whether it is in the legend; a row with one curve has its title.
    """
    x, y = thin(x, y)
    style = {"color": colour, "width": width, "dash": dash}
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": x,
        "y": y.astype(np.float32),
        "line": style,
        "legendgroup": name,
        "showlegend": legend,
    }


def band(name: str, x: Array, low: Array, high: Array, colour: str = BAND) -> list[Trace]:
    """Return the two edges of a filled band, thinned.

    Parameters
    ----------
    name : in the legend.
    x, low, high : (N,); NaN is a gap.
    colour : of the area.
    """
    x, low, high = thin_band(x, low, high)
    keep = np.isfinite(low) & np.isfinite(high)
    edge = {
        "type": "scatter",
        "mode": "lines",
        "x": x[keep],
        "line": {"width": 0},
        "hoverinfo": "skip",
        "legendgroup": name,
    }
    lower = {**edge, "y": low[keep].astype(np.float32), "showlegend": False}
    upper = {**edge, "y": high[keep].astype(np.float32), "name": name}
    return [lower, {**upper, "fill": "tonexty", "fillcolor": colour}]


def level(name: str, x: Array, value: float, colour: str, dash: str = "dash") -> Trace:
    """Return a horizontal line over the whole width.

    Parameters
    ----------
    name : in the legend.
    x : (N,), N >= 1.
    value : where the line is.
    colour, dash : of the line.
    """
    ends = np.array([x[0], x[-1]])
    return line(name, ends, np.full(2, value), colour, width=1.2, dash=dash)


def robust_range(*curves: Array, keep: float = 0.98) -> list[float] | None:
    """Return a vertical range that shows the middle of the curves, None if there is nothing.

    Parameters
    ----------
    curves : (N,) each; NaN is left out.
    keep : share of each curve's values that is inside for sure.
    """
    edge = 50.0 * (1.0 - keep)
    lows: list[float] = []
    highs: list[float] = []
    for curve in curves:
        finite = curve[np.isfinite(curve)]
        if finite.size:
            low, high = np.percentile(finite, [edge, 100.0 - edge])
            lows.append(float(low))
            highs.append(float(high))
    if not lows:
        return None
    low, high = min(lows), max(highs)
    margin = 0.08 * (high - low) or 0.05 * abs(high) or 1.0
    return [low - margin, high + margin]
