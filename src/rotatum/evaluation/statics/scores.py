"""How well a characteristic meets the data: relative rms, absolute rms, preset by preset."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.evaluation.statics.samples import Samples

__all__ = ["Preset", "presets_of", "relative_rms_percent"]

Array = NDArray[np.float64]
_GROUPS = 12  # presets told apart at most
_APART = 0.03  # of the range: a gap between two presets
_BINS = 5  # of presets that move all the time
_COUNTS = 1e-3  # rad or unit of the set-point: less is one preset


class Preset(NamedTuple):
    """One stiffness preset.

    Parameters
    ----------
    value : mean set-point, or half of the distance between the motors of an antagonistic joint.
    samples : in it.
    relative_percent : c of them; NaN where every torque is below the floor.
    below_floor : samples c leaves out.
    rms : of the residuals [N m].
    stiffness : mean of the fitted law's over them [N m/rad].
    """

    value: float
    samples: int
    relative_percent: float
    below_floor: int
    rms: float
    stiffness: float


def relative_rms_percent(torque: ArrayLike, fit: ArrayLike, floor: float = 0.0) -> float:
    """Return the relative rms error c of a characteristic in per cent (trumic2022 section V-A).

    ``100 sqrt(sum_j (tau_j - T_j)^2 / tau_j^2 / N)`` over the `N` samples whose ``|tau|`` is above
    the floor; the paper's formula has none, and is infinite where the torque passes through 0.
    NaN if there is no such sample.

    Parameters
    ----------
    torque : (N,) measured elastic torque [N m].
    fit : (N,) of the fitted law [N m].
    floor : [N m].

    >>> round(relative_rms_percent([1.0, -2.0, 0.001], [1.1, -2.2, 0.1], floor=0.01), 9)
    10.0
    """
    measured, fitted = np.asarray(torque, np.float64), np.asarray(fit, np.float64)
    told = np.abs(measured) > floor
    if not told.any():
        return math.nan
    off = (measured[told] - fitted[told]) / measured[told]
    return 100.0 * math.sqrt(float(np.mean(off * off)))


def presets_of(
    samples: Samples, torque: Array, fit: Array, stiffness: Array, floors: Array
) -> tuple[tuple[Preset, ...], NDArray[np.int64]]:
    """Score each preset; return them, and the preset of every sample.

    Parameters
    ----------
    samples : that were used.
    torque, fit : (signals, N) measured, without offsets, and fitted [N m].
    stiffness : (N,) of the fitted law [N m/rad].
    floors : (signals, 1) [N m].
    """
    group = _groups(samples.preset)
    found = []
    for k in range(int(group.max()) + 1):
        own = group == k
        if not own.any():
            continue
        below = np.abs(torque[:, own]) <= floors
        # A torque of its own floor: below it it counts as 0, above it as it is.
        told = np.where(below, 0.0, torque[:, own])
        found.append(
            Preset(
                value=float(np.mean(samples.preset[own])),
                samples=int(np.count_nonzero(own)),
                relative_percent=relative_rms_percent(told, fit[:, own]),
                below_floor=int(np.count_nonzero(below)),
                rms=float(np.sqrt(np.mean((torque - fit)[:, own] ** 2))),
                stiffness=float(np.mean(stiffness[own])),
            )
        )
    present = np.unique(group)
    return tuple(found), np.searchsorted(present, group).astype(np.int64)


def _groups(values: Array) -> NDArray[np.int64]:
    """Number the presets: levels where there are gaps between them, else equal parts."""
    span = float(np.ptp(values))
    if span <= _COUNTS:
        return np.zeros(len(values), dtype=np.int64)
    ordered = np.sort(values)
    gaps = np.flatnonzero(np.diff(ordered) > _APART * span)
    if 0 < len(gaps) < _GROUPS:
        edges = 0.5 * (ordered[gaps] + ordered[gaps + 1])
    else:
        edges = np.linspace(ordered[0], ordered[-1], _BINS + 1)[1:-1]
    return np.digitize(values, edges).astype(np.int64)
