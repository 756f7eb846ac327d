"""How far two methods agree, and how well one meets the truth, on the same samples."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.estimate import JointEstimate
from rotatum.evaluation.metrics import Z95, TruthScore
from rotatum.kernels.status import PRIOR

__all__ = ["Curve", "curve_of", "disagreement", "score", "start_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """A method's stiffness over the log, at every ``every``-th sample.

    Args:
        time: (K,) s after the log's first sample.
        stiffness, std: (K,) N m/rad; NaN while they rest on the prior.
        truth: (K,) N m/rad, or None.
        every: 1 unless the log is long.
    """

    time: Array
    stiffness: Array
    std: Array
    truth: Array | None
    every: int

    def thinned(self, every: int) -> Curve:
        """Return every ``every``-th sample of the log, a multiple of what there is."""
        pick = slice(None, None, every // self.every)
        truth = None if self.truth is None else self.truth[pick]
        return Curve(self.time[pick], self.stiffness[pick], self.std[pick], truth, every)


def curve_of(found: JointEstimate) -> Curve:
    """Return the curve of an estimate; of its other fields nothing is kept in memory.

    Args:
        found: of a joint.
    """
    records = found.records
    time = np.array(records["time"])
    finite = time[np.isfinite(time)]
    known = (records["status"] & PRIOR) == 0
    truth = found.truth_records.get("stiffness")
    return Curve(
        time=time - (finite[0] if finite.size else 0.0),
        stiffness=np.where(known, records["stiffness"], np.nan),
        std=np.where(known, records["stiffness_std"], np.nan),
        truth=None if truth is None else np.array(truth),
        every=found.every,
    )


def start_of(converged: Sequence[float | None], seconds: float) -> float:
    """Return from when on all are scored: the latest to converge, else the last half.

    Args:
        converged: each method's ``converged_at``, s.
        seconds: of the log.

    >>> start_of([1.5, None, 2.5], 20.0), start_of([None], 20.0)
    (2.5, 10.0)
    """
    known = [time for time in converged if time is not None]
    return max(known) if known else 0.5 * seconds


def score(curve: Curve, start: float) -> Mapping[str, float] | None:
    """Return ``mse``, ``msrep_percent`` and ``coverage_percent``; None without a truth.

    Args:
        curve: of a method.
        start: s.
    """
    if curve.truth is None:
        return None
    scored = curve.time >= start
    found = TruthScore()
    found.update(curve.stiffness[scored], curve.std[scored], curve.truth[scored])
    return found.result() if found.samples else None


def disagreement(curve: Curve, reference: Curve, start: float) -> Mapping[str, float] | None:
    """Compare two methods sample by sample; None where they have no sample in common.

    ``rms_percent``: root mean square of their difference over the reference, in per cent.
    ``within_percent``: how often the difference lies within the two intervals together,
    ``1.96 sqrt(std^2 + std_ref^2)``: they share the encoders, so that this is more than enough.

    Args:
        curve, reference: over the same log.
        start: s.
    """
    every = max(curve.every, reference.every)
    own, other = curve.thinned(every), reference.thinned(every)
    common = (own.time >= start) & np.isfinite(own.stiffness) & np.isfinite(other.stiffness)
    common &= other.stiffness != 0.0
    if not common.any():
        return None
    difference = (own.stiffness - other.stiffness)[common]
    relative = difference / other.stiffness[common]
    both = Z95 * np.hypot(own.std[common], other.std[common])
    return {
        "rms_percent": 100.0 * math.sqrt(float(np.mean(relative * relative))),
        "within_percent": 100.0 * float(np.mean(np.abs(difference) <= both)),
    }
