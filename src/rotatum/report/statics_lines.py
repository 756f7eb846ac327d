"""A characterisation in words: the tables' cells, the same in the terminal and in the page."""

from __future__ import annotations

import math

from rotatum.evaluation.statics.result import Characterisation, Fitted, JointCharacteristic
from rotatum.evaluation.statics.spread import SHAPE
from rotatum.report.words import measure, number

__all__ = ["CONSTANTS", "PRESETS", "answer_of", "constant_rows", "preset_rows", "sentences"]

CONSTANTS = ("joint", "constant", "value", "unit")
"""Titles of the table of constants."""
PRESETS = ("joint", "preset", "samples", "c %", "below floor", "rms N m", "stiffness N m/rad")
"""Titles of the table of presets; all but the first stand to the right."""


def constant_rows(found: Characterisation) -> list[tuple[str, ...]]:
    """Return the rows of the constants, then products that are told in their place, nuisances.

    Parameters
    ----------
    found : to be told.
    """
    rows: list[tuple[str, ...]] = []
    for joint in found.joints.values():
        each = (*joint.constants, *joint.together, *joint.nuisances)
        rows += [(joint.name, one.name, _value(one), one.unit) for one in each]
        rows += [
            (joint.name, name, f"{value:.6g} (given)", "") for name, value in joint.fixed.items()
        ]
    return rows


def preset_rows(found: Characterisation) -> list[tuple[str, ...]]:
    """Return a row per preset, and one of the whole joint.

    Parameters
    ----------
    found : to be told.
    """
    rows: list[tuple[str, ...]] = []
    for joint in found.joints.values():
        for preset in joint.presets:
            told = number(preset.value) if len(joint.presets) > 1 else "one"
            numbers = number(preset.rms), number(preset.stiffness)
            left, c = f"{preset.below_floor:,}", number(preset.relative_percent)
            rows.append((joint.name, told, f"{preset.samples:,}", c, left, *numbers))
        whole = f"{joint.samples:,}", number(joint.relative_percent), f"{joint.below_floor:,}"
        rows.append((joint.name, "all", *whole, number(joint.rms), ""))
    return rows


def sentences(joint: JointCharacteristic) -> list[str]:
    """Return what stands below the tables.

    Parameters
    ----------
    joint : to be told.
    """
    floors = ", ".join(number(floor) for floor in dict.fromkeys(joint.floors))
    found = [
        answer_of(joint),
        f"c is over torques beyond {floors} N m; {joint.below_floor:,} samples are below. The law "
        f"explains {joint.explained_percent:.5g} % of the torque's variance.",
    ]
    left = ", ".join(f"{count:,} {why}" for why, count in joint.left_out.items() if count)
    if left:
        told = f"Samples left out: {left}"
        limit = f" (beyond {number(joint.speed_limit)} rad/s)" if joint.left_out["too fast"] else ""
        found.append(f"{told}{limit}.")
    if joint.correlation > 2.0:
        told = (
            f"Residuals stay alike over {joint.correlation:.0f} samples; the intervals count it in."
        )
        if joint.correlation > SHAPE * joint.samples:
            told += " So long is no sensor's filter: the law is not quite that of the joint."
        found.append(told)
    return found


def answer_of(joint: JointCharacteristic) -> str:
    """Return the result in one sentence.

    Parameters
    ----------
    joint : to be told.
    """
    if joint.answered:
        return (
            f"Relative rms error c = {number(joint.relative_percent)} % "
            f"({number(joint.rms)} N m absolute)."
        )
    names = ", ".join(joint.confounded)
    told = "; only " + ", ".join(one.name for one in joint.together) if joint.together else ""
    plural = "one from another" if len(joint.confounded) > 1 else "at all"
    tied = ", or one set of constants for both transmissions (--tied)"
    each = any(one.name.rstrip("]").endswith("1") for one in joint.constants)
    return (
        f"The data cannot tell {names} {plural}{told}. Larger deflections or other presets would"
        + (tied if each and joint.actuation == "antagonistic" else "")
        + "; a constant that is known can be given (--fix)."
    )


def _value(one: Fitted) -> str:
    return measure(one.value, one.std) if math.isfinite(one.value) else "not told"
