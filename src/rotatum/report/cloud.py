"""What a characteristic rests on: points over the deflection, and how sure the law is there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.report.panel import Trace
from rotatum.report.part import Part

__all__ = ["by_deflection", "cloud", "deviation", "evenly"]

Array = NDArray[np.float64]
_CLOUD = 4000  # points shown of the data
_BINS = 60  # over the deflection, for the band and the truth


def cloud(name: str, phi: Array, torque: Array, colour: str, points: int = _CLOUD) -> Trace:
    """Return data as points.

    Parameters
    ----------
    name : in the legend.
    phi, torque : (K,) rad, N m; NaN is left out.
    colour : of the points.
    points : at most so many are shown.
    """
    there = evenly(phi, np.isfinite(phi) & np.isfinite(torque), points)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": (1e3 * phi[there]).astype(np.float32),
        "y": torque[there].astype(np.float32),
        "marker": {"size": 4, "color": colour, "opacity": 0.35},
        "hoverinfo": "skip",
    }


def evenly(phi: Array, good: NDArray[np.bool_], points: int) -> NDArray[np.intp]:
    """Return at most so many indices, evenly over the deflection rather than over time.

    So that rare deflections are seen.

    Parameters
    ----------
    phi : (K,) rad.
    good : (K,) which may be chosen.
    points : at most so many.
    """
    there = np.flatnonzero(good)
    if len(there) > points:
        along = there[np.argsort(phi[there], kind="stable")]
        there = along[np.linspace(0, len(along) - 1, points).astype(int)]
    return there


def deviation(part: Part, phi: Array, grid: Array) -> Array:
    """Return the standard deviation of the law's torque over a grid of deflections.

    Of a transmission among two only the stiffness' deviation is on record: the torque's is at most
    its integral from no deflection on.

    Parameters
    ----------
    part : the transmission.
    phi : (K,) deflection at each sample, rad, NaN where it tells nothing.
    grid : (G,) rad, increasing.
    """
    powers = part.shown.estimate.powers
    settled = np.where(part.shown.settled, phi, np.nan)
    phi = settled if np.isfinite(settled).any() else phi
    if [tuple(power) for power in powers] == [(1, 0)]:
        return np.abs(grid) * part.result.stiffness_std
    if not part.paired:
        return np.interp(grid, *by_deflection(phi, part.field("torque_std")))
    std = np.interp(grid, *by_deflection(phi, part.field("stiffness_std")))
    steps = 0.5 * (std[1:] + std[:-1]) * np.diff(grid)
    grown = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(np.abs(grown - np.interp(0.0, grid, grown)))


def by_deflection(phi: Array, values: Array) -> tuple[Array, Array]:
    """Return the latest value in each bin of the deflection that was visited, and where it was.

    Parameters
    ----------
    phi, values : (K,); NaN is left out, at least one is finite.
    """
    good = np.flatnonzero(np.isfinite(phi) & np.isfinite(values))
    edges = np.linspace(phi[good].min(), phi[good].max(), _BINS + 1)
    place = np.clip(np.digitize(phi[good], edges) - 1, 0, _BINS - 1)
    latest = np.full(_BINS, -1)
    latest[place] = good  # later samples overwrite earlier ones
    chosen = latest[latest >= 0]
    chosen = chosen[np.argsort(phi[chosen], kind="stable")]
    return phi[chosen], values[chosen]
