"""The report's words: the answer, tables, settings, warnings, how to read it, references."""

from __future__ import annotations

from rotatum.evaluation import Estimate, JointEstimate
from rotatum.kernels.status import TABLE, VERDICTS
from rotatum.report.html import escape, table, tag, typeset
from rotatum.report.palette import VERDICT_COLOURS, VERDICT_MEANINGS
from rotatum.report.references import reference
from rotatum.report.results import FITTED, TITLES, answer, cells, fitted_lines, lines
from rotatum.report.view import View

__all__ = ["footer", "header", "joint_facts", "joint_head", "verdict_meanings"]


def header(estimate: Estimate) -> str:
    """Return the answer, the table of results and the warnings.

    Parameters
    ----------
    estimate : what it tells about.
    """
    told = "".join(
        tag("li", badge(found.verdict) + " " + escape(typeset(answer(estimate, found))))
        for found in estimate.joints.values()
    )
    device = estimate.device
    spent = max(found.ns_per_sample for found in estimate.joints.values())
    facts = (
        f"Log {estimate.source}: {estimate.samples:,} samples, {estimate.seconds:.4g} s at a "
        f"period of {estimate.period:.6g} s. Device {device.name} ({device.source}). "
        f"Method {estimate.method}, {estimate.side} side, torque {estimate.torque}; "
        f"{spent:.0f} ns of computing per sample."
    )
    content = (
        tag("h1", f"Joint stiffness of {escape(estimate.device.name)}")
        + tag("ul", told, {"class": "answers"})
        + tag("p", escape(facts), {"class": "note"})
        + _links(estimate)
        + _results(estimate)
        + _warnings(estimate)
    )
    return tag("header", content)


def badge(verdict: str) -> str:
    """Return a verdict on its colour.

    Parameters
    ----------
    verdict : one of the four words.
    """
    colour = VERDICT_COLOURS[verdict]
    return f'<span class="badge" style="background:{colour}">{escape(verdict)}</span>'


def joint_head(estimate: Estimate, shown: View) -> str:
    """Return a joint's heading: the reason of its verdict, what was fitted, how it was done.

    Parameters
    ----------
    estimate : of the device.
    shown : the joint.
    """
    found = shown.estimate
    settings = table(("setting", "value and why"), list(found.settings.items()), "settings")
    kept = ""
    if found.every > 1:
        said = f"The plots show every {found.every}th sample; the tables count all."
        kept = tag("p", said, {"class": "note"})
    return (
        tag("h2", f"{escape(found.name)} {badge(found.verdict)}")
        + tag("p", escape(typeset(found.reason)), {"class": "reason"})
        + kept
        + _fitted(estimate, found)
        + tag("details", tag("summary", "Settings used, and why") + settings)
    )


def joint_facts(shown: View, key: str) -> str:
    """Return what stands below a panel beside its note.

    Parameters
    ----------
    shown : the joint.
    key : of the panel.
    """
    if key == "stiffness":
        keys = "".join(
            f'<span><i style="background:{VERDICT_COLOURS[name]}"></i>{name}</span>'
            for name in VERDICTS
        )
        return tag("p", keys, {"class": "keys"})
    if key == "events":
        counted = shown.estimate.samples
        rows = [(b.name, f"{counted[b.name]:,}", b.sentence) for b in TABLE if counted[b.name]]
        return table(("status", "samples", "meaning"), rows, "events")
    return ""


def footer(estimate: Estimate) -> str:
    """Return how to read a verdict, and the papers to cite.

    Parameters
    ----------
    estimate : what they are about.
    """
    cited = [reference(key) for key in estimate.cites]
    papers = "".join(
        tag("li", escape(entry.text()) + tag("em", escape(f" ({entry.why})") if entry.why else ""))
        for entry in cited
    )
    content = (
        verdict_meanings()
        + tag("h2", "Papers behind the methods used")
        + tag("ul", papers, {"class": "papers"})
    )
    return tag("footer", content)


def verdict_meanings() -> str:
    """Return how to read a verdict."""
    meanings = "".join(
        tag("li", badge(name) + " " + escape(VERDICT_MEANINGS[name])) for name in VERDICTS
    )
    return (
        tag("h2", "How to read the verdict")
        + tag("ul", meanings, {"class": "answers"})
        + tag(
            "p",
            "The interval is 1.96 standard deviations to either side; it speaks of noise, "
            "resolution and coloured residuals, not of a wrong model: for that there is "
            "inconsistent.",
            {"class": "note"},
        )
    )


def _links(estimate: Estimate) -> str:
    if len(estimate.joints) < 2:
        return ""
    links = "".join(
        f'<a href="#joint{place}">{escape(name)}</a>' for place, name in enumerate(estimate.joints)
    )
    return tag("nav", links)


def _results(estimate: Estimate) -> str:
    titles = TITLES | {
        "mean": "mean",
        "lowest": "lowest",
        "highest": "highest",
        "mse": "mean square error",
        "msrep": "MSREP, %",
        "covered": "truth inside, %",
    }
    head, rows = cells(lines(estimate), titles)
    return table(head, [[typeset(cell) for cell in row] for row in rows], "results")


def _warnings(estimate: Estimate) -> str:
    if not estimate.warnings:
        return ""
    items = "".join(tag("li", escape(typeset(warning))) for warning in estimate.warnings)
    return tag("div", tag("h2", "Warnings") + tag("ul", items), {"class": "warnings"})


def _fitted(estimate: Estimate, found: JointEstimate) -> str:
    rows = [[typeset(cell) for cell in told] for told in fitted_lines(estimate, found)]
    if not rows:
        return ""
    head = ("fitted beside the stiffness", "value with 95 % interval")
    if len(found.parts) > 1:
        return table((FITTED[0], *head), rows, "fitted")
    return table(head, [row[1:] for row in rows], "fitted")
