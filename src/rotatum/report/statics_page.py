"""The page of a characterisation: constants, c preset by preset, the fit over the data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.statics.result import Characterisation, JointCharacteristic
from rotatum.report.cloud import cloud
from rotatum.report.document import card, document, write_document
from rotatum.report.html import escape, table, tag, typeset
from rotatum.report.panel import Panel, Row, Trace, line, robust_range
from rotatum.report.statics_lines import (
    CONSTANTS,
    PRESETS,
    constant_rows,
    preset_rows,
    sentences,
)
from rotatum.report.words import number

__all__ = ["characterisation_page", "write_characterisation"]

Array = NDArray[np.float64]

_X = {"title": {"text": "deflection of the joint, mrad"}}
_COLOURS = (
    *("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#7B6BB0", "#8FB339"),
    *("#7A8794", "#B15928", "#117733", "#882255"),
)
_POINTS = 1500  # of a preset
_BINS = 120  # of the deflection, that a curve is drawn through


def write_characterisation(found: Characterisation, path: str | Path) -> Path:
    """Write the page.

    Parameters
    ----------
    found : what it tells about.
    path : of the HTML file.

    Returns
    -------
    The path.

    Raises
    ------
    OutputError if it cannot be written; no partial file is left.
    """
    return write_document(characterisation_page(found), path)


def characterisation_page(found: Characterisation) -> str:
    """Return the page's HTML, plotly.js included.

    Parameters
    ----------
    found : what it tells about.
    """
    cards = "".join(
        card(panel, f"joint{place}-{panel.key}")
        for place, joint in enumerate(found.joints.values())
        for panel in (_fit(joint), _residuals(joint))
    )
    main = tag("section", tag("div", cards, {"class": "cards"}))
    return document(f"{found.device.name}: {found.law}", _header(found) + tag("main", main))


def _header(found: Characterisation) -> str:
    facts = (
        f"Log {found.source}. Device {found.device.name} ({found.device.source}). Static "
        f"characterisation after trumic2022, section V-A: law {found.law}"
        + (", one set of constants for both transmissions." if found.tied else ".")
    )
    told = [f"{j.name}: {text}" for j in found.joints.values() for text in sentences(j)]
    rows = [[typeset(cell) for cell in row] for row in constant_rows(found)]
    content = (
        tag("h1", f"Elastic law of {escape(found.device.name)}")
        + tag("p", escape(facts), {"class": "note"})
        + table(CONSTANTS, rows, "results")
        + "".join(tag("p", escape(typeset(text)), {"class": "reason"}) for text in told)
        + table(PRESETS, preset_rows(found), "results")
    )
    if found.warnings:
        items = "".join(tag("li", escape(typeset(text))) for text in found.warnings)
        inner = tag("h2", "Warnings") + tag("ul", items)
        content += tag("div", inner, {"class": "warnings"})
    return tag("header", content)


def _fit(joint: JointCharacteristic) -> Panel:
    rows = []
    for place in range(len(joint.points.torque)):
        torque, fit = joint.points.torque[place], joint.points.fit[place]
        traces: list[Trace] = []
        for name, colour, own in _presets(joint):
            x = joint.points.deflection[own]
            traces.append(_points(name, x, torque[own], colour))
        for name, colour, own in _presets(joint):
            x, y = _curve(joint.points.deflection[own], fit[own])
            traces.append(line(name, 1e3 * x, y, colour, width=2.0))
        limits = robust_range(torque, keep=0.999)
        y_axis = {"range": limits} if limits else {}
        rows.append(Row(f"{_sensor(joint, place)}, N m", traces, y_axis, 380))
    note = (
        "Points: the sensor's torque without its fitted offset, a colour for each preset. Lines: "
        "the fitted law. The deflection is the link's position from the mean of its motors'."
    )
    return Panel("fit", f"Torque of {joint.name}", note, rows, _X)


def _residuals(joint: JointCharacteristic) -> Panel:
    rows = []
    for place in range(len(joint.points.torque)):
        off = joint.points.torque[place] - joint.points.fit[place]
        traces: list[Trace] = []
        for name, colour, own in _presets(joint):
            x = joint.points.deflection[own]
            traces.append(_points(name, x, off[own], colour))
            ends = np.array([x.min(), x.max()])
            traces.append(line(name, 1e3 * ends, np.zeros(2), colour, width=1.0))
        limits = robust_range(off, keep=0.999)
        title = f"{_sensor(joint, place)} less the law, N m"
        rows.append(Row(title, traces, {"range": limits} if limits else {}, 380))
    note = (
        "What the law leaves over. A cloud without shape is the sensor's noise; a curve that "
        "returns at each sweep is another law, a loop is friction, hysteresis or speed."
    )
    return Panel("residual", "Residuals", note, rows, _X)


def _points(name: str, x: Array, y: Array, colour: str) -> Trace:
    """A cloud that the legend shows and hides with the line of the same name."""
    shown = cloud(name, x, y, colour, _POINTS)
    return {**shown, "legendgroup": name, "showlegend": False}


def _presets(joint: JointCharacteristic) -> list[tuple[str, str, NDArray[np.bool_]]]:
    """Return name, colour and samples of each preset."""
    one = len(joint.presets) == 1
    return [
        (
            "data" if one else f"preset {number(preset.value)}",
            _COLOURS[k % len(_COLOURS)],
            joint.points.preset == k,
        )
        for k, preset in enumerate(joint.presets)
    ]


def _sensor(joint: JointCharacteristic, place: int) -> str:
    two = len(joint.points.torque) > 1
    return f"torque of transmission {place + 1}" if two else "torque"


def _curve(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean of a scattered curve over bins of its horizontal axis."""
    edges = np.linspace(x.min(), x.max(), _BINS + 1)
    place = np.clip(np.digitize(x, edges) - 1, 0, _BINS - 1)
    count = np.bincount(place, minlength=_BINS)
    there = count > 0
    means = [np.bincount(place, each, _BINS)[there] / count[there] for each in (x, y)]
    return means[0], means[1]
