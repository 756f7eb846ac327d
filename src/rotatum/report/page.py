"""The report: one HTML page that needs nothing else, neither files nor a network."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rotatum.evaluation import Estimate
from rotatum.report.document import card, document, write_document
from rotatum.report.figure import panels
from rotatum.report.html import tag
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
    return write_document(page(estimate), path)


def page(estimate: Estimate) -> str:
    """Return the report's HTML, plotly.js included.

    Parameters
    ----------
    estimate : what it tells about.
    """
    sections = "".join(
        _joint(estimate, number, name) for number, name in enumerate(estimate.joints)
    )
    body = f"{header(estimate)}<main>{sections}</main>{footer(estimate)}"
    return document(f"{estimate.device.name}: joint stiffness", body)


def _joint(estimate: Estimate, number: int, name: str) -> str:
    shown = view(estimate, name)
    drawn = panels(shown)
    tall = _tall(drawn)
    cards = "".join(
        card(
            panel,
            f"joint{number}-{panel.key}",
            joint_facts(shown, panel.key),
            "tall" if panel is tall else "",
        )
        for panel in drawn
    )
    inner = joint_head(estimate, shown) + tag("div", cards, {"class": "cards"})
    return tag("section", inner, {"id": f"joint{number}", "class": "joint"})


def _tall(drawn: Sequence[Panel]) -> Panel:
    """Return the higher one of excitation and coefficients: the status stands below the other."""
    pair = [panel for panel in drawn if panel.key in ("excitation", "coefficients")]
    return max(pair, key=lambda panel: sum(row.height for row in panel.rows))
