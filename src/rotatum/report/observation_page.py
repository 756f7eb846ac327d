"""The page of an observation: per joint deflection, link velocity, errors and status in time."""

from __future__ import annotations

from pathlib import Path

from rotatum.evaluation.observation import JointObservation, Observation
from rotatum.kernels.status import TABLE
from rotatum.report.document import card, document, write_document
from rotatum.report.html import escape, table, tag, typeset
from rotatum.report.observation_lines import (
    observation_rows,
    observation_sentences,
    observation_settings,
    titles,
)
from rotatum.report.observation_panels import observation_panels
from rotatum.report.references import reference

__all__ = ["observation_page", "write_observation"]

_CITED = "deluca2007"


def write_observation(found: Observation, path: str | Path) -> Path:
    """Write the page and return its path.

    Args:
        found: what it tells about.
        path: of the HTML file.

    Raises:
        OutputError: it cannot be written; no partial file is left.
    """
    return write_document(observation_page(found), path)


def observation_page(found: Observation) -> str:
    """Return the page's HTML, plotly.js included.

    Args:
        found: what it tells about.
    """
    sections = "".join(
        _joint(joint, place, found.score_from) for place, joint in enumerate(found.joints.values())
    )
    cited = reference(_CITED)
    footer = tag("h2", "To cite") + tag("p", escape(cited.text()))
    body = _header(found) + tag("main", sections) + tag("footer", footer)
    return document(f"{found.device.name}: full state", body)


def _header(found: Observation) -> str:
    facts = (
        f"Log {found.source}: {found.samples:,} samples, {found.seconds:.4g} s at a period of "
        f"{found.period:.6g} s. Device {found.device.name} ({found.device.source}). State observer "
        "from motor positions, torques and accelerations (deluca2007)."
    )
    told = [*observation_sentences(found), *observation_settings(found)]
    links = "".join(
        tag("a", escape(name), {"href": f"#joint{place}"})
        for place, name in enumerate(found.joints)
    )
    content = (
        tag("h1", f"Full state of {escape(found.device.name)}")
        + tag("p", escape(facts), {"class": "note"})
        + (tag("nav", links) if len(found.joints) > 1 else "")
        + table(titles(found), observation_rows(found), "results")
        + "".join(tag("p", escape(text), {"class": "note"}) for text in told)
    )
    if found.warnings:
        items = "".join(tag("li", escape(typeset(text))) for text in found.warnings)
        inner = tag("h2", "Warnings") + tag("ul", items)
        content += tag("div", inner, {"class": "warnings"})
    return tag("header", content)


def _joint(joint: JointObservation, place: int, begin: float) -> str:
    cards = "".join(
        card(panel, f"joint{place}-{panel.key}", _bits(joint) if panel.key == "events" else "")
        for panel in observation_panels(joint, begin)
    )
    inner = tag("h2", escape(joint.name)) + tag("div", cards, {"class": "cards"})
    return tag("section", inner, {"id": f"joint{place}", "class": "joint"})


def _bits(joint: JointObservation) -> str:
    """Table of the status bits that were set."""
    rows = [
        (bit.name, f"{joint.status[bit.name]:,}", typeset(bit.sentence))
        for bit in TABLE
        if joint.status[bit.name]
    ]
    return table(("status bit", "samples", "meaning"), rows, "events") if rows else ""
