"""What a table keeps of a joint's estimate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from rotatum.evaluation.estimate import JointEstimate
from rotatum.logs import Log

__all__ = ["joint_values"]

_SCORES = ("mse", "msrep_percent", "coverage_percent")


def joint_values(found: JointEstimate, log: Log) -> dict[str, Any]:
    """Return a joint's row as column to number or text.

    Stiffness in N m/rad is that at the last sample, ``error_percent`` its error
    ``100 (stiffness - stiffness_true) / stiffness_true``; the scores are those of
    ``JointEstimate``. An antagonistic joint has ``stiffness1``, ``error1_percent``,
    ``stiffness1_std`` and so on beside the total. What there is not is NaN.

    Args:
        found: the joint's estimate.
        log: what it was estimated from, for the truth.
    """
    # A log of one joint may call it otherwise than the device does.
    name = found.name if found.name in log.joints else next(iter(log.joints))
    logged = log.joints[name]
    values: dict[str, Any] = {
        "verdict": found.verdict,
        **_stiffness("", found.stiffness["final"], found.stiffness_std, logged),
        **_scores("", found.truth),
        "converged_at": math.nan if found.converged_at is None else float(found.converged_at),
        "torque_rms": float(found.torque_rms),
    }
    if len(found.parts) > 1:
        for part in found.parts:
            values[f"verdict{part.end}"] = part.verdict
            values |= _stiffness(part.end, part.stiffness, part.stiffness_std, logged)
            values |= _scores(part.end, part.truth)
    for quantity, (value, std) in found.fitted.items():
        values[f"fitted.{quantity}"] = float(value)
        values[f"fitted.{quantity}_std"] = float(std)
    values["ns_per_sample"] = float(found.ns_per_sample)
    return values


def _stiffness(end: str, value: float, std: float, logged: Mapping[str, Any]) -> dict[str, float]:
    known = np.asarray(logged.get(f"stiffness{end}_true", ()), dtype=np.float64)
    true = float(known[-1]) if known.size else math.nan
    error = 100.0 * (float(value) - true) / true if true != 0.0 else math.nan
    return {
        f"stiffness{end}": float(value),
        f"stiffness{end}_std": float(std),
        f"stiffness{end}_true": true,
        f"error{end}_percent": error,
    }


def _scores(end: str, truth: Mapping[str, float] | None) -> dict[str, float]:
    told = truth or {}
    return {_with_end(name, end): float(told.get(name, math.nan)) for name in _SCORES}


def _with_end(name: str, end: str) -> str:
    word, _, unit = name.partition("_")
    return f"{word}{end}_{unit}" if unit else f"{word}{end}"
