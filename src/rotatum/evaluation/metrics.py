"""How well an estimate meets a known truth: errors and coverage, whole or in pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Z95 = 1.96


def mse(sigma: ArrayLike, truth: ArrayLike) -> float:
    """Return the mean square error [square of the stiffness unit], flacco2012 eq. 45.

    ``sum_k (truth(k) - sigma(k))^2 / n`` over the `n` samples where both are finite; the paper
    divides its p + 1 terms by p. NaN if there is no such sample.

    >>> mse([99.0, 103.0, float("nan")], 100.0)
    5.0
    """
    return _score(sigma, np.nan, truth)["mse"]


def msrep_percent(sigma: ArrayLike, truth: ArrayLike) -> float:
    """Return the mean square relative error in per cent, flacco2012 eq. 46.

    ``100 sum_k ((truth(k) - sigma(k)) / truth(k))^2 / n`` over the `n` samples where both are
    finite and the truth is not zero. A relative error of 1 % throughout gives 0.01.

    >>> round(msrep_percent([99.0, 103.0], 100.0), 12)
    0.05
    """
    return _score(sigma, np.nan, truth)["msrep_percent"]


def coverage_percent(sigma: ArrayLike, std: ArrayLike, truth: ArrayLike, z: float = Z95) -> float:
    """Return how often the truth lies within `z` standard deviations, in per cent.

    Counted over the samples where estimate and truth are finite and `std` is not NaN; an
    infinite `std` covers. NaN if there is no such sample.

    >>> coverage_percent([99.0, 103.0], [1.0, 1.0], 100.0)
    50.0
    """
    return _score(sigma, std, truth, z)["coverage_percent"]


class TruthScore:
    """The three scores, accumulated piece by piece: a log need not fit into memory.

    >>> score = TruthScore()
    >>> score.update([99.0, 101.0], [1.0, 1.0], 100.0)
    >>> score.update([103.0], [1.0], [100.0])
    >>> [round(value, 6) for value in score.result().values()]
    [3.666667, 0.036667, 66.666667]

    Parameters
    ----------
    z
        Half width of the interval, in standard deviations.
    """

    def __init__(self, z: float = Z95) -> None:
        self.z = z
        self._samples = 0
        self._squares = 0.0
        self._relative_samples = 0
        self._relative_squares = 0.0
        self._interval_samples = 0
        self._covered = 0

    @property
    def samples(self) -> int:
        """Samples scored so far."""
        return self._samples

    def update(self, sigma: ArrayLike, std: ArrayLike, truth: ArrayLike) -> None:
        """Add samples: estimate, its standard deviation, truth; (N,) each or scalars."""
        estimate, spread, true = _broadcast(sigma, std, truth)
        known = np.isfinite(estimate) & np.isfinite(true)
        error = (true - estimate)[known]
        true, spread = true[known], spread[known]
        self._samples += error.size
        self._squares += float(np.sum(error * error))
        relative = error[true != 0.0] / true[true != 0.0]
        self._relative_samples += relative.size
        self._relative_squares += float(np.sum(relative * relative))
        stated = ~np.isnan(spread)
        self._interval_samples += int(np.count_nonzero(stated))
        self._covered += int(np.count_nonzero((np.abs(error) <= self.z * spread) & stated))

    def result(self) -> dict[str, float]:
        """Return ``mse``, ``msrep_percent`` and ``coverage_percent`` so far (NaN: no sample)."""
        return {
            "mse": _ratio(self._squares, self._samples),
            "msrep_percent": 100.0 * _ratio(self._relative_squares, self._relative_samples),
            "coverage_percent": 100.0 * _ratio(self._covered, self._interval_samples),
        }


def _score(sigma: ArrayLike, std: ArrayLike, truth: ArrayLike, z: float = Z95) -> dict[str, float]:
    score = TruthScore(z)
    score.update(sigma, std, truth)
    return score.result()


def _broadcast(*values: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    return np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values))


def _ratio(total: float, count: int) -> float:
    return total / count if count else float("nan")
