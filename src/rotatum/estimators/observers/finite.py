"""The design for inputs of finite intensity: less noise, at the price of bandwidth."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError, check_names
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.smoothing import fixed_lag, steady_filter
from rotatum.estimators.observers.system import System, scaled

Array = NDArray[np.float64]
INPUTS = ("walk", "white")


def finite_observer(
    given: System,
    delay: int,
    intensity: ArrayLike,
    noise: Array | float = 1.0,
    model: str = "walk",
) -> Recursion:
    """Design a steady-state Kalman filter of state and input, smoothed over a fixed lag.

    Inputs are no longer of any size. ``walk``: ``u(k+1) = u(k) + w(k)``; ``white``:
    ``u(k+1) = w(k)``; w white with the given standard deviations. What of the input is faster than
    its intensity over the noise allows is smoothed away: bandwidth is given up for noise, which
    no exact design does. As the intensity grows the design approaches the exact one of least
    noise (`least_noise_observer`), and exists wherever the filter does: a long delay is not
    needed, nor that zeros decay.

    Args:
        given: the system.
        delay: L, lag of the smoother; 0 is the filter.
        intensity: (m,) standard deviation of w per sample, or one for all inputs.
        noise: (p, p) covariance of the outputs' white noise, or one variance for all.
        model: "walk" or "white".

    Returns:
        A recursion with n + m states over a window of L + 1 outputs, ``out = (x, u)`` of k - L.

    Raises:
        MethodError: an intensity or a variance that is not positive, or no steady filter.
        RotatumError: an unknown model.
    """
    check_names([model], INPUTS, what="unknown model of the input", where="model")
    n, m, p = given.sizes
    sizes = np.broadcast_to(np.asarray(intensity, dtype=np.float64), (m,))
    R = np.asarray(noise, dtype=np.float64)
    R = R * np.eye(p) if R.ndim == 0 else R
    if (sizes <= 0.0).any() or (np.linalg.eigvalsh(R) <= 0.0).any():
        raise MethodError("intensity and noise must be positive", where="observer design",
                          value=(sizes.tolist(), R.tolist()))  # fmt: skip
    s = scaled(given, np.sqrt(np.diag(R)))
    A = np.zeros((n + m, n + m))
    A[:n, :n], A[:n, n:] = s.system.A, s.system.B
    A[n:, n:] = np.eye(m) if model == "walk" else 0.0
    C = np.hstack([s.system.C, s.system.D])
    Q = np.zeros((n + m, n + m))
    Q[n:, n:] = np.diag((sizes / s.u) ** 2)
    both = fixed_lag(C, steady_filter(A, C, Q, R / s.y[:, None] / s.y), delay)
    x = np.concatenate([s.x, s.u])
    y = np.tile(s.y, delay + 1)
    return both._replace(
        E=both.E * x[:, None] / x,
        F=both.F * x[:, None] / y,
        G=both.G * x[:, None] / x,
        K=both.K * x[:, None] / y,
    )
