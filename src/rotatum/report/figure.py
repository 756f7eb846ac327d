"""From panels to plotly figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rotatum.errors import RotatumError, nearest
from rotatum.evaluation import Estimate
from rotatum.report.characteristic_panel import characteristic_panel
from rotatum.report.coefficients_panel import coefficients_panel
from rotatum.report.events_panel import events_panel
from rotatum.report.excitation_panel import excitation_panel, interval_row
from rotatum.report.panel import Panel, Trace
from rotatum.report.stiffness_panel import stiffness_panel
from rotatum.report.torque_panel import torque_panel
from rotatum.report.view import View, view

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

__all__ = ["figure_of", "panels", "plot"]

_GAP, _BOTTOM = 34, 46  # pixels between rows and below them
_TITLE, _LEGEND = 24, 24  # pixels above the first row
_HEAD = 72  # pixels more for a figure with a title of its own


def plot(estimate: Estimate, joint: str | None = None) -> Figure:
    """Return an interactive figure: stiffness, verdict, interval, torque, characteristic.

    Parameters
    ----------
    estimate : to be drawn.
    joint : which joint; None: the first.

    Raises
    ------
    RotatumError if there is no such joint.
    """
    names = tuple(estimate.joints)
    name = names[0] if joint is None else joint
    if name not in names:
        close = nearest(name, names)
        hint = f'Did you mean "{close}"?' if close else None
        raise RotatumError("no such joint", value=name, allowed=names, hint=hint)
    shown = view(estimate, name)
    answer = stiffness_panel(shown)
    answer = answer._replace(rows=[*answer.rows, interval_row(shown)])
    figure = figure_of([answer, torque_panel(shown), characteristic_panel(shown)])
    layout = figure.layout
    figure.update_layout(
        title={
            "text": f"{_plain(name)}: {shown.estimate.verdict}",
            "y": 1.0,
            "yref": "container",
            "yanchor": "top",
            "pad": {"t": 8},
        },
        # All traces share one legend here, which takes up to three lines below the title.
        margin_t=layout.margin.t + _HEAD,
        height=layout.height + _HEAD,
        template="plotly_white",
    )
    return figure


def panels(shown: View) -> list[Panel]:
    """Return every panel of the report, in its order.

    Parameters
    ----------
    shown : the joint.
    """
    return [
        stiffness_panel(shown),
        torque_panel(shown),
        characteristic_panel(shown),
        excitation_panel(shown),
        coefficients_panel(shown),
        events_panel(shown),
    ]


def figure_of(shown: Sequence[Panel]) -> Figure:
    """Return one figure with the rows of all panels below each other.

    Parameters
    ----------
    shown : panels; those over the same horizontal axis are zoomed together.
    """
    from plotly.graph_objects import Figure

    layout = _layout(shown)
    traces: list[Trace] = []
    named: set[str] = set()
    number = 0
    for panel in shown:
        for row in panel.rows:
            number += 1
            for trace in row.traces:
                traces.append(_placed(trace, number, named))
    return Figure({"data": traces, "layout": layout})


def _placed(trace: Trace, number: int, named: set[str]) -> Trace:
    """Put a trace into its row; a name is told once in the legend."""
    placed = {**trace, "xaxis": f"x{number}", "yaxis": f"y{number}"}
    if "name" in trace and trace.get("showlegend", True):
        placed["showlegend"] = trace["name"] not in named
        named.add(trace["name"])
    return placed


def _layout(shown: Sequence[Panel]) -> dict[str, Any]:
    count = sum(len(panel.rows) for panel in shown)
    extra = (_BOTTOM - 10) * (len(shown) - 1)
    named = any(
        "name" in t and t.get("showlegend", True) for p in shown for r in p.rows for t in r.traces
    )
    top_margin = _TITLE + (_LEGEND if named else 0)
    inner = sum(row.height for panel in shown for row in panel.rows) + _GAP * (count - 1) + extra
    layout: dict[str, Any] = {
        "height": inner + top_margin + _BOTTOM,
        "margin": {"l": 56, "r": 12, "t": top_margin, "b": _BOTTOM, "pad": 0},
        "legend": {
            "orientation": "h",
            "x": 0,
            "y": 1 + 22 / inner,
            "yanchor": "bottom",
        },
        "hovermode": "closest",
        "annotations": [],
    }
    top, number = float(inner), 0
    leaders: dict[str, str] = {}  # title of a horizontal axis -> the first axis that has it
    for panel in shown:
        for row in panel.rows:
            number += 1
            bottom = top - row.height
            last = row is panel.rows[-1]
            # Rows above the last have no labels, but the same scale.
            shared = panel.x if last else {k: v for k, v in panel.x.items() if k == "type"}
            x = {**shared, "anchor": f"y{number}", "showticklabels": last}
            leader = leaders.setdefault(panel.x["title"]["text"], f"x{number}")
            if leader != f"x{number}":
                x["matches"] = leader
            layout[f"xaxis{number}"] = {**x, "zeroline": False}
            domain = [max(0.0, bottom / inner), min(1.0, top / inner)]
            y = {"anchor": f"x{number}", "domain": domain, "zeroline": False, **row.y}
            layout[f"yaxis{number}"] = y
            layout["annotations"].append(_row_title(row.title, top / inner))
            top = bottom - _GAP
        top -= _BOTTOM - 10
    return layout


def _row_title(text: str, y: float) -> dict[str, Any]:
    place = {"x": 0, "xref": "paper", "xanchor": "left", "y": y, "yref": "paper"}
    style = {"yanchor": "bottom", "showarrow": False, "font": {"size": 12}}
    return {"text": _raised(text), **place, **style}


def _raised(text: str) -> str:
    """Write powers as plotly does: rad^3 with a raised 3."""
    words = []
    for word in text.split(" "):
        base, mark, power = word.partition("^")
        digits = len(power) - len(power.lstrip("0123456789"))
        raised = f"{base}<sup>{power[:digits]}</sup>{power[digits:]}"
        words.append(raised if mark and digits else word)
    return " ".join(words)


def _plain(text: str) -> str:
    """Escape what plotly would take for markup."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
