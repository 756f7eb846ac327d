"""A serial joint's set-point in words, and where its characteristic is cut."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.report.view import View

__all__ = ["Axis", "Slice", "moves", "setpoint_axis", "slices"]

Array = NDArray[np.float64]
_NEAR = 0.04  # of the visited range, to either side of a slice: the data shown with it
_STILL = 0.01  # of the declared range: a set-point that moves less has one characteristic


class Axis(NamedTuple):
    """How set-points are written.

    Parameters
    ----------
    title : with the unit.
    unit : short.
    factor : on values in the unit of the law.
    """

    title: str
    unit: str
    factor: float


class Slice(NamedTuple):
    """A set-point at which the characteristic is shown.

    Parameters
    ----------
    setpoint : in the unit of the law.
    name : in the legend.
    near : (K,) which samples were near it.
    """

    setpoint: float
    name: str
    near: NDArray[np.bool_]


def setpoint_axis(shown: View) -> Axis:
    """Return how a joint's set-points are written: a length in mm, an angle in rad.

    Parameters
    ----------
    shown : the joint.
    """
    unit, factor = ("mm", 1e3) if shown.setpoint_unit == "m" else (shown.setpoint_unit, 1.0)
    return Axis(f"set-point s, {unit}", unit, factor)


def moves(shown: View) -> bool:
    """Return whether the law depends on the set-point, and the set-point moved.

    Parameters
    ----------
    shown : the joint.
    """
    setpoint, limits = shown.setpoint, shown.joint.basis.setpoint_range
    if setpoint is None or limits is None or not shown.joint.basis.setpoint_orders:
        return False
    there = setpoint[shown.known & np.isfinite(setpoint)]
    return bool(there.size and np.ptp(there) > _STILL * (limits[1] - limits[0]))


def slices(shown: View, setpoint: Array) -> list[Slice]:
    """Return slices at a low, the middle and a high set-point of those visited.

    Parameters
    ----------
    shown : the joint.
    setpoint : (K,) at each sample, NaN where it tells nothing.
    """
    axis = setpoint_axis(shown)
    low, high = float(np.nanmin(setpoint)), float(np.nanmax(setpoint))
    width = high - low
    places = (low + _NEAR * width, low + 0.5 * width, high - _NEAR * width)
    return [
        Slice(s, f"s = {axis.factor * s:.3g} {axis.unit}", np.abs(setpoint - s) <= _NEAR * width)
        for s in places
    ]
