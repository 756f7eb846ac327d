"""All methods' stiffness over time, each with its band, the truth dashed; how far each is off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import check_names
from rotatum.evaluation import ComparedMethod, Comparison
from rotatum.report.comparison_lines import unit_of
from rotatum.report.figure import figure_of
from rotatum.report.palette import METHODS, TRUTH
from rotatum.report.panel import Panel, Row, Trace, band, line, robust_range

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

__all__ = ["comparison_panel", "plot_comparison"]

Array = NDArray[np.float64]
_NOTE = (
    "Each method's stiffness at the deflection of the moment, with the interval that holds it in "
    "95 of 100 cases if its model is right; nothing where it would rest on the prior. Below, how "
    "far each is from {against}, each point the root mean square of a piece of the log. "
    "Click a name to hide it."
)
_PIECES = 150  # of the log, each a point of the lower plot


def plot_comparison(comparison: Comparison, joint: str | None = None) -> Figure:
    """Return an interactive figure of one joint.

    Parameters
    ----------
    comparison : to be drawn.
    joint : which; None: the first.

    Raises
    ------
    RotatumError if there is no such joint.
    """
    names = comparison.joints
    name = names[0] if joint is None else joint
    check_names([name], names, what="no such joint", where=comparison.source)
    figure = figure_of([comparison_panel(comparison, name)])
    figure.update_layout(template="plotly_white", showlegend=True)
    return figure


def comparison_panel(comparison: Comparison, joint: str) -> Panel:
    """Return the curves of one joint, one row per unit of its stiffness.

    Parameters
    ----------
    comparison : to be drawn.
    joint : which.
    """
    found = comparison.of(joint)
    units = {m.label: unit_of(comparison, m) for m in found}
    rows = [
        _row([m for m in found if units[m.label] == unit], unit)
        for unit in dict.fromkeys(units.values())
    ]
    against, off = _differences(comparison, found)
    if off.traces:
        rows.append(off)
    note = _NOTE.replace("{against}", against)
    return Panel("stiffness", f"Stiffness of {joint}", note, rows)


def _differences(comparison: Comparison, methods: Sequence[ComparedMethod]) -> tuple[str, Row]:
    """How far each method is from the truth, else from the reference, in per cent of it."""
    known = next((m.curve for m in methods if m.curve.truth is not None), None)
    label = comparison.references[methods[0].joint]
    if known is None:
        curve = next(m.curve for m in methods if m.label == label)
        held, against = curve.stiffness, label
    else:
        curve, against = known, "the truth"
        held = np.asarray(known.truth)
    traces = []
    for found in methods:
        every = max(found.curve.every, curve.every)
        own = found.curve.thinned(every)
        if known is None and found.label == label:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            off = 100.0 * (own.stiffness / held[:: every // curve.every] - 1.0)
        time, size = _pieces(own.time, off)
        dash = "solid" if found.side == "motor" else "dot"
        traces.append(line(found.label, time, size, METHODS[found.label], dash=dash))
    y = {"type": "log", "nticks": 6}
    return against, Row(f"rms difference from {against}, %", traces, y, 240)


def _pieces(time: Array, off: Array) -> tuple[Array, Array]:
    """Root mean square of each piece that is whole; a gap where one is not or nothing differs."""
    size = max(1, len(time) // _PIECES)
    pieces = len(time) // size
    whole = (off[: pieces * size] ** 2).reshape(pieces, size)
    found = np.sqrt(np.mean(whole, axis=1))
    middle = time[: pieces * size].reshape(pieces, size)[:, size // 2]
    return middle, np.where(found > 0.0, found, np.nan)


def _row(methods: list[ComparedMethod], unit: str) -> Row:
    traces: list[Trace] = []
    lines: list[Trace] = []
    told: list[Array] = []
    # One method that is far off would flatten the others: it is the lower plot that shows it.
    good = [m for m in methods if m.verdict == "informative"] or methods
    for found in methods:
        colour = METHODS[found.label]
        curve, half = found.curve, 1.96 * found.curve.std
        low, high = curve.stiffness - half, curve.stiffness + half
        for edge in band(found.label, curve.time, low, high, _pale(colour)):
            traces.append({**edge, "showlegend": False})
        dash = "solid" if found.side == "motor" else "dot"
        lines.append(line(found.label, curve.time, curve.stiffness, colour, dash=dash))
        if found in good:
            narrow = half < 0.1 * np.abs(curve.stiffness)
            told += [np.where(narrow, edge, np.nan) for edge in (low, high)]
    truth = next((m.curve.truth for m in methods if m.curve.truth is not None), None)
    if truth is not None and methods:
        time = methods[0].curve.time
        lines.append(line("truth", time, truth, TRUTH, width=1.2, dash="dash"))
        told.append(truth)
    limits = robust_range(*told, keep=0.99)
    return Row(f"stiffness, {unit}", traces + lines, {"range": limits} if limits else {}, 380)


def _pale(colour: str) -> str:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red}, {green}, {blue}, 0.13)"
