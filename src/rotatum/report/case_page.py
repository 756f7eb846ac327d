"""The page of a reproduced table or figure: its numbers beside the paper's, and what it draws."""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from rotatum.evaluation.papers.case import Case, Curve, Figure, Map, Outcome, Plot, Value
from rotatum.report.document import document, safe, write_document
from rotatum.report.figure import figure_of
from rotatum.report.html import escape, table, tag
from rotatum.report.palette import DATA, ESTIMATE, MEASURED, METHODS, THRESHOLD, TRUTH
from rotatum.report.panel import Panel, Row, Trace, line
from rotatum.report.words import number

__all__ = ["case_page", "cells", "columns", "write_case_page"]

_NUMBERS = {
    "paper": attrgetter("paper"),
    "ours, the paper's settings": attrgetter("own"),
    "ours, algebraic": attrgetter("algebraic"),
    "ours, rotatum": attrgetter("rotatum"),
    "ours, weak": attrgetter("weak"),
    "without observer": attrgetter("without"),
    "observer": attrgetter("observed"),
    "true state": attrgetter("true"),
}

# The same name has the same colour on every page; others take what is left, in their order.
_COLOURS = {
    "actual": TRUTH,
    "weak": ESTIMATE,
    "law": ESTIMATE,
    "RESIDUAL": "#009E73",
    "MKKF": "#009E73",
    "RLS on the residual": "#009E73",
    "Flacco et al.": "#009E73",
    "algebraic": METHODS["algebraic, motor side"],
    "rotatum": METHODS["rotatum, link side"],
    "as printed": MEASURED,
    "SENSOR": MEASURED,
    "sensor": MEASURED,
    "MODEL": THRESHOLD,
    "nominal": THRESHOLD,
    "residual": "#56B4E9",
    "data": DATA,
    "measured": DATA,
    "differencing": DATA,
    "observer": ESTIMATE,
    "full state, observed": ESTIMATE,
    "motors alone": MEASURED,
    "asked for": TRUTH,
}
_OTHERS = ("#0072B2", "#E69F00", "#CC79A7", "#56B4E9", "#D55E00", "#7A8794", "#009E73")
_DASHES = {"line": "solid", "dashed": "dash", "dotted": "solid"}
_WIDTHS = {"line": 1.6, "dashed": 1.6, "dotted": 0.7}


def write_case_page(paper: str, case: Case, outcome: Outcome, path: str | Path) -> Path:
    """Write the page.

    Parameters
    ----------
    paper : its title.
    case : what was run.
    outcome : what came of it.
    path : of the HTML file.

    Returns
    -------
    The path.

    Raises
    ------
    OutputError if it cannot be written; no partial file is left.
    """
    return write_document(case_page(paper, case, outcome), path)


def case_page(paper: str, case: Case, outcome: Outcome) -> str:
    """Return the page's HTML, which needs nothing else; plotly.js only where it draws.

    Parameters
    ----------
    paper : its title.
    case : what was run.
    outcome : what came of it.
    """
    told = tag("h1", escape(f"{case.name}: {case.title}")) + tag("p", escape(paper))
    told += tag("p", escape(case.prints))
    titles = columns(outcome.values)
    told += table(titles, [cells(value, titles) for value in outcome.values], "results")
    told += _listed("What came out", outcome.findings) + _listed("What was assumed", case.assumed)
    cards = "".join(_card(figure) for figure in outcome.figures)
    body = tag("header", told) + tag("main", tag("section", tag("div", cards, {"class": "cards"})))
    return document(f"{case.name}: {paper}", body, drawn=bool(outcome.figures))


def columns(values: Sequence[Value]) -> tuple[str, ...]:
    """Return the titles of a case's table: what a line is, its unit, its numbers.

    Parameters
    ----------
    values : its lines; what no line has a number of has no column.
    """
    found = [
        title
        for title, read in _NUMBERS.items()
        if any(read(value) is not None for value in values)
    ]
    return ("", "unit", *found)


def cells(value: Value, titles: Sequence[str]) -> list[str]:
    """Return a line of a case's table as texts.

    Parameters
    ----------
    value : the line.
    titles : from ``columns``.
    """
    numbers = (_NUMBERS[title](value) for title in titles[2:])
    return [value.label, value.unit, *(number(x, 4) if x is not None else "" for x in numbers)]


def _listed(title: str, sentences: Sequence[str]) -> str:
    if not sentences:
        return ""
    items = "".join(tag("li", escape(sentence)) for sentence in sentences)
    return tag("h2", escape(title)) + tag("ul", items)


def _card(figure: Figure) -> str:
    drawn = figure_of([_panel(figure)])
    place = f"plot-{figure.key}"
    height = {"class": "plot", "id": place, "style": f"height:{drawn.layout.height}px"}
    data = safe(drawn.to_json(remove_uids=True))
    content = (
        tag("h3", escape(figure.title))
        + tag("div", "", height)
        + f'<script type="application/json" data-plot="{escape(place)}">{data}</script>'
        + tag("p", escape(figure.note), {"class": "note"})
    )
    return tag("article", content, {"class": "card"})


def _panel(figure: Figure) -> Panel:
    colours = _colours(figure)
    rows = [_row(plot, colours) for plot in figure.plots]
    x: dict[str, Any] = {"title": {"text": figure.x}}
    if figure.logarithmic:
        x["type"] = "log"
    return Panel(figure.key, figure.title, figure.note, rows, x)


def _colours(figure: Figure) -> dict[str, str]:
    names = dict.fromkeys(curve.name for plot in figure.plots for curve in plot.curves)
    left = iter(_OTHERS * len(names))
    taken = {_COLOURS[name] for name in names if name in _COLOURS}
    free = (colour for colour in left if colour not in taken or len(names) > len(_OTHERS))
    return {name: _COLOURS.get(name) or next(free) for name in names}


def _row(plot: Plot, colours: dict[str, str]) -> Row:
    traces = [] if plot.map is None else [_heat(plot.map)]
    traces += [_trace(curve, colours[curve.name]) for curve in plot.curves]
    y: dict[str, Any] = {"nticks": 6}
    if plot.logarithmic:
        y["type"] = "log"
    if plot.limits is not None:
        low, high = plot.limits
        y["range"] = [np.log10(low), np.log10(high)] if plot.logarithmic else [low, high]
    return Row(plot.title, traces, y, 240 if plot.map is not None else 200)


def _trace(curve: Curve, colour: str) -> Trace:
    if curve.style == "points":
        return {
            "type": "scatter",
            "mode": "markers",
            "name": curve.name,
            "x": curve.x.astype(np.float32),
            "y": curve.y.astype(np.float32),
            "marker": {"symbol": "x-thin", "size": 4, "line": {"width": 1, "color": colour}},
            "legendgroup": curve.name,
        }
    dash, width = _DASHES[curve.style], _WIDTHS[curve.style]
    return line(curve.name, curve.x, curve.y, colour, width=width, dash=dash)


def _heat(shown: Map) -> Trace:
    return {
        "type": "heatmap",
        "x": shown.x.astype(np.float32),
        "y": shown.y.astype(np.float32),
        "z": shown.values.astype(np.float32),
        "colorscale": "RdBu",
        "zmid": 0.0,
        "showscale": False,
        "showlegend": False,
        "hovertemplate": f"%{{x}}, %{{y}}: {shown.name} %{{z}}<extra></extra>",
    }
