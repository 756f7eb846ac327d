"""Spells of rest in a log: motors still, and accelerometers as quiet as they ever are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.full_state.rest import links_at_rest
from rotatum.models.joint import Joint
from rotatum.models.robot.interface import Robot

__all__ = ["Poses", "poses_at_rest", "rest_spells"]

Array = NDArray[np.float64]

_WINDOW = 0.05  # s, over which motors and readings must be quiet
_SAMPLES = 51  # at least, in it
_QUIET = 3.0  # times the quietest tenth's variance: noise of 51 samples is above once in 1e6
_QUIETEST = 0.1
_CORRELATED = 10  # samples a vibration left over may last beyond what its window shows


class Poses(NamedTuple):
    """Static poses found in a log.

    Args:
        spells: rows of the log, pose by pose.
        q: (K, n) rad, links, by springs and weight.
        readings: (K, M) m/s^2, means.
        std: (K, M) m/s^2, of these means.
    """

    spells: tuple[slice, ...]
    q: Array
    readings: Array
    std: Array


def rest_spells(
    theta: Array,
    readings: Array,
    period: float,
    *,
    still: float = 1e-4,
    shortest: float = 0.2,
) -> tuple[slice, ...]:
    """Find where the arm rests: rows of the log, longest stretches without a break.

    A sample counts where, over 50 ms and at least 51 samples around it, each motor stays within
    `still` and each reading's variance is at most three times that of the quietest tenth of where
    motors are still. In a log that is nowhere quiet that is a vibration, to be averaged away.

    Args:
        theta: (N, n) rad, motors at the joint side.
        readings: (N, M) m/s^2; a NaN is no rest.
        period: s.
        still: rad.
        shortest: s, of a spell.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

    size = max(_SAMPLES, round(_WINDOW / period) | 1)
    if len(theta) < size:
        return ()
    travel = maximum_filter1d(theta, size, axis=0) - minimum_filter1d(theta, size, axis=0)
    good = np.logical_and.reduce(np.isfinite(np.column_stack([readings, theta])), axis=1)
    filled = np.where(good[:, None], readings, 0.0)
    filled = filled - filled.mean(axis=0)
    mean = uniform_filter1d(filled, size, axis=0)
    variance = np.maximum(uniform_filter1d(filled**2, size, axis=0) - mean**2, 0.0)
    unmoved = np.logical_and((travel <= still).all(axis=1), good)
    if not unmoved.any():
        return ()
    quiet = variance <= _QUIET * np.quantile(variance[unmoved], _QUIETEST, axis=0) + 1e-12
    return _stretches(unmoved & quiet.all(axis=1), max(1, round(shortest / period)))


def poses_at_rest(
    robot: Robot,
    joints: Sequence[Joint],
    theta: Array,
    readings: Array,
    period: float,
    *,
    still: float = 1e-4,
    shortest: float = 0.2,
) -> Poses:
    """Return the static poses of a log, links by `links_at_rest`.

    Spells whose rest is not trustworthy are left out.

    Args:
        robot, joints: the arm, and its joints with transmission laws; antagonistic joints have
            two motors and are not for this function.
        theta: (N, n) rad, motors at the joint side.
        readings: (N, M) m/s^2.
        period: s.
        still, shortest: as of `rest_spells`.
    """
    kept, q, means, stds = [], [], [], []
    for spell in rest_spells(theta, readings, period, still=still, shortest=shortest):
        rest = links_at_rest(robot, joints, theta[spell].mean(axis=0))
        if not rest.trustworthy:
            continue
        shown = readings[spell]
        kept.append(spell)
        q.append(rest.q)
        means.append(shown.mean(axis=0))
        stds.append(_deviation_of_mean(shown))
    n, m = theta.shape[1], readings.shape[1]
    return Poses(
        tuple(kept),
        np.reshape(q, (-1, n)),
        np.reshape(means, (-1, m)),
        np.reshape(stds, (-1, m)),
    )


def _deviation_of_mean(x: Array) -> Array:
    """Return the standard deviation of means of (K, M), from means of blocks: noise has colour."""
    blocks = max(2, min(_CORRELATED, len(x) // 2))
    length = len(x) // blocks
    means = x[: blocks * length].reshape(blocks, length, -1).mean(axis=1)
    white = x.std(axis=0) / np.sqrt(len(x))
    deviation: Array = np.maximum(white, means.std(axis=0, ddof=1) / np.sqrt(blocks))
    return deviation


def _stretches(yes: NDArray[np.bool_], shortest: int) -> tuple[slice, ...]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], yes, [False]]).astype(np.int8)))
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return tuple(slice(int(a), int(b)) for a, b in pairs if b - a >= shortest)
