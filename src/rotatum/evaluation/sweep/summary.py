"""A sweep in a few lines: per combination of values how far off, how often with an answer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from rotatum.evaluation.sweep.table import rows
from rotatum.evaluation.sweep.vary import Value
from rotatum.evaluation.sweep.work import OK

__all__ = ["Group", "summary"]

_HIGH = 90.0  # per cent


@dataclass(frozen=True)
class Group:
    """All seeds of a combination, for one joint.

    Args:
        values: varied key to value.
        joint: name.
        cases: how many.
        informative, not_ok: shares of the cases, 0 to 1; not ok are those refused by scenario or
            estimator, stopped in the simulation, or failed.
        error_percent, error_percent_90: median and 90th percentile of the magnitude of the error
            of the stiffness at the last sample, NaN where no truth is known.
        msrep_percent, msrep_percent_90: the same of the MSREP over the scored samples.
        coverage_percent: mean.
    """

    values: Mapping[str, Value]
    joint: str
    cases: int
    informative: float
    not_ok: float
    error_percent: float
    error_percent_90: float
    msrep_percent: float
    msrep_percent_90: float
    coverage_percent: float

    def to_json(self) -> dict[str, Any]:
        """The group's object in ``--json``; JSON has no NaN, which becomes null."""
        return {name: _json(value) for name, value in asdict(self).items()}


def summary(results: Sequence[Mapping[str, Any]]) -> list[Group]:
    """Return a group per combination and joint, in the order of the cases.

    Args:
        results: of ``sweep``.
    """
    groups: dict[str, tuple[Mapping[str, Value], str, list[Mapping[str, Any]]]] = {}
    for result in results:
        for row in rows([result]):
            key = repr((result["values"], row["joint"]))
            groups.setdefault(key, (result["values"], row["joint"], []))[2].append(row)
    return [_group(values, joint, found) for values, joint, found in groups.values()]


def _group(values: Mapping[str, Value], joint: str, found: Sequence[Mapping[str, Any]]) -> Group:
    def numbers(name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
        told = np.array([row.get(name, math.nan) for row in found], dtype=np.float64)
        return np.abs(told[np.isfinite(told)])

    error, msrep = numbers("error_percent"), numbers("msrep_percent")
    covered = numbers("coverage_percent")
    return Group(
        values=values,
        joint=joint,
        cases=len(found),
        informative=_share(row.get("verdict") == "informative" for row in found),
        not_ok=_share(row["status"] != OK for row in found),
        error_percent=_percentile(error, 50.0),
        error_percent_90=_percentile(error, _HIGH),
        msrep_percent=_percentile(msrep, 50.0),
        msrep_percent_90=_percentile(msrep, _HIGH),
        coverage_percent=float(covered.mean()) if covered.size else math.nan,
    )


def _share(found: Iterable[bool]) -> float:
    told = list(found)
    return sum(told) / len(told)


def _percentile(values: np.ndarray[Any, np.dtype[np.float64]], which: float) -> float:
    return float(np.percentile(values, which)) if values.size else math.nan


def _json(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {name: _json(inner) for name, inner in value.items()}
    return [_json(inner) for inner in value] if isinstance(value, list) else value
