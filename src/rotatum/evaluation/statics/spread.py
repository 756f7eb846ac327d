"""How sure the constants are, with residuals that are coloured, and which cannot be told apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.metrics import Z95
from rotatum.evaluation.statics.fitting import Fit
from rotatum.evaluation.statics.model import Cells, Model

__all__ = ["SHAPE", "Spread", "correlation", "spread_of"]

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

SHAPE = 0.02
"""Share of the samples: residuals that stay alike for longer are a misfit and not noise."""
_BLOCKS = 40  # of time; each then outlasts a sweep's share of it
_STARVED = 0.5  # of a value that half its interval may be, as for the verdict starved
_FLAT = 1e-13  # information of a direction whose columns cancel to rounding, of 1 each
_NOTHING = 1e8  # variance there, in columns of norm 1: more than any that data give


class Spread(NamedTuple):
    """Covariance of the fitted vector.

    Parameters
    ----------
    covariance : (c, c) of the constants' entries; of positive ones relative.
    nuisance : (n,) standard deviation of the nuisances' entries; infinite where nothing tells.
    told : (c,) whether the data tell each constant.
    times : (signals,) samples over which residuals stay alike; 1 for white noise.
    """

    covariance: Array
    nuisance: Array
    told: NDArray[np.bool_]
    times: tuple[float, ...]


def spread_of(model: Model, cells: Cells, found: Fit, residual: Array, starts: Whole) -> Spread:
    """Return how sure the constants are.

    The information of the nuisances is taken out of the constants' columns first (Frisch and
    Waugh), so that two nuisances which cannot be told apart do no harm. Then the larger of two
    deviations for each constant: least squares' own times the root of the residuals' integrated
    autocorrelation, and that of the scores summed over 40 blocks of time, which also sees
    residuals that differ from preset to preset. A constant is told if half of its interval is at
    most half of its value; what the misfit of a wrong law adds widens the interval, but does not
    make it untold.

    Parameters
    ----------
    model, cells, found : what was fitted to what, and the result.
    residual : (signals, N) of every sample [N m].
    starts : (C,) first sample of each cell.
    """
    many = len(model.constants)
    times = tuple(correlation(each) for each in residual)
    weight = np.sqrt(np.tile(cells.samples, len(residual)))
    white = _grown(residual, times, cells, len(found.u)) / model.scales.torque
    summed = np.add.reduceat(residual, starts, axis=1).ravel() / model.scales.torque
    blocks = np.floor(starts * (_BLOCKS / residual.shape[1])).astype(np.int64)
    inner = (weight, white, summed, np.tile(blocks, len(residual)))
    constants, others = found.jacobian[:, :many], found.jacobian[:, many:]
    covariance = _covariance(constants, others, *inner)
    nuisance = np.sqrt(np.diag(_covariance(others, constants, *inner)))
    # A sensor's filter takes information away; the shape of a wrong law does not.
    noise = tuple(time if time < SHAPE * residual.shape[1] else 1.0 for time in times)
    alone = _grown(residual, noise, cells, len(found.u)) / model.scales.torque
    std = np.sqrt(np.diag(_covariance(constants, others, weight, alone, 0.0 * summed, inner[3])))
    # What a deviation of a constant of either sign does to the torque; 1 is the torque's rms.
    size = np.sqrt(np.mean((constants / weight[:, None]) ** 2, axis=0))
    signed = np.array([not each.positive for each in model.constants])
    bounds = np.array([each.bound for each in model.constants])
    inside = np.abs(found.u[:many]) < 0.999 * bounds
    told = (Z95 * std * np.where(signed, size, 1.0) <= _STARVED) & inside
    return Spread(covariance, nuisance, told, times)


def correlation(residual: Array) -> float:
    """Return the integrated autocorrelation time in samples, at least 1.

    ``1 + 2 sum rho(k)``, summed in pairs of lags as long as they are positive (Geyer 1992).

    Parameters
    ----------
    residual : (N,).
    """
    off = residual - residual.mean()
    size = 1 << (2 * len(off) - 1).bit_length()
    power = np.abs(np.fft.rfft(off, size)) ** 2
    lags = np.fft.irfft(power, size)[: len(off)]
    if not lags[0] > 0.0:
        return 1.0
    pairs = lags[: len(off) // 2 * 2].reshape(-1, 2).sum(axis=1) / lags[0]
    ended = np.flatnonzero(pairs <= 0.0)
    until = int(ended[0]) if ended.size else len(pairs)
    return max(1.0, float(2.0 * pairs[:until].sum() - 1.0))


def _grown(residual: Array, times: tuple[float, ...], cells: Cells, fitted: int) -> Array:
    """Deviation of a sample as if samples were white, of each row, (signals C,) [N m].

    N samples are worth N over the correlation time; of those the fitted numbers use up theirs.
    """
    worth = residual.shape[1] / np.array(times)
    left = worth / np.maximum(1.0, worth - fitted)
    each = np.sqrt(np.mean(residual**2, axis=1) * times * left)
    return np.repeat(each, len(cells.samples))


def _covariance(
    columns: Array, others: Array, weight: Array, white: Array, summed: Array, blocks: Whole
) -> Array:
    if not columns.shape[1]:
        return np.zeros((0, 0))
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    unit = (columns - _onto(others, columns)) / size
    values, vectors = np.linalg.eigh(unit.T @ unit)
    flat = values <= _FLAT
    inverse = vectors[:, ~flat] @ np.diag(1.0 / values[~flat]) @ vectors[:, ~flat].T
    own = inverse @ (unit.T * white**2) @ unit @ inverse
    scores = np.zeros((_BLOCKS, columns.shape[1]))
    np.add.at(scores, blocks, unit / weight[:, None] * summed[:, None])
    filled = len(np.unique(blocks))
    small = filled / max(1, filled - columns.shape[1])
    blocked = small * inverse @ (scores.T @ scores) @ inverse
    told = np.diag(own)
    up = np.sqrt(np.maximum(1.0, np.diag(blocked) / np.where(told > 0.0, told, np.inf)))
    grown: Array = own * np.outer(up, up) + _NOTHING * vectors[:, flat] @ vectors[:, flat].T
    scaled: Array = grown / np.outer(size, size)
    return scaled


def _onto(others: Array, columns: Array) -> Array:
    """Share of the columns that the others explain."""
    if not others.shape[1]:
        return np.zeros_like(columns)
    size = np.linalg.norm(others, axis=0)
    basis, values, _ = np.linalg.svd(others / np.where(size > 0.0, size, 1.0), full_matrices=False)
    basis = basis[:, values > 1e-7 * values[0]]
    shared: Array = basis @ (basis.T @ columns)
    return shared
