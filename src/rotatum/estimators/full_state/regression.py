"""Least squares of an accelerometer's errors, with a prior and for correlated residuals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import check_names
from rotatum.models.rotations import rotation_about

__all__ = ["NAMES", "PRIOR", "TOLD", "Errors", "fit_readings", "fitted_mask"]

Array = NDArray[np.float64]

_KINDS = ("bias",) * 3 + ("misalignment",) * 3 + ("scale",) * 3 + ("delay",)
NAMES = tuple(f"{kind} {axis}".strip() for kind, axis in zip(_KINDS, (*"xyz" * 3, ""), strict=True))
"""Names of the ten parameters."""
PRIOR = np.array([1.0] * 3 + [0.1] * 3 + [0.05] * 3 + [0.05])
"""Standard deviations before any data: m/s^2, rad, 1, s. Five times a careless mounting's."""
PRIOR.flags.writeable = False
TOLD = 0.1
"""A parameter is told when its deviation is below this part of the prior's."""

_STEPS = 12  # each leaves a part of about the misalignment, 0.1 at most
_CLOSE = 1e-10  # of the prior's deviation


class Errors(NamedTuple):
    """Errors of an accelerometer.

    Args:
        values: (10,), as `NAMES`.
        covariance: (10, 10).
        residual: rms [m/s^2].
    """

    values: Array
    covariance: Array
    residual: float


def fitted_mask(fit: Sequence[str], allowed: Sequence[str]) -> NDArray[np.bool_]:
    """Return which of the ten are fitted, of kinds of parameters.

    Raises:
        RotatumError: a kind that is not allowed.
    """
    check_names(fit, tuple(allowed), what="no such error of an accelerometer", where="fit")
    return np.array([kind in fit for kind in _KINDS])


def fit_readings(
    force: Callable[[float], tuple[Array, Array]],
    readings: Array,
    std: Array,
    axes: Sequence[int],
    fitted: NDArray[np.bool_],
    mean: Array,
    covariance: Array,
    *,
    colour: Array | None,
) -> Errors:
    """Fit ``y = (1 + s) * R(e)^T f(t - delay) + b`` by Gauss and Newton's steps.

    The deviation of the readings is taken as given at first; where more is left than that, it is
    raised to what is left. A parameter that is not fitted keeps the prior's mean.

    Args:
        force: of a delay [s] to the specific force f and its rate, (K, 3) each.
        readings: (K, A) m/s^2.
        std: (K, A) m/s^2.
        axes: (A,) which of x, y, z they are.
        fitted: (10,).
        mean, covariance: (10,), (10, 10), before these readings.
        colour: (L,) autocorrelation of the readings' noise, from 1 on; None: it is white. The
            deviations are those of such noise, or those that the residuals themselves ask for over
            L lags (Newey and West 1987) where these are larger: the second alone is too small by a
            tenth to a quarter in logs of a few seconds.
    """
    scale: Array = np.ones(readings.shape[1])
    where = np.flatnonzero(fitted)
    known = np.asarray(np.linalg.inv(covariance[np.ix_(where, where)]), dtype=np.float64)
    x = mean.copy()
    for _ in range(2):  # with the deviations given, then with those met
        for _ in range(_STEPS):
            left, slopes = _linear(force, readings, x, axes, where)
            left /= std * scale
            slopes /= (std * scale)[:, :, None]
            matrix = np.einsum("kai,kaj->ij", slopes, slopes) + known
            gradient = np.einsum("kai,ka->i", slopes, left) + known @ (mean - x)[where]
            step = np.linalg.solve(matrix, gradient)
            x[where] += step
            if (np.abs(step) < _CLOSE * PRIOR[where]).all():
                break
        left, slopes = _linear(force, readings, x, axes, where)
        excess: Array = np.sqrt(np.sum((left / std) ** 2, axis=0) / _freedom(left, len(where)))
        scale = np.maximum(1.0, excess)
    rms = float(np.sqrt(np.mean(left**2)))
    slopes /= (std * scale)[:, :, None]
    left /= std * scale
    found = covariance.copy()
    found[where], found[:, where] = 0.0, 0.0
    found[np.ix_(where, where)] = _covariance(slopes, left, known, colour)
    return Errors(x, found, rms)


def _covariance(slopes: Array, left: Array, known: Array, colour: Array | None) -> Array:
    """Return the fitted parameters' covariance, of slopes and residuals over their deviation."""
    white = np.einsum("kai,kaj->ij", slopes, slopes)
    inverse = np.linalg.inv(white + known)
    if colour is None:
        return inverse
    by_noise = white.copy()
    for lag in range(1, min(len(colour), len(slopes))):
        across = colour[lag] * np.einsum("kai,kaj->ij", slopes[lag:], slopes[:-lag])
        by_noise += across + across.T
    expected = inverse @ (by_noise + known) @ inverse
    by_rest = _long_run(np.einsum("kai,ka->ki", slopes, left), len(colour) - 1)
    met = inverse @ (by_rest + known) @ inverse
    more = np.sqrt(np.maximum(1.0, np.diag(met) / np.diag(expected)))
    widened: Array = expected * more * more[:, None]
    return widened


def _freedom(left: Array, count: int) -> float:
    """Return the rows of an axis less its part of the parameters, 1 at least."""
    rows, axes = left.shape
    return max(1.0, int(rows) - count / int(axes))


def _linear(
    force: Callable[[float], tuple[Array, Array]],
    readings: Array,
    x: Array,
    axes: Sequence[int],
    where: NDArray[np.intp],
) -> tuple[Array, Array]:
    """Return what is left of the readings (K, A), and their slopes by the fitted (K, A, p)."""
    turn, gain = rotation_about(x[3:6]), 1.0 + x[6:9]
    f, rate = (each @ turn for each in force(float(x[9])))
    slopes = np.zeros((len(f), 3, len(NAMES)))
    slopes[:, [0, 1, 2], [0, 1, 2]] = 1.0
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # f x e
        slopes[:, i, 3 + k], slopes[:, i, 3 + j] = gain[i] * f[:, j], -gain[i] * f[:, k]
        slopes[:, i, 6 + i] = f[:, i]
    slopes[:, :, 9] = -gain * rate
    left = readings - (gain * f + x[:3])[:, axes]
    return left, slopes[:, axes][:, :, where]


def _long_run(scores: Array, lags: int) -> Array:
    """Return the covariance of a sum of correlated scores (K, p), Bartlett's weights."""
    whole = scores.T @ scores
    for lag in range(1, min(lags, len(scores) - 1) + 1):
        across = (1.0 - lag / (lags + 1.0)) * scores[lag:].T @ scores[:-lag]
        whole += across + across.T
    return whole
