"""How the coefficients settled: each with its interval, over time."""

from __future__ import annotations

import numpy as np

from rotatum.report.palette import DATA, ESTIMATE
from rotatum.report.panel import Panel, Row, band, level, line, robust_range
from rotatum.report.view import View

__all__ = ["coefficients_panel"]

_MEANINGS = {
    "inertia": ("motor inertia beyond the device file's", "s^2/rad"),
    "damping": ("motor damping beyond the device file's", "s/rad"),
    "coulomb": ("Coulomb friction beyond the device file's", ""),
    "skew": ("skew times stiffness", "s/rad"),
    "transmission_damping": ("transmission damping", "s/rad"),
    "offset": ("offset", ""),
    "constant": ("torque at zero deflection", ""),
}


def coefficients_panel(shown: View) -> Panel:
    """Return every coefficient over time, at the joint.

    Parameters
    ----------
    shown : the joint.
    """
    rows = [_row(shown, place) for place in range(len(shown.estimate.columns))]
    return Panel(
        "coefficients",
        "Coefficients",
        "The coefficients of the law and what is fitted beside it, at the joint, with their 95 % "
        "intervals. They should come to rest; one that wanders tells of a stiffness that changes, "
        "or of a model that cannot be right.",
        rows,
    )


def _row(shown: View, place: int) -> Row:
    found, records = shown.estimate, shown.estimate.records
    scale = shown.scales[place]
    value = records["coefficients"][shown.order, place] / scale
    half = 1.96 * records["coefficients_std"][shown.order, place] / scale
    known = shown.known & (half > 0.0)
    value, half = np.where(known, value, np.nan), np.where(known, half, np.nan)
    traces = band("95 % interval", shown.time, value - half, value + half)
    traces.append(line("coefficient", shown.time, value, ESTIMATE))
    if len(shown.time):
        final = float(found.coefficients[place])
        traces.append(level("final", shown.time, final, DATA, dash="dot"))
    settled = slice(len(value) // 5, None)
    limits = robust_range((value - half)[settled], (value + half)[settled])
    y = {"range": limits, "nticks": 5} if limits else {"nticks": 5}
    return Row(_title(found.columns[place], shown.unit), traces, y, 105)


def _title(column: str, unit: str) -> str:
    if column.startswith("phi^"):
        power = int(column.removeprefix("phi^"))
        over = "rad" if power == 1 else f"rad^{power}"
        return f"coefficient of {'phi' if power == 1 else column}, {unit}/{over}"
    meaning, over = _MEANINGS.get(column, (column, ""))
    return f"{meaning}, {unit} {over}".rstrip()
