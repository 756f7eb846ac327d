"""Values between samples: cubic, straight and held."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Place(NamedTuple):
    """Instants between samples.

    Parameters
    ----------
    left : (K,) sample before each, below zero before the first.
    part : (K,) share of the way to the next sample, in [0, 1).
    """

    left: NDArray[np.int64]
    part: Array


def cubic(x: Array, dx: Array, place: Place, period: float) -> tuple[Array, Array]:
    """Return value and slope (K,) of the cubic Hermite through samples (N,) with slopes dx."""
    i, j = _ends(x, place)
    u, v = place.part, 1.0 - place.part
    value = v * v * ((1 + 2 * u) * x[i] + u * period * dx[i])
    value += u * u * ((1 + 2 * v) * x[j] - v * period * dx[j])
    slope = 6 * u * v * (x[j] - x[i]) / period
    slope += v * (v - 2 * u) * dx[i] + u * (u - 2 * v) * dx[j]
    before_start = place.left < 0
    return np.where(before_start, x[0], value), np.where(before_start, 0.0, slope)


def straight(x: Array, dx: Array, place: Place, period: float) -> tuple[Array, Array]:
    """Return value and slope (K,) of the lines between samples (N,); dx is not looked at."""
    i, j = _ends(x, place)
    value = (1.0 - place.part) * x[i] + place.part * x[j]
    before_start = place.left < 0
    slope = np.where(before_start, 0.0, (x[j] - x[i]) / period)
    return np.where(before_start, x[0], value), slope


def held_at(x: Array, place: Place) -> Array:
    """Return samples (N,) held until the next one, (K,); zero before the first."""
    return np.where(place.left >= 0, x[np.maximum(place.left, 0)], 0.0)


def _ends(x: Array, place: Place) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    i = np.maximum(place.left, 0)
    return i, np.minimum(i + 1, x.size - 1)
