"""A comparison in words: the table's cells, the same in the terminal and in the page."""

from __future__ import annotations

import math

from rotatum.evaluation import Advice, ComparedMethod, Comparison
from rotatum.report.results import stiffness_text
from rotatum.report.words import number

__all__ = [
    "NUMBERS",
    "VERDICT",
    "comparison_cells",
    "comparison_notes",
    "left_out_lines",
    "outcome",
    "unit_of",
]

VERDICT = "verdict"
NUMBERS = (
    "MSREP %",
    "truth inside %",
    "differs by %",
    "within both %",
    "converged s",
    "late ms",
    "ns a sample",
)
"""Titles of columns that stand to the right."""


def comparison_cells(comparison: Comparison) -> tuple[list[str], list[list[str]]]:
    """Return titles and rows of the table, a row per joint and method.

    Columns with nothing in any row are left out; the difference from the reference is shown where
    no truth is known.

    Parameters
    ----------
    comparison : to be told.
    """
    units = {unit_of(comparison, found) for found in comparison.methods}
    shared = units.pop() if len(units) == 1 else ""
    rows = [_row(comparison, found, shared) for found in comparison.methods]
    if any(row["MSREP %"] for row in rows):
        for row in rows:
            row["differs by %"] = row["within both %"] = ""
    used = [title for title in rows[0] if any(row[title] for row in rows)] if rows else []
    if len(comparison.joints) == 1 and "joint" in used:
        used.remove("joint")
    return used, [[row[title] for title in used] for row in rows]


def unit_of(comparison: Comparison, found: ComparedMethod) -> str:
    """Return the unit of a method's stiffness.

    Parameters
    ----------
    comparison : of the device.
    found : one of its methods.
    """
    joint = next(j for j in comparison.device.joints if j.name == found.joint)
    return f"{joint.torque_unit(found.torque)}/rad"


def _row(comparison: Comparison, found: ComparedMethod, shared: str) -> dict[str, str]:
    truth, other = found.truth or {}, found.disagreement or {}
    head = f"stiffness, {shared}" if shared else "stiffness"
    unit = "" if shared else unit_of(comparison, found)
    reference = found.label == comparison.references[found.joint]
    return {
        "joint": found.joint,
        "method": found.name,
        "side": found.side,
        head: stiffness_text(found.stiffness, found.stiffness_std, unit),
        VERDICT: found.verdict,
        "MSREP %": _cell(truth.get("msrep_percent")),
        "truth inside %": _cell(truth.get("coverage_percent")),
        "differs by %": "reference" if reference else _cell(other.get("rms_percent")),
        "within both %": _cell(other.get("within_percent")),
        "converged s": "-" if found.converged_at is None else f"{found.converged_at:.2f}",
        "late ms": number(1e3 * found.delay, 3),
        "ns a sample": number(found.ns_per_sample, 3),
    }


def _cell(value: float | None) -> str:
    return "" if value is None or not math.isfinite(value) else number(value, 3)


def comparison_notes(comparison: Comparison) -> list[str]:
    """Return how to read the table: what is scored, against what.

    Parameters
    ----------
    comparison : to be told.
    """
    told = []
    for name in comparison.joints:
        start = f"{name}: scored from {number(comparison.score_from[name], 3)} s on"
        if any(found.truth for found in comparison.of(name)):
            told.append(f"{start}, against the log's truth")
        elif comparison.references[name]:
            told.append(f"{start}, against {comparison.references[name]}")
    return told


def left_out_lines(comparison: Comparison) -> list[str]:
    """Return what could not run and why; joints that lack the same are told at once.

    Parameters
    ----------
    comparison : to be told.
    """
    shared: dict[tuple[str, str, str], list[str]] = {}
    for out in comparison.left_out:
        shared.setdefault((out.name, out.side, out.why), []).append(out.joint)
    several = len(comparison.joints) > 1
    found = []
    for (name, side, why), joints in shared.items():
        whose = f" ({', '.join(joints)})" if several else ""
        found.append(f"{name}, {side} side{whose}: {why.rstrip('.')}.")
    return found


def outcome(comparison: Comparison, advice: Advice) -> str:
    """Say how the recommended method ended here; the advice itself is given before anything ran.

    What the comparison ran may fit other columns than the advice.

    Parameters
    ----------
    comparison : to be told.
    advice : on one of its joints; "" where it recommends nothing that ran.
    """
    found = comparison.of(advice.joint)
    asked = (advice.method, advice.side, advice.torque, advice.window is not None)
    own = next((m for m in found if (m.method, m.side, m.torque, m.windowed) == asked), None)
    if own is None:
        return ""
    if own.verdict == "informative":
        return f"It ended informative here: {own.label}."
    good = [m.label for m in found if m.verdict == "informative"]
    others = f"informative: {'; '.join(good)}" if good else "none of the others informative"
    return f"It ended {own.verdict} here ({own.label}), {others}."
