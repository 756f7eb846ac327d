"""The table of results in words, the same in the terminal and in the report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from rotatum.evaluation import Estimate, JointEstimate
from rotatum.evaluation.parts import PartEstimate
from rotatum.report.words import fitted_unit, measure, number

__all__ = [
    "FITTED",
    "TITLES",
    "Line",
    "answer",
    "cells",
    "fitted_lines",
    "lines",
    "stiffness_text",
]


class Line(NamedTuple):
    """One joint, or one of its transmissions, in the table of results; every cell a text.

    Parameters
    ----------
    name : the joint's; a transmission's stands under it, two spaces to the right.
    stiffness : final value with half its 95 % interval and unit.
    relative : half the interval over the stiffness, per cent.
    external : seen from the link, gravity included (flacco2012 eq. 6); "" where it is the same.
    verdict : at the last sample.
    since : when it was informative for the first time.
    torque : rms of the elastic torque with unit.
    mean, lowest, highest : stiffness over the scored samples.
    mse, msrep, covered : scores against truth; "" without.
    scored : since when, in s.
    """

    name: str
    stiffness: str
    relative: str
    verdict: str
    external: str = ""
    since: str = ""
    torque: str = ""
    mean: str = ""
    lowest: str = ""
    highest: str = ""
    mse: str = ""
    msrep: str = ""
    covered: str = ""
    scored: str = ""


TITLES = {
    "name": "joint",
    "stiffness": "stiffness",
    "relative": "interval",
    "external": "with gravity",
    "verdict": "verdict",
    "since": "first informative",
    "torque": "torque rms",
}
"""Titles of the columns every table of results has; which cells of a `Line` they head."""

FITTED = ("joint", "fitted", "value")
"""Titles of `fitted_lines`."""


def lines(estimate: Estimate) -> list[Line]:
    """Return the table of results: joints, each followed by its transmissions if there are two.

    Parameters
    ----------
    estimate : of the device.
    """
    found = []
    for joint in estimate.joints.values():
        unit = _unit(estimate, joint)
        found.append(_joint(joint, unit))
        if len(joint.parts) > 1:
            found += [_part(part, unit) for part in joint.parts]
    return found


def cells(told: Sequence[Line], titles: Mapping[str, str]) -> tuple[list[str], list[list[str]]]:
    """Return titles and rows of a table; columns with nothing in any cell are left out.

    Parameters
    ----------
    told : from `lines`.
    titles : field of `Line` to the title of its column, in order.
    """
    used = [field for field in titles if any(getattr(line, field) for line in told)]
    rows = [[getattr(line, field) for field in used] for line in told]
    return [titles[field] for field in used], rows


def answer(estimate: Estimate, found: JointEstimate) -> str:
    """Say a joint's result in a sentence or two.

    Parameters
    ----------
    estimate : of the device.
    found : one of its joints.
    """
    told = _joint(found, _unit(estimate, found))
    if found.verdict == "informative":
        since = f", first informative at {told.since}" if found.converged_at is not None else ""
        outside = ""
        if told.external:
            outside = f" Seen from the link, gravity included, it is {told.external}."
        return f"{told.name}: the stiffness is {told.stiffness} ({told.relative}){since}.{outside}"
    if found.verdict == "converging":
        return (
            f"{told.name}: the stiffness seems to be {told.stiffness} ({told.relative}), "
            "which is not yet narrow enough to rely on."
        )
    if found.verdict == "inconsistent":
        return f"{told.name}: no answer: data and model contradict each other."
    return f"{told.name}: no answer: the log does not tell the stiffness."


def fitted_lines(estimate: Estimate, found: JointEstimate) -> list[tuple[str, str, str]]:
    """Return what was fitted beside the stiffness: whose, name, value with interval and unit.

    Parameters
    ----------
    estimate : of the device.
    found : one of its joints.
    """
    unit = _unit(estimate, found)
    return [
        (part.label, name, measure(value, std, fitted_unit(name, unit)))
        for part in found.parts
        for name, (value, std) in part.fitted.items()
    ]


def _joint(found: JointEstimate, unit: str) -> Line:
    sigma, std = found.stiffness["final"], found.stiffness_std
    outside = found.external_stiffness
    # In a current's unit gravity, in N m, cannot be added.
    if unit != "N m" or outside is None or outside == sigma or not _learned(sigma, std):
        outside = None
    return Line(
        name=found.name,
        stiffness=stiffness_text(sigma, std, f"{unit}/rad"),
        relative=_relative(sigma, std),
        external="" if outside is None else f"{number(outside)} {unit}/rad",
        verdict=found.verdict,
        since="-" if found.converged_at is None else f"{found.converged_at:.2f} s",
        torque=f"{number(found.torque_rms, 3)} {unit}",
        mean=number(found.stiffness["mean"]),
        lowest=number(found.stiffness["min"]),
        highest=number(found.stiffness["max"]),
        mse=_score(found.truth, "mse"),
        msrep=_score(found.truth, "msrep_percent"),
        covered=_score(found.truth, "coverage_percent"),
        scored=number(found.score_from) if found.truth else "",
    )


def _part(part: PartEstimate, unit: str) -> Line:
    return Line(
        name=f"  transmission {part.end}",
        stiffness=stiffness_text(part.stiffness, part.stiffness_std, f"{unit}/rad"),
        relative=_relative(part.stiffness, part.stiffness_std),
        verdict=part.verdict,
        mse=_score(part.truth, "mse"),
        msrep=_score(part.truth, "msrep_percent"),
        covered=_score(part.truth, "coverage_percent"),
    )


def stiffness_text(sigma: float, std: float, unit: str) -> str:
    """Write a stiffness with its interval; a dash where nothing was learned.

    Parameters
    ----------
    sigma, std : the stiffness and its standard deviation.
    unit : of it, written behind.
    """
    return measure(sigma, std, unit) if _learned(sigma, std) else "-"


def _relative(sigma: float, std: float) -> str:
    if not _learned(sigma, std):
        return "-"
    relative = 196.0 * std / abs(sigma) if sigma else math.inf
    return f"{number(relative, 2 if relative < 100.0 else 3)} %"


def _learned(sigma: float, std: float) -> bool:
    return math.isfinite(sigma) and std > 0.0


def _score(truth: Mapping[str, float] | None, key: str) -> str:
    return "" if truth is None else number(truth[key], 3)


def _unit(estimate: Estimate, found: JointEstimate) -> str:
    joint = next(j for j in estimate.device.joints if j.name == found.name)
    return joint.torque_unit(estimate.torque)
