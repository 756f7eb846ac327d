"""Steady-state Kalman filter with a fixed lag, as a recursion over a window of outputs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.recursion import Recursion, stable_sum

Array = NDArray[np.float64]
_DOUBLINGS = 40
_EPS = 2.0**-52


class Steady(NamedTuple):
    """A Kalman filter in its steady state, ``x(k+1|k) = A x(k|k-1) + gain e(k)``.

    Args:
        P: covariance of the prediction error.
        S: covariance of the innovation ``e = y - C x``.
        gain: A P C^T S^-1.
        closed: A - gain C.
    """

    P: Array
    S: Array
    gain: Array
    closed: Array


def steady_filter(A: Array, C: Array, Q: Array, R: Array) -> Steady:
    """Solve the Riccati equation of ``x+ = A x + w``, ``y = C x + v``; cov w = Q, cov v = R.

    By doubling (Anderson 1978; Chu, Fan, Lin 2004), which is indifferent to the units of the
    states, then one step of Newton's method (Kleinman 1968) against the rounding of slow filters.

    Raises:
        MethodError: a mode that does not decay is not seen by the outputs, or not driven by Q.
    """
    P = _doubled(A, C.T @ np.linalg.solve(R, C), Q)
    if not np.isfinite(P).all():
        raise MethodError(
            "no steady Kalman filter: a mode that does not decay is not seen by the outputs",
            where="observer design",
        )
    gain = _gain(A, C, P, R)
    try:
        P = stable_sum(A - gain @ C, Q + gain @ R @ gain.T)
    except MethodError:
        raise MethodError(
            "no steady Kalman filter: a mode that does not decay is not seen by the outputs, or "
            "not driven",
            where="observer design",
        ) from None
    P = 0.5 * (P + P.T)
    gain = _gain(A, C, P, R)
    return Steady(P, C @ P @ C.T + R, gain, A - gain @ C)


def _gain(A: Array, C: Array, P: Array, R: Array) -> Array:
    return np.asarray(np.linalg.solve(C @ P @ C.T + R, C @ P @ A.T).T, dtype=np.float64)


def _doubled(A: Array, information: Array, Q: Array) -> Array:
    """P after 2^j samples from P = 0, j = 0, 1, ...; not finite where it grows for ever."""
    a, g, h = A.T.copy(), information.copy(), Q.copy()
    eye = np.eye(len(A))
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_DOUBLINGS):
            both = np.linalg.solve(eye + g @ h, np.hstack([a, g]))
            ahead, seen = both[:, : len(a)], both[:, len(a) :]
            more = a.T @ h @ ahead
            g = g + a @ seen @ a.T
            a = a @ ahead
            h = h + more
            if not np.isfinite(h).all() or np.all(np.abs(more) <= _EPS * np.abs(h)):
                return np.asarray(0.5 * (h + h.T))
            g, h = 0.5 * (g + g.T), 0.5 * (h + h.T)
    return np.asarray(h)


def fixed_lag(C: Array, filtered: Steady, lag: int) -> Recursion:
    """Return the fixed-lag smoother: estimates of x(k - lag) from all outputs up to k.

    ``x(k-L|k) = x + sum_i V_i e(k-L+i)``, i = 0..L, ``V_i = P (Phi^i)^T C^T S^-1``, with
    x = x(k-L|k-L-1) and Phi = A - gain C (Anderson and Moore 1979, ch. 7). The innovations that
    follow the instant k-L are linear in x and in the window's outputs, so that x is the only
    memory besides the window of L + 1 outputs. L = 0 is the filter.
    """
    n, p = len(filtered.P), len(C)
    Phi = filtered.closed
    G = np.eye(n)
    K = np.zeros((n, (lag + 1) * p))
    power = np.eye(n)  # Phi^i
    seen = np.zeros((p, (lag + 1) * p))  # how the prediction of y(k-L+i) depends on the window
    carried = np.zeros((n, (lag + 1) * p))  # the same for its state
    for i in range(lag + 1):
        V = filtered.P @ np.linalg.solve(filtered.S, C @ power).T
        here = slice(i * p, (i + 1) * p)
        seen = C @ carried
        G -= V @ C @ power
        K -= V @ seen
        K[:, here] += V
        carried = Phi @ carried
        carried[:, here] += filtered.gain
        power = Phi @ power
    F = np.hstack([filtered.gain, np.zeros((n, lag * p))])
    return Recursion(Phi, F, G, K, p, lag)
