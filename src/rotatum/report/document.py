"""A whole page: what stands in its head, its cards with a plot each, the script that draws."""

from __future__ import annotations

from pathlib import Path

from rotatum.logs import beside
from rotatum.report.assets import SCRIPT, STYLE, templates
from rotatum.report.figure import figure_of
from rotatum.report.html import escape, tag
from rotatum.report.panel import Panel

__all__ = ["card", "document", "safe", "write_document"]


def document(title: str, body: str, *, drawn: bool = True) -> str:
    """Return a page that needs nothing else, plotly.js included where it draws.

    Parameters
    ----------
    title : of the page.
    body : its HTML.
    drawn : whether there is a plot in it.
    """
    head = (
        '<meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        '<link rel="icon" href="data:,">'
        f"<title>{escape(title)}</title><style>{STYLE}</style>"
    )
    script = _drawing() if drawn else ""
    whole = f'<html lang="en"><head>{head}</head><body>{body}{script}</body></html>'
    return f"<!DOCTYPE html>\n{whole}\n"


def write_document(text: str, path: str | Path) -> Path:
    """Write a page and return its path.

    Parameters
    ----------
    text : the page.
    path : of the HTML file.

    Raises
    ------
    OutputError if it cannot be written; no partial file is left.
    """
    with beside(path) as new:
        new.write_text(text, encoding="utf-8")
    return Path(path)


def _drawing() -> str:
    from plotly.offline import get_plotlyjs

    return (
        f"<script>{get_plotlyjs()}</script>"
        f'<script type="application/json" id="templates">{safe(templates())}</script>'
        f"<script>{SCRIPT}</script>"
    )


def card(panel: Panel, identity: str, facts: str = "", kind: str = "") -> str:
    """Return a heading, a plot and how to read it; the plot's numbers lie beside it as JSON.

    Parameters
    ----------
    panel : to be drawn.
    identity : of the plot in the page.
    facts : HTML below the note.
    kind : further class of the card.
    """
    figure = figure_of([panel])
    data = safe(figure.to_json(remove_uids=True))
    height = f"height:{figure.layout.height}px"
    content = (
        tag("h3", escape(panel.title))
        + tag("div", "", {"class": "plot", "id": identity, "style": height})
        + f'<script type="application/json" data-plot="{escape(identity)}">{data}</script>'
        + tag("p", escape(panel.note), {"class": "note"})
        + facts
    )
    return tag("article", content, {"class": f"card {panel.key} {kind}".strip()})


def safe(json: str) -> str:
    """Return JSON that cannot end the script element it stands in.

    Parameters
    ----------
    json : any.
    """
    return json.replace("<", "\\u003c")
