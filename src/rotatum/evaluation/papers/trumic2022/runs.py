"""What a method made of a joint over a motion, thinned for plots, and its scores."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.estimate import JointEstimate
from rotatum.evaluation.metrics import msrep_percent

__all__ = ["Track", "estimated", "relative_error", "track"]

Array = NDArray[np.float64]

SHOWN = 0.05  # s, from one drawn point to the next


class Track(NamedTuple):
    """A stiffness over time beside its truth.

    Args:
        time: (n,) s.
        stiffness, truth: (n,) N m/rad.
        msrep: from the start of the scores on, %.
        mean: mean of the relative error there, without its sign, %.
        verdict: at the last sample; empty where the method gives none.
        confounded: quantities the data do not tell apart.
    """

    time: Array
    stiffness: Array
    truth: Array
    msrep: float
    mean: float
    verdict: str = ""
    confounded: tuple[tuple[str, ...], ...] = ()


def track(time: Array, stiffness: Array, truth: Array, start: float) -> Track:
    """Score every sample, keep a few.

    Args:
        time: (N,) s.
        stiffness, truth: (N,) N m/rad.
        start: seconds after the first sample from which it is scored.
    """
    late = time >= time[0] + start
    every = max(1, round(SHOWN / float(time[1] - time[0])))
    t, sigma, true = (x[::every].copy() for x in (time, stiffness, truth))
    error = float(np.mean(np.abs(relative_error(stiffness[late], truth[late]))))
    return Track(t, sigma, true, msrep_percent(stiffness[late], truth[late]), error)


def estimated(joint: JointEstimate, start: float) -> Track:
    """Return the track of an estimate whose log knows the truth.

    Args:
        joint: from ``estimate``.
        start: as for ``track``.
    """
    found, records = joint.truth_records["stiffness"], joint.records
    own = track(records["time"], np.asarray(records["stiffness"]), found, start)
    return own._replace(verdict=joint.verdict, confounded=joint.confounded)


def relative_error(stiffness: Array, truth: Array) -> Array:
    """Return the error over the truth, %."""
    return np.asarray(100.0 * (stiffness / truth - 1.0))
