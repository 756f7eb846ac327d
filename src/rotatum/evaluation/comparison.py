"""What a comparison gives back: a line per joint and method, what could not run, the curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.agreement import Curve
from rotatum.evaluation.estimate import finite
from rotatum.evaluation.recommend import Recommendation
from rotatum.models import Device

__all__ = ["ComparedMethod", "Comparison", "LeftOut"]


@dataclass(frozen=True)
class ComparedMethod:
    """One method's result for one joint.

    Args:
        joint: its name.
        name: of the method in the table: "weak", "weak, window", ...
        method, side, torque: as ``estimate`` takes them.
        windowed: whether its rows went through a window and not through a low-pass.
        width: of that, in words.
        stiffness, stiffness_std: at the last sample, N m/rad.
        verdict, reason: at the last sample.
        converged_at: s, or None.
        delay: of its rows, s.
        ns_per_sample: time of the kernels, ns.
        fitted: quantity to (value, standard deviation).
        truth: ``mse``, ``msrep_percent``, ``coverage_percent`` over the scored samples, or None.
        disagreement: ``rms_percent`` and ``within_percent`` against the reference over the scored
            samples; None: it is the reference, or they have none in common.
        curve: stiffness over the log.
    """

    joint: str
    name: str
    method: str
    side: str
    torque: str
    windowed: bool
    width: str
    stiffness: float
    stiffness_std: float
    verdict: str
    reason: str
    converged_at: float | None
    delay: float
    ns_per_sample: float
    fitted: Mapping[str, tuple[float, float]]
    truth: Mapping[str, float] | None
    disagreement: Mapping[str, float] | None
    curve: Curve

    @property
    def label(self) -> str:
        """Name and side."""
        return f"{self.name}, {self.side} side"

    def to_json(self) -> dict[str, Any]:
        """The method's entry in ``--json``."""
        return {
            "name": self.name,
            "method": self.method,
            "side": self.side,
            "torque": self.torque,
            "width": self.width,
            "stiffness": self.stiffness,
            "stiffness_std": self.stiffness_std,
            "verdict": self.verdict,
            "reason": self.reason,
            "converged_at": self.converged_at,
            "delay": self.delay,
            "ns_per_sample": self.ns_per_sample,
            "fitted": {name: list(value) for name, value in self.fitted.items()},
            "truth": None if self.truth is None else dict(self.truth),
            "disagreement": None if self.disagreement is None else dict(self.disagreement),
        }


@dataclass(frozen=True)
class LeftOut:
    """A method that a joint's log or description does not allow.

    Args:
        joint: its name.
        name, side: of the method.
        why: a sentence that names what is missing.
    """

    joint: str
    name: str
    side: str
    why: str


@dataclass(frozen=True)
class Comparison:
    """Result of ``rotatum.compare``: every method a log allows, on both sides.

    ``rotatum.write_comparison`` makes a page of it, ``rotatum.plot_comparison`` a figure.

    Args:
        source: the log.
        device: what was estimated.
        period: s.
        samples: in the log.
        seconds: of the log, first to last sample.
        methods: what ran, joint by joint.
        left_out: what could not, and why.
        references: joint to the label of the method the others are held against.
        score_from: joint to seconds after the first sample from which all are scored.
        recommendation: what ``rotatum.recommend`` says of this log.
        warnings: sentences about the log and the runs.
    """

    source: str
    device: Device
    period: float
    samples: int
    seconds: float
    methods: tuple[ComparedMethod, ...]
    left_out: tuple[LeftOut, ...]
    references: Mapping[str, str]
    score_from: Mapping[str, float]
    recommendation: Recommendation
    warnings: tuple[str, ...]

    @property
    def informative(self) -> bool:
        """Whether any method's last verdict on any joint is ``informative``."""
        return any(found.verdict == "informative" for found in self.methods)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the device's order."""
        return tuple(self.references)

    def of(self, joint: str) -> tuple[ComparedMethod, ...]:
        """Return the methods that ran on a joint."""
        return tuple(found for found in self.methods if found.joint == joint)

    def to_json(self) -> dict[str, Any]:
        """The object ``--json`` prints: finite numbers, strings and null only."""
        joints = {
            name: {
                "score_from": self.score_from[name],
                "reference": self.references[name],
                "methods": [found.to_json() for found in self.of(name)],
                "left_out": [
                    {"name": out.name, "side": out.side, "why": out.why}
                    for out in self.left_out
                    if out.joint == name
                ],
                "recommendation": self.recommendation.joints[name].to_json(),
            }
            for name in self.joints
        }
        cleaned: dict[str, Any] = finite(
            {
                "log": self.source,
                "device": self.device.name,
                "period": self.period,
                "samples": self.samples,
                "seconds": self.seconds,
                "joints": joints,
                "warnings": list(self.warnings),
            }
        )
        return cleaned

    def write(self, path: str | Path) -> None:
        """Write the table, a row per joint and method (CSV, NPZ or Parquet by the ending).

        Raises:
            OutputError: it cannot be written; no partial file is left.
        """
        from rotatum.logs import write_table

        write_table(path, _columns(self.methods))

    def __repr__(self) -> str:
        told = ", ".join(
            f"{m.joint}: {m.label} {m.stiffness:.4g} N m/rad {m.verdict}" for m in self.methods
        )
        return f"Comparison({self.source}, {told})"


_TEXTS = ("joint", "name", "method", "side", "torque", "width", "verdict")
_NUMBERS = ("stiffness", "stiffness_std", "converged_at", "delay", "ns_per_sample")
_SCORES = {
    "truth": ("mse", "msrep_percent", "coverage_percent"),
    "disagreement": ("rms_percent", "within_percent"),
}


def _columns(methods: tuple[ComparedMethod, ...]) -> dict[str, NDArray[Any]]:
    columns: dict[str, NDArray[Any]] = {
        name: np.array([getattr(found, name) for found in methods]) for name in _TEXTS
    }
    for name in _NUMBERS:
        columns[name] = np.array([_number(getattr(found, name)) for found in methods])
    for table, names in _SCORES.items():
        for name in names:
            told = [(getattr(found, table) or {}).get(name) for found in methods]
            columns[name] = np.array([_number(value) for value in told])
    return columns


def _number(value: float | None) -> float:
    return np.nan if value is None else float(value)
