"""Fewer points that look the same: extremes survive."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["POINTS", "buckets", "thin", "thin_band", "thin_runs"]

POINTS = 4000  # per trace: twice the pixels of a wide plot

Array = NDArray[np.float64]


def thin(x: Array, y: Array, points: int = POINTS) -> tuple[Array, Array]:
    """Return at most `points` of a curve: the lowest and the highest of every bucket, in order.

    A bucket without a finite value keeps its gap.

    Parameters
    ----------
    x, y : (N,), x increasing; NaN in y is a gap.
    points : at most so many are left.
    """
    if len(x) <= points:
        return x, y
    chosen: list[int] = []
    for first, last in buckets(len(x), points // 2):
        part = y[first:last]
        finite = np.flatnonzero(np.isfinite(part))
        if not finite.size:
            chosen.append(first)
            continue
        low, high = finite[np.argmin(part[finite])], finite[np.argmax(part[finite])]
        chosen += [first + int(k) for k in sorted({int(low), int(high)})]
    return x[chosen], y[chosen]


def thin_band(x: Array, low: Array, high: Array, points: int = POINTS) -> tuple[Array, ...]:
    """Return a band on fewer points: per bucket its lowest low and its highest high.

    Parameters
    ----------
    x, low, high : (N,); NaN is a gap.
    points : at most so many are left.
    """
    if len(x) <= points:
        return x, low, high
    edges = buckets(len(x), points)
    starts = [first for first, _ in edges]
    lowest = np.fmin.reduceat(low, starts)
    highest = np.fmax.reduceat(high, starts)
    return x[starts], lowest, highest


def thin_runs(x: Array, levels: NDArray[np.int64], points: int = POINTS) -> tuple[Array, Array]:
    """Return the runs of equal levels: their (R + 1,) edges in x and their (R,) levels.

    Where there are more than `points` runs, every bucket shows the level it has most often.

    Parameters
    ----------
    x, levels : (N,), N >= 1.
    points : at most so many runs are left.
    """
    starts = np.concatenate([[0], 1 + np.flatnonzero(np.diff(levels))])
    if len(starts) > points:
        edges = buckets(len(x), points)
        common = [int(np.bincount(levels[first:last]).argmax()) for first, last in edges]
        return thin_runs(x[[first for first, _ in edges]], np.array(common), points)
    end = x[-1] if x[-1] > x[starts[-1]] else x[starts[-1]] + 1e-9
    return np.concatenate([x[starts], [end]]), levels[starts].astype(np.float64)


def buckets(count: int, number: int) -> list[tuple[int, int]]:
    """Return `number` consecutive ranges of nearly equal length that cover `count` indices.

    Parameters
    ----------
    count : of indices.
    number : of ranges, at most `count`.
    """
    edges = np.linspace(0, count, min(number, count) + 1).astype(int)
    return list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
