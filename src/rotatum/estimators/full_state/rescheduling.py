"""How fast a stiffness may change under the observer without undoing its stability."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.full_state.poles import DEFAULT, Pairs, discretise, error_matrix

Array = NDArray[np.float64]

_HALVED = 1e-6  # relative accuracy of the rate, found by halving
_POWERS = (4.0, 16.0, 64.0)
_SINGULAR = 1e3  # logarithm; every Q that is one gives less


class Schedule(NamedTuple):
    """A rate below which the error of a rescheduled observer dies away, and what proves it.

    Args:
        rate: [1/s]; the stiffness may change by up to exp(+- rate T) from sample to sample, in any
            order.
        lyapunov: (4, 4) P of ``V = e^T P e``, e the error of the kernel's w in coordinates
            ``w_i / unit^(i - 1)``.
        unit: [rad/s].
    """

    rate: float
    lyapunov: Array
    unit: float

    def value(self, error: Array) -> Array:
        """V of errors of w, (..., 4)."""
        scaled = error / self.unit ** np.arange(4)
        return np.asarray(np.einsum("...i,ij,...j->...", scaled, self.lyapunov, scaled))


def rescaling(ratio: float, relaxation: float = 0.0) -> Array:
    """(4, 4) what a stiffness times ``ratio`` does to w, where q and q' stay.

    Args:
        ratio: new stiffness over old.
        relaxation: damping of the spring over the old stiffness, D / K [s].
    """
    R = np.diag([1.0, 1.0, ratio, ratio])
    R[2, 3] = (1.0 - ratio) * relaxation
    return R


def largest_relative_rate(
    period: float,
    pairs: Pairs = DEFAULT,
    *,
    gyro: float = 0.0,
    relaxation: float = 0.0,
) -> Schedule:
    """Bound |K'/K| such that the observer's error still dies away, by a quadratic function.

    Between samples the error of w obeys ``e' = A e``, ``A`` of the poles alone; a new stiffness
    multiplies it by ``R(r)``, r the ratio. V decreases from sample to sample if
    ``R^T Phi^T P Phi R < P``. R is a straight line in r and in D/K, and V convex: what holds at the
    ends of their ranges holds between. P is sought over ``A^T P + P A = -Q``, Q through its
    Cholesky factor: the bound is proved, that it is the largest of its kind is not.

    Args:
        period: T [s].
        pairs: poles of the error.
        gyro: gain of a gyroscope [1/s].
        relaxation: largest D / K the joint will have [s].

    Raises:
        MethodError: poles that are not stable or too fast, or a negative relaxation.
    """
    from scipy.linalg import eigh

    if not (math.isfinite(relaxation) and relaxation >= 0.0):
        raise MethodError("must be 0 or more", where="relaxation", value=relaxation)
    unit = math.sqrt(pairs[0].frequency * pairs[1].frequency)
    scale = unit ** np.arange(4)
    transition = discretise(pairs, period, gyro).transition * scale / scale[:, None]
    A = error_matrix(pairs, gyro) * scale / scale[:, None] / unit
    ends = (0.0, relaxation * unit) if relaxation > 0.0 else (0.0,)
    rates = [rescaling(2.0, end) - np.eye(4) for end in ends]

    P = _solution(A, _sought(A, rates))[1]

    def holds(change: float) -> bool:
        shrinks = [
            transition @ (np.eye(4) + (math.exp(sign * change) - 1.0) * N)
            for N in rates
            for sign in (-1.0, 1.0)
        ]
        return all(eigh(S.T @ P @ S, P, eigvals_only=True)[-1] < 1.0 for S in shrinks)

    low, high = 0.0, 1.0
    while high - low > _HALVED * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return Schedule(low / period, P, unit)


def _sought(A: Array, rates: list[Array]) -> Array:
    """(10,) parameters of the Q whose V bears the fastest change, in continuous time.

    What is minimised is the largest of the eigenvalues of ``N^T P + P N`` against Q, through
    p-norms that come ever closer to it: it has kinks, which no descent gets around.
    """
    from scipy.linalg import eigh
    from scipy.optimize import minimize

    def size(parameters: Array, power: float) -> float:
        Q, P = _solution(A, parameters)
        try:
            values = np.concatenate([eigh(N.T @ P + P @ N, Q, eigvals_only=True) for N in rates])
        except np.linalg.LinAlgError:
            return _SINGULAR  # a step so far out that Q has no factor in floating point
        largest = np.abs(values).max()
        return float(np.log(largest) + np.log(np.sum((np.abs(values) / largest) ** power)) / power)

    best = np.zeros(10)
    for power in _POWERS:
        best = minimize(size, best, args=(power,), method="BFGS").x
    return best


def _solution(A: Array, parameters: Array) -> tuple[Array, Array]:
    """Q from its factor, the logarithms of its diagonal, and P of ``A^T P + P A = -Q``."""
    from scipy.linalg import solve_continuous_lyapunov

    L = np.zeros((4, 4))
    L[np.tril_indices(4)] = parameters
    L[np.diag_indices(4)] = np.exp(np.clip(np.diag(L), -15.0, 15.0))
    Q = L @ L.T
    return Q, np.asarray(solve_continuous_lyapunov(A.T, -Q))
