"""What an estimation run gives back: per joint the samples, the summary, the verdict and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.columns import Power
from rotatum.evaluation.parts import PartEstimate
from rotatum.evaluation.table import reading_columns
from rotatum.models import Device
from rotatum.record import Records

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


@dataclass(frozen=True)
class JointEstimate:
    """One joint's result.

    Args:
        name: of the joint.
        records: ``(N,)`` records of ``Reading`` (time s, stiffness N m/rad, ...), every
            ``every``-th sample.
        every: 1 unless the log was too long to keep every sample.
        columns: names of the regressors, fitted ones first, then the basis; of an antagonistic
            joint the agonist's, ending in 1, then the antagonist's. A set-point ``s`` in them is
            less the middle of its range.
        coefficients, coefficients_std: (p,) final values in SI at the joint.
        parts: each transmission's own result; a series or serial joint has one.
        fitted: quantity to (value, standard deviation), in the device file's side and units.
        stiffness: ``final``, ``mean``, ``min``, ``max``, N m/rad; the last three over the scored
            samples, which are those from ``score_from`` on.
        stiffness_std: at the last sample, N m/rad.
        external_stiffness: at the last sample, gravity on the link included (flacco2012 eq. 6),
            N m/rad; None where the device describes no link.
        torque_rms: of the fitted elastic torque, N m.
        verdict: at the last sample.
        reason: a sentence saying why.
        confounded: groups of fitted quantities, "stiffness" among them, that the data do not tell
            apart; one alone drowns in noise. Their fitted values are NaN.
        converged_at: seconds after the log's first sample since when the verdict was first
            informative for 1 s, or None.
        truth: ``mse``, ``msrep_percent``, ``coverage_percent`` where the log knows it, or None.
        score_from: seconds after the first sample from which samples were scored, or None.
        samples: per status bit name, how many samples had it.
        ns_per_sample: time of the kernels, ns.
        delay: seconds by which a row's centre lags behind its last sample: what the coefficients
            know is as old. The stiffness is read out at the deflection of now.
        settings: setting to its value and why.
        powers: terms of the basis, in the order of the columns.
        logged: role to what was logged at the kept samples: ``q``, ``setpoint``,
            ``torque_measured`` where there are such.
        truth_records: ``stiffness`` and ``torque`` truth at the kept samples, empty if not known.
    """

    name: str
    records: Records
    every: int
    columns: tuple[str, ...]
    coefficients: NDArray[np.float64]
    coefficients_std: NDArray[np.float64]
    parts: tuple[PartEstimate, ...]
    fitted: Mapping[str, tuple[float, float]]
    stiffness: Mapping[str, float]
    stiffness_std: float
    external_stiffness: float | None
    torque_rms: float
    verdict: str
    reason: str
    converged_at: float | None
    confounded: tuple[tuple[str, ...], ...]
    truth: Mapping[str, float] | None
    score_from: float | None
    samples: Mapping[str, int]
    ns_per_sample: float
    delay: float
    settings: Mapping[str, str]
    powers: tuple[Power, ...] = ()
    logged: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    truth_records: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """The joint's entry in ``--json``."""
        return {
            "stiffness": dict(self.stiffness),
            "stiffness_std": self.stiffness_std,
            "external_stiffness": self.external_stiffness,
            "torque_rms": self.torque_rms,
            "coefficients": [float(c) for c in self.law_coefficients],
            "verdict": self.verdict,
            "reason": self.reason,
            "converged_at": self.converged_at,
            "confounded": [list(group) for group in self.confounded],
            "fitted": {k: list(v) for k, v in self.fitted.items()},
            "truth": None if self.truth is None else dict(self.truth),
            "ns_per_sample": self.ns_per_sample,
            "delay": self.delay,
            **self._transmissions(),
        }

    @property
    def law_coefficients(self) -> NDArray[np.float64]:
        """Coefficients of the elastic law alone, low to high order, the agonist's first."""
        own = len(self.powers)
        return np.concatenate([p.coefficients[len(p.coefficients) - own :] for p in self.parts])

    def _transmissions(self) -> dict[str, Any]:
        if len(self.parts) < 2:
            return {}
        return {"transmissions": [part.to_json() for part in self.parts]}


@dataclass(frozen=True)
class Estimate:
    """Result of ``rotatum.estimate``: every joint of a device over one log.

    Args:
        source: the log.
        device: what was estimated.
        method, side, torque: of the first joint (all joints share them unless the device file
            says otherwise per joint; see ``joints[...].settings``).
        period: s.
        samples: in the log.
        seconds: of the log, first to last sample.
        joints: name to result.
        warnings: sentences about the log and the run.
        cites: keys of the papers behind the methods used.
    """

    source: str
    device: Device
    method: str
    side: str
    torque: str
    period: float
    samples: int
    seconds: float
    joints: Mapping[str, JointEstimate]
    warnings: tuple[str, ...]
    cites: tuple[str, ...]

    @property
    def informative(self) -> bool:
        """Whether the last verdict of any joint is ``informative``."""
        return any(j.verdict == "informative" for j in self.joints.values())

    def to_json(self) -> dict[str, Any]:
        """The object ``--json`` prints: finite numbers, strings and null only."""
        found = {
            "log": self.source,
            "device": self.device.name,
            "method": self.method,
            "side": self.side,
            "torque": self.torque,
            "period": self.period,
            "samples": self.samples,
            "seconds": self.seconds,
            "joints": {name: joint.to_json() for name, joint in self.joints.items()},
            "warnings": list(self.warnings),
        }
        cleaned: dict[str, Any] = finite(found)
        return cleaned

    def write(self, path: str | Path) -> None:
        """Write the kept samples as a table (CSV, NPZ or Parquet by the ending).

        Canonical columns: ``time``, ``<joint>.stiffness``, ``.stiffness_std``, ``.torque``,
        ``.torque_std``, ``.dstiffness``, ``.deflection``, ``.verdict``, ``.status``; see
        ``rotatum.evaluation.table``.

        Raises:
            OutputError: it cannot be written; no partial file is left.
        """
        from rotatum.logs import write_table

        names = list(self.joints)
        first = self.joints[names[0]]
        columns: dict[str, NDArray[Any]] = {"time": first.records["time"]}
        for name in names:
            joint = next(j for j in self.device.joints if j.name == name)
            found = self.joints[name]
            columns |= reading_columns(joint, self.torque, found.records, found.logged["q"])
        write_table(path, columns)

    def plot(self) -> Figure:
        """An interactive figure: stiffness with its band, torque, characteristic, verdict."""
        from rotatum.report import plot

        return plot(self)

    def __repr__(self) -> str:
        told = ", ".join(
            f"{n}: {j.stiffness['final']:.4g} +- {1.96 * j.stiffness_std:.2g} N m/rad {j.verdict}"
            for n, j in self.joints.items()
        )
        return f"Estimate({self.source}, {self.method}, {told})"


def finite(value: Any) -> Any:
    """JSON has no NaN or infinity: they become null."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, list):
        return [finite(v) for v in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value
