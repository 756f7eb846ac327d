"""What a design costs and gives: noise, bandwidth, samples to settle, from its matrices."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.system import System

Array = NDArray[np.float64]
SETTLED = 1e-6  # share of the start's error, in units of the outputs, that is left
_LOWEST = 1e-3  # rad per sample; below, plants with integrators drown in rounding
_LONGEST = 100_000  # samples


class Figures(NamedTuple):
    """Figures of one design.

    Args:
        noise_gain: (m,) variance of each input's estimate per unit variance of white noise on
            every output.
        bandwidth: (m,) where each input's estimate is 3 dB down [rad/s]; the Nyquist frequency
            where it never is, as in every exact design.
        settle: steps after the first full window until 1e-6 of the start's error is left.
        lag: samples by which estimates come late.
    """

    noise_gain: Array
    bandwidth: Array
    settle: int
    lag: int


def figures(given: System, recursion: Recursion, period: float) -> Figures:
    """Compute the figures of a design; nothing is simulated.

    Args:
        given: the observed system.
        recursion: with ``out = (states, inputs)``.
        period: T [s].
    """
    m = given.sizes[1]
    noise = np.diag(recursion.noise())[-m:].copy()
    bandwidth = [fallen(partial(_through, given, recursion, j)) / period for j in range(m)]
    return Figures(noise, np.array(bandwidth), settle(recursion), recursion.lag)


def fallen(gain: Callable[[Array], Array], lowest: float = _LOWEST) -> float:
    """Lowest angle [rad per sample] where a gain is below 1 / sqrt 2; pi: nowhere, 0: everywhere.

    Args:
        gain: of an array of angles.
        lowest: the first angle looked at.
    """
    angles = np.geomspace(lowest, math.pi, 2000)
    for _ in range(2):
        below = np.flatnonzero(gain(angles) < math.sqrt(0.5))
        if len(below) == 0:
            return math.pi
        last = below[0]
        if last == 0:
            return 0.0
        angles = np.linspace(angles[last - 1], angles[last], 200)
    return float(angles[-1])


def settle(recursion: Recursion, share: float = SETTLED) -> int:
    """Steps until an error of the state is forgotten, whatever the units.

    ``|G E^k|``, its columns in units of what a unit of output does to each state, its rows in
    those of what it does to each estimate.

    Args:
        recursion: a design.
        share: of the start's error that may be left.
    """
    whole = recursion._replace(
        G=np.vstack([recursion.G, np.eye(len(recursion.E))]),
        K=np.vstack([recursion.K, np.zeros_like(recursion.F)]),
    )
    size = np.abs(whole.impulse(recursion.window + len(recursion.E))).max(axis=(0, 2))
    o = len(recursion.G)
    rows = np.where(size[:o] > 0.0, size[:o], 1.0)
    left = recursion.G.copy()
    last = 0
    for k in range(_LONGEST):
        if (np.abs(left) * size[o:] / rows[:, None]).max() > share:
            last = k + 1
        elif k > last + len(recursion.E):
            break
        left = left @ recursion.E
    return last


def _through(given: System, recursion: Recursion, j: int, angles: Array) -> Array:
    """Gain from input j to its estimate."""
    A, B, C, D = given
    z = np.exp(1j * angles)[:, None, None]
    plant = C @ np.linalg.solve(z * np.eye(len(A)) - A, np.tile(B[:, [j]], (len(angles), 1, 1)))
    seen = recursion.response(angles)[:, [len(recursion.G) - B.shape[1] + j], :]
    return np.asarray(np.abs(seen @ (plant + D[:, [j]]))[:, 0, 0])
