"""The page of a comparison: the table, what could not run, the advice, the curves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rotatum.evaluation import Advice, Comparison
from rotatum.report.comparison_lines import (
    comparison_cells,
    comparison_notes,
    left_out_lines,
    outcome,
)
from rotatum.report.comparison_panel import comparison_panel
from rotatum.report.document import card, document, write_document
from rotatum.report.html import escape, table, tag, typeset
from rotatum.report.sections import verdict_meanings

__all__ = ["comparison_page", "write_comparison"]


def write_comparison(comparison: Comparison, path: str | Path) -> Path:
    """Write the page.

    Parameters
    ----------
    comparison : what it tells about.
    path : of the HTML file.

    Returns
    -------
    The path.

    Raises
    ------
    OutputError if it cannot be written; no partial file is left.
    """
    return write_document(comparison_page(comparison), path)


def comparison_page(comparison: Comparison) -> str:
    """Return the page's HTML, plotly.js included.

    Parameters
    ----------
    comparison : what it tells about.
    """
    cards = "".join(
        card(comparison_panel(comparison, name), f"joint{place}-stiffness")
        for place, name in enumerate(comparison.joints)
        if comparison.of(name)
    )
    main = tag("section", tag("div", cards, {"class": "cards"}))
    body = _header(comparison) + tag("main", main) + tag("footer", verdict_meanings())
    return document(f"{comparison.device.name}: methods compared", body)


def _header(comparison: Comparison) -> str:
    facts = (
        f"Log {comparison.source}: {comparison.samples:,} samples, {comparison.seconds:.4g} s at a "
        f"period of {comparison.period:.6g} s. Device {comparison.device.name} "
        f"({comparison.device.source}). {'; '.join(comparison_notes(comparison))}."
    )
    head, rows = comparison_cells(comparison)
    widths = [(found.joint, found.label, found.width) for found in comparison.methods]
    content = (
        tag("h1", f"Methods compared on {escape(comparison.device.name)}")
        + tag("p", escape(facts), {"class": "note"})
        + table(head, [[typeset(cell) for cell in row] for row in rows], "results")
        + _listed("Left out", left_out_lines(comparison))
        + tag("h2", "Recommended")
        + "".join(
            _advice(advice, outcome(comparison, advice))
            for advice in comparison.recommendation.joints.values()
        )
        + _reasons(comparison)
        + tag(
            "details",
            tag("summary", "What rows went through")
            + table(("joint", "method", "low-pass or window"), widths, "settings"),
        )
        + _warnings(comparison.warnings)
    )
    return tag("header", content)


def _advice(advice: Advice, ended: str) -> str:
    head = tag("strong", escape(f"{advice.joint}: ")) + tag(
        "code", escape(advice.options() or "no method")
    )
    sentences = filter(None, (*advice.reasons, *advice.cautions, ended))
    items = "".join(tag("li", escape(told)) for told in sentences)
    return tag("p", head) + tag("ul", items)


def _reasons(comparison: Comparison) -> str:
    """Why each verdict is what it is."""
    rows = [(found.joint, found.label, typeset(found.reason)) for found in comparison.methods]
    told = table(("joint", "method", "verdict and why"), rows, "settings")
    return tag("details", tag("summary", "Verdicts, and why") + told)


def _listed(title: str, sentences: Sequence[str]) -> str:
    if not sentences:
        return ""
    items = "".join(tag("li", escape(sentence)) for sentence in sentences)
    return tag("h2", escape(title)) + tag("ul", items)


def _warnings(warnings: Sequence[str]) -> str:
    if not warnings:
        return ""
    return tag("div", _listed("Warnings", [typeset(w) for w in warnings]), {"class": "warnings"})
