"""Rounded numbers and units, the same in the terminal and in the report."""

from __future__ import annotations

import math

__all__ = ["fitted_unit", "measure", "number"]

# Units of fitted quantities in the device file's own side; {} is the unit of torque.
_FITTED_UNITS = {
    "inertia": "kg m^2",
    "damping": "{} s/rad",
    "coulomb": "{}",
    "offset": "{}",
    "skew": "s",
    "transmission_damping": "{} s/rad",
}


def fitted_unit(name: str, unit: str) -> str:
    """Return the unit of a fitted quantity.

    Parameters
    ----------
    name : of the quantity.
    unit : of torques.
    """
    if name == "inertia" and unit != "N m":
        return f"{unit} s^2/rad"
    return _FITTED_UNITS.get(name, "").format(unit)


def measure(value: float, std: float, unit: str = "") -> str:
    """Write a value with half its 95 % interval, both to the digits the interval has.

    Parameters
    ----------
    value, std : in the same unit.
    unit : written behind.

    >>> measure(545.145, 0.579, "A/rad")
    '545.1 +- 1.1 A/rad'
    """
    half = 1.96 * std
    tail = f" {unit}" if unit else ""
    if not (math.isfinite(value) and math.isfinite(half) and half > 0.0):
        return f"{number(value)}{tail}"
    last = math.floor(math.log10(half)) - 1
    top = math.floor(math.log10(abs(value))) if value else last
    if -6 <= last <= 0 and top < 6:
        return f"{value:.{-last}f} +- {half:.{-last}f}{tail}"
    power = max(top, last)
    if last > 0 and power < 6:
        return f"{round(value, -last):.0f} +- {round(half, -last):.0f}{tail}"
    digits = max(0, power - last)
    scale = 10.0**power
    return f"({value / scale:.{digits}f} +- {half / scale:.{digits}f})e{power}{tail}"


def number(value: float | None, digits: int = 4) -> str:
    """Write a number to so many digits, a dash for none.

    Parameters
    ----------
    value : to write.
    digits : that count.
    """
    if value is None or not math.isfinite(value):
        return "-"
    short = f"{value:.{digits}g}"
    return f"{float(short):.0f}" if "e+0" in short and abs(value) < 1e6 else short
