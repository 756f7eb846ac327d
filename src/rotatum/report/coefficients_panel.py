"""How the coefficients settled: each with its interval, over time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.columns import Power
from rotatum.report.palette import BAND, DATA, ESTIMATE, PART_BANDS, PARTS
from rotatum.report.panel import Panel, Row, Trace, band, level, line, robust_range
from rotatum.report.part import Part, parts
from rotatum.report.view import View

__all__ = ["coefficients_panel"]

Array = NDArray[np.float64]

_MEANINGS = {
    "inertia": ("motor inertia beyond the device file's", "s^2/rad"),
    "damping": ("motor damping beyond the device file's", "s/rad"),
    "coulomb": ("Coulomb friction beyond the device file's", ""),
    "skew": ("skew times stiffness", "s/rad"),
    "transmission_damping": ("transmission damping", "s/rad"),
    "offset": ("offset", ""),
}
_TALL, _LOW = 105, 88  # pixels of a row: few of them, many


def coefficients_panel(shown: View) -> Panel:
    """Return every coefficient over time, at the joint; both transmissions' in one plot.

    Parameters
    ----------
    shown : the joint.
    """
    own = parts(shown)
    fitted = list(own[0].result.fitted)
    titles = [_fitted_title(name, shown.unit) for name in fitted]
    titles += [_title(power, shown) for power in shown.estimate.powers]
    height = _TALL if len(titles) <= 6 else _LOW
    rows = [_row(own, place, title, height) for place, title in enumerate(titles)]
    note = (
        "The coefficients of the law and what is fitted beside it, at the joint, with their 95 % "
        "intervals. They should come to rest; one that wanders tells of a stiffness that changes, "
        "or of a model that cannot be right."
    )
    if len(shown.estimate.powers) > 2:
        note += (
            " A high order on its own may be unknown where the stiffness is well known: "
            "neighbouring orders stand in for each other."
        )
    if any(power.setpoint for power in shown.estimate.powers):
        note += " Here s is the set-point less the middle of its declared range."
    return Panel("coefficients", "Coefficients", note, rows)


def _row(own: list[Part], place: int, title: str, height: int) -> Row:
    traces: list[Trace] = []
    curves: list[Trace] = []
    edges: list[Array] = []
    if len(own) == 1:
        looks = [("coefficient", ESTIMATE, BAND, "95 % interval")]
    else:
        looks = [(p.name, c, b, p.name) for p, c, b in zip(own, PARTS, PART_BANDS, strict=True)]
    for part, (name, colour, area, interval) in zip(own, looks, strict=True):
        value, half = _over_time(part, place)
        found = band(interval, part.shown.time, value - half, value + half, area)
        traces += found if len(own) == 1 else [{**edge, "showlegend": False} for edge in found]
        curves.append(line(name, part.shown.time, value, colour))
        if len(part.shown.time):
            final = float(part.result.coefficients[place])
            curves.append(level("final", part.shown.time, final, DATA, dash="dot"))
        # Early intervals, often orders wider, would make the rest a flat line.
        early, late = slice(len(value) // 5, None), slice(len(value) // 2, None)
        edges += [value[early], (value - half)[late], (value + half)[late]]
    limits = robust_range(*edges)
    y = {"range": limits, "nticks": 5} if limits else {"nticks": 5}
    return Row(title, traces + curves, y, height)


def _over_time(part: Part, place: int) -> tuple[Array, Array]:
    """Return a coefficient and half its interval, NaN while it rests on the prior."""
    shown = part.shown
    column = part.place * len(part.result.coefficients) + place
    scale = shown.scales[column]
    value = shown.estimate.records["coefficients"][shown.order, column] / scale
    half = 1.96 * shown.estimate.records["coefficients_std"][shown.order, column] / scale
    known = part.known & (half > 0.0)
    return np.where(known, value, np.nan), np.where(known, half, np.nan)


def _fitted_title(name: str, unit: str) -> str:
    meaning, over = _MEANINGS.get(name, (name, ""))
    return f"{meaning}, {unit} {over}".rstrip()


def _title(power: Power, shown: View) -> str:
    """Say a coefficient's power and unit: coefficient of phi^3 s, N m/(rad^3 m)."""
    if not power.deflection and not power.setpoint:
        return f"torque at zero deflection, {shown.unit}"
    factors = [("phi", power.deflection), ("s", power.setpoint)]
    term = " ".join(_raised(name, exponent) for name, exponent in factors if exponent)
    units = [("rad", power.deflection), (shown.setpoint_unit, power.setpoint)]
    over = [_raised(name, exponent) for name, exponent in units if exponent]
    below = f"({' '.join(over)})" if len(over) > 1 else over[0]
    return f"coefficient of {term}, {shown.unit}/{below}"


def _raised(name: str, exponent: int) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"
