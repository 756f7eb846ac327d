"""The report: one HTML page that needs nothing else, neither files nor a network."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rotatum.evaluation import Estimate
from rotatum.logs import beside
from rotatum.report.assets import SCRIPT, STYLE, templates
from rotatum.report.figure import figure_of, panels
from rotatum.report.html import escape, tag
from rotatum.report.panel import Panel
from rotatum.report.sections import footer, header, joint_facts, joint_head
from rotatum.report.view import view

__all__ = ["page", "write_report"]


def write_report(estimate: Estimate, path: str | Path) -> Path:
    """Write the report.

    Parameters
    ----------
    estimate : what it tells about.
    path : of the HTML file.

    Returns
    -------
    The path.

    Raises
    ------
    OutputError if it cannot be written; no partial file is left.
    """
    text = page(estimate)
    with beside(path) as new:
        new.write_text(text, encoding="utf-8")
    return Path(path)


def page(estimate: Estimate) -> str:
    """Return the report's HTML, plotly.js included.

    Parameters
    ----------
    estimate : what it tells about.
    """
    from plotly.offline import get_plotlyjs

    title = f"{estimate.device.name}: joint stiffness"
    head = (
        '<meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        '<link rel="icon" href="data:,">'
        f"<title>{escape(title)}</title><style>{STYLE}</style>"
    )
    sections = "".join(
        _joint(estimate, number, name) for number, name in enumerate(estimate.joints)
    )
    body = (
        f"{header(estimate)}<main>{sections}</main>{footer(estimate)}"
        f"<script>{get_plotlyjs()}</script>"
        f'<script type="application/json" id="templates">{_safe(templates())}</script>'
        f"<script>{SCRIPT}</script>"
    )
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{body}</body></html>\n'


def _joint(estimate: Estimate, number: int, name: str) -> str:
    shown = view(estimate, name)
    drawn = panels(shown)
    tall = _tall(drawn)
    cards = "".join(
        _card(panel, f"joint{number}-{panel.key}", joint_facts(shown, panel.key), panel is tall)
        for panel in drawn
    )
    inner = joint_head(estimate, shown) + tag("div", cards, {"class": "cards"})
    return tag("section", inner, {"id": f"joint{number}", "class": "joint"})


def _tall(drawn: Sequence[Panel]) -> Panel:
    """Return the higher one of excitation and coefficients: the status stands below the other."""
    pair = [panel for panel in drawn if panel.key in ("excitation", "coefficients")]
    return max(pair, key=lambda panel: sum(row.height for row in panel.rows))


def _card(panel: Panel, identity: str, facts: str, tall: bool) -> str:
    """A heading, a plot and how to read it; the plot's numbers lie beside it as JSON."""
    figure = figure_of([panel])
    data = _safe(figure.to_json(remove_uids=True))
    plot = tag(
        "div", "", {"class": "plot", "id": identity, "style": f"height:{figure.layout.height}px"}
    )
    content = (
        tag("h3", escape(panel.title))
        + plot
        + f'<script type="application/json" data-plot="{identity}">{data}</script>'
        + tag("p", escape(panel.note), {"class": "note"})
        + facts
    )
    return tag("article", content, {"class": f"card {panel.key}{' tall' * tall}"})


def _safe(json: str) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.replace("<", "\\u003c")
