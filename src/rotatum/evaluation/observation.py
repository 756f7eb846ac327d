"""What observing a log gives back: per joint the state in time, and how well it meets the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.full_state.design import Design
from rotatum.evaluation.estimate import finite
from rotatum.models import Device

__all__ = ["JointObservation", "Observation", "Score"]

Array = NDArray[np.float64]

STATES = ("q_hat", "dq_hat", "theta_hat", "dtheta_hat", "deflection", "torque")
"""Canonical columns of an observed joint, beside its status."""


@dataclass(frozen=True)
class Score:
    """Errors of an observed joint against what is known of it, over the scored samples.

    Args:
        of: ``"truth"``, or ``"encoder"``: the log's own link encoder, q alone.
        q_rms, q_max: of the link's position, rad.
        rigid_rms: the same of a joint taken for rigid, ``q = theta``, rad.
        deflection_max: of ``q - theta``, rad.
        dq_rms, dq_max: of the link's velocity, rad/s; NaN where it is not known.
    """

    of: str
    q_rms: float
    q_max: float
    rigid_rms: float
    deflection_max: float
    dq_rms: float
    dq_max: float

    def to_json(self) -> dict[str, Any]:
        """Its object in ``--json``."""
        return dict(vars(self))


@dataclass(frozen=True)
class JointObservation:
    """One joint's state over a log.

    Args:
        name: of the joint.
        determined: whether the sensors determine the acceleration of its link.
        design: of its observer.
        series: ``time`` [s], those of `STATES` and ``status``; where the log has them ``q``, the
            link's encoder, and the truth ``q_true``, ``dq_true``, ``theta_true``: (K,) each.
        every: 1 unless the log was too long to keep every sample.
        peak: largest deflection, by magnitude, rad; of velocity, rad/s; of torque, N m: over the
            scored samples.
        status: per status bit name, how many samples had it.
        told: share of the scored samples at which the sensors told the link's acceleration, that
            is neither ``singular`` nor ``unseen``.
        score: against the truth, else the link's encoder; None: the log has neither.
    """

    name: str
    determined: bool
    design: Design
    series: Mapping[str, NDArray[Any]]
    every: int
    peak: Mapping[str, float]
    status: Mapping[str, int]
    told: float
    score: Score | None

    def to_json(self) -> dict[str, Any]:
        """The joint's entry in ``--json``."""
        return {
            "determined": self.determined,
            "told_percent": 100.0 * self.told,
            "poles": [pair._asdict() for pair in self.design.pairs],
            "gyro": self.design.gyro,
            "stiffness": self.design.drivetrain.stiffness,
            "peak": dict(self.peak),
            "status": {name: count for name, count in self.status.items() if count},
            "score": None if self.score is None else self.score.to_json(),
        }


@dataclass(frozen=True)
class Observation:
    """Result of ``rotatum.observe``: the full state of every joint of a device over one log.

    Args:
        source: the log.
        device: what was observed.
        sensors: columns of the log the accelerations, and rates, came from.
        period: s.
        samples: in the log.
        seconds: of the log, first to last sample.
        score_from: seconds after the first sample from which all joints were scored.
        joints: name to result.
        microseconds: of computation per sample of all joints.
        warnings: sentences about the log and the run.
    """

    source: str
    device: Device
    sensors: tuple[str, ...]
    period: float
    samples: int
    seconds: float
    score_from: float
    joints: Mapping[str, JointObservation]
    microseconds: float
    warnings: tuple[str, ...]

    @property
    def observed(self) -> bool:
        """Whether the sensors told the acceleration of any link at any scored sample."""
        return any(joint.told > 0.0 for joint in self.joints.values())

    def to_json(self) -> dict[str, Any]:
        """The object ``--json`` prints: finite numbers, strings and null only."""
        found: dict[str, Any] = finite(
            {
                "log": self.source,
                "device": self.device.name,
                "sensors": list(self.sensors),
                "period": self.period,
                "samples": self.samples,
                "seconds": self.seconds,
                "score_from": self.score_from,
                "joints": {name: joint.to_json() for name, joint in self.joints.items()},
                "us_per_sample": self.microseconds,
                "warnings": list(self.warnings),
            }
        )
        return found

    def write(self, path: str | Path) -> None:
        """Write the kept samples as a table (CSV, NPZ or Parquet by the ending).

        Canonical columns: ``time``, and per joint `STATES` and ``status``.

        Raises:
            OutputError: it cannot be written; no partial file is left.
        """
        from rotatum.logs import write_table

        first = next(iter(self.joints.values()))
        columns: dict[str, NDArray[Any]] = {"time": first.series["time"]}
        for name, joint in self.joints.items():
            columns |= {f"{name}.{key}": joint.series[key] for key in (*STATES, "status")}
        write_table(path, columns)

    def __repr__(self) -> str:
        told = ", ".join(
            f"{n}: torsion up to {1e3 * j.peak['deflection']:.3g} mrad"
            for n, j in self.joints.items()
        )
        return f"Observation({self.source}, {told})"
