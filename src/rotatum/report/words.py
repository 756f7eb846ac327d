"""Results in words and rounded numbers, the same in the terminal and in the report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from rotatum.evaluation import Estimate, JointEstimate
from rotatum.models import Joint

__all__ = ["Line", "answer", "fitted_unit", "lines", "measure", "number"]

# Units of fitted quantities in the device file's own side; {} is the unit of torque.
_FITTED_UNITS = {
    "inertia": "kg m^2",
    "damping": "{} s/rad",
    "coulomb": "{}",
    "offset": "{}",
    "skew": "s",
    "transmission_damping": "{} s/rad",
}


class Line(NamedTuple):
    """One joint in the table of results, every cell a text.

    Parameters
    ----------
    joint : its name.
    stiffness : final value with half its 95 % interval and unit.
    relative : half the interval over the stiffness, per cent.
    verdict : at the last sample.
    since : when it was informative for the first time.
    torque : rms of the elastic torque with unit.
    """

    joint: str
    stiffness: str
    relative: str
    verdict: str
    since: str
    torque: str


def lines(estimate: Estimate) -> list[Line]:
    """Return the table of results.

    Parameters
    ----------
    estimate : of the device.
    """
    return [_line(found, *_units(estimate, found)) for found in estimate.joints.values()]


def answer(estimate: Estimate, found: JointEstimate) -> str:
    """Say a joint's result in a sentence.

    Parameters
    ----------
    estimate : of the device.
    found : one of its joints.
    """
    told = _line(found, *_units(estimate, found))
    if found.verdict == "informative":
        since = f", first informative at {told.since}" if found.converged_at is not None else ""
        return f"{told.joint}: the stiffness is {told.stiffness} ({told.relative}){since}."
    if found.verdict == "converging":
        return (
            f"{told.joint}: the stiffness seems to be {told.stiffness} ({told.relative}), "
            "which is not yet narrow enough to rely on."
        )
    if found.verdict == "inconsistent":
        return f"{told.joint}: no answer: data and model contradict each other."
    return f"{told.joint}: no answer: the log does not tell the stiffness."


def fitted_unit(name: str, estimate: Estimate, joint: Joint) -> str:
    """Return the unit of a fitted quantity.

    Parameters
    ----------
    name : of the quantity.
    estimate : it is of.
    joint : as the device describes it.
    """
    unit = joint.torque_unit(estimate.torque)
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


def _line(found: JointEstimate, unit: str, stiffness_unit: str) -> Line:
    final, std = found.stiffness["final"], found.stiffness_std
    learned = math.isfinite(final) and std > 0.0
    relative = 196.0 * std / abs(final) if learned and final else math.inf
    return Line(
        joint=found.name,
        stiffness=measure(final, std, stiffness_unit) if learned else "-",
        relative=f"{number(relative, 2 if relative < 100.0 else 3)} %" if learned else "-",
        verdict=found.verdict,
        since="-" if found.converged_at is None else f"{found.converged_at:.2f} s",
        torque=f"{number(found.torque_rms, 3)} {unit}",
    )


def _units(estimate: Estimate, found: JointEstimate) -> Sequence[str]:
    joint = next(j for j in estimate.device.joints if j.name == found.name)
    unit = joint.torque_unit(estimate.torque)
    return unit, f"{unit}/rad"
