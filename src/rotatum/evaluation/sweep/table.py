"""Results of cases as columns of a table, a row per case and joint."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.sweep.vary import Vary

__all__ = ["TIMINGS", "columns", "rows"]

TIMINGS = ("simulate_seconds", "estimate_seconds", "ns_per_sample")
"""The columns in which the same sweep, run twice, may differ."""

_FIRST = ("seed", "joint", "status", "message", "verdict")
_TEXTS = ("joint", "status", "message", "verdict", "verdict1", "verdict2")
_WHOLE = ("case", "seed")


def rows(results: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Give a row per case and joint, in order; a case of no known joint is one row.

    Args:
        results: of ``run_case``, in the order of the cases.
    """
    for result in results:
        shared = {k: v for k, v in result.items() if k not in ("values", "joints")}
        varied = {f"values.{key}": value for key, value in result["values"].items()}
        for joint, values in (result["joints"] or {"": {}}).items():
            yield {**shared, **varied, "joint": joint, **values}


def columns(
    results: Sequence[Mapping[str, Any]], varied: Sequence[Vary]
) -> dict[str, NDArray[np.generic]]:
    """Return the table, column to (N,) values.

    Varied keys are columns of their own name. Where a column's values are not all numbers they
    are texts; lists are written as in JSON. What a row does not have is NaN or an empty text.

    Args:
        results: of ``run_case``, in the order of the cases.
        varied: what was varied.
    """
    told = list(rows(results))
    names = dict.fromkeys(name for row in told for name in row)
    own = [f"values.{vary.key}" for vary in varied]
    head = ["case", *own, *_FIRST]
    order = [*head, *(n for n in names if n not in (*head, *TIMINGS)), *TIMINGS]
    return {
        name.removeprefix("values."): _column(name, [row.get(name) for row in told])
        for name in order
    }


def _column(name: str, values: Sequence[Any]) -> NDArray[np.generic]:
    if name in _TEXTS:
        return np.array([value or "" for value in values], dtype=np.str_)
    if name in _WHOLE:
        return np.array(values, dtype=np.int64)
    if name.startswith("values."):
        return _varied(values)
    return np.array([math.nan if value is None else value for value in values], dtype=np.float64)


def _varied(values: Sequence[Any]) -> NDArray[np.generic]:
    kinds = {type(value) for value in values}
    if kinds == {bool}:
        return np.array(values, dtype=np.bool_)
    if kinds == {int} and all(abs(value) < 2**63 for value in values):
        return np.array(values, dtype=np.int64)
    if kinds <= {int, float}:
        return np.array(values, dtype=np.float64)
    texts = [v if isinstance(v, str) else json.dumps(v, ensure_ascii=False) for v in values]
    return np.array(texts, dtype=np.str_)
