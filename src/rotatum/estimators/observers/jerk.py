"""Link position, velocity, acceleration and jerk of one and the same instant, from an encoder."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.figures import fallen
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.smoothing import fixed_lag, steady_filter

Array = NDArray[np.float64]
LAG = 5.0  # default lag in units of 1 / bandwidth
_FASTEST = 2.0  # rad per sample: beyond, the poles leave Butterworth's pattern
_SLOWEST = 1e-3  # rad per sample: beyond, rounding of q is amplified into the jerk
_DEGREE = 4  # of the polynomial through the deadbeat's window


class JerkObserver(NamedTuple):
    """An observer of (q, q', q'', q''') at the instant ``k - recursion.lag``.

    Args:
        recursion: over a window of positions; ``out = (q, q', q'', q''')`` [rad, rad/s, ...].
        std: (4,) standard deviations of ``out`` from the encoder's noise alone.
        bandwidth: frequency where the jerk of a sine is 3 dB down [rad/s].
    """

    recursion: Recursion
    std: Array
    bandwidth: float


def jerk_observer(
    period: float, *, bandwidth: float | None, lag: int | None = None, noise: float = 1.0
) -> JerkObserver:
    """Design a smoothed observer of position, velocity, acceleration and jerk.

    The model is four integrators driven by white noise (``q'''' = w``), q measured with white
    noise, both of the strength that puts the continuous filter's poles on Butterworth's half
    circle of radius ``bandwidth``: density of w over density of the noise = bandwidth^8. A
    fixed-lag smoother of that model: as the lag grows all four estimates become derivatives of
    one and the same ``q / (1 + (frequency / bandwidth)^8)``, without phase. Polynomials up to
    order 3 in time come out exactly, at ``k - lag``, whatever the lag.

    The variance of the jerk's error falls by a factor 8 with the lag, and has come within 20, 10,
    5 and 1 % of the least at lags of 3.2, 3.6, 5.2 and 6.6 / (bandwidth period) samples. The
    default is 5.

    ``bandwidth=None`` is deadbeat: the polynomial of order 4 in time fitted to a window of
    ``2 lag + 1`` samples, differentiated at its centre. With lag 2, the default, it goes through
    all five: the jerk is then ``(q(k) - 2 q(k-1) + 2 q(k-3) - q(k-4)) / (2 T^3)``, the mean of
    two neighbouring inputs U of trumic2022 eq. 13, which belong to k - 1.5 and k - 2.5.

    Args:
        period: T [s].
        bandwidth: radius of the poles [rad/s], or None. bandwidth times period 1e-3 to 2.
        lag: samples by which the estimates come late.
        noise: standard deviation of one measured position [rad]; a resolution over sqrt(12).

    Raises:
        MethodError: a lag or bandwidth out of range.
    """
    recursion = _deadbeat(period, lag) if bandwidth is None else _smooth(period, bandwidth, lag)
    std = noise * np.sqrt(np.diag(recursion.noise()))
    return JerkObserver(recursion, std, _bandwidth(recursion, period))


def sensible_lag(bandwidth: float, period: float) -> int:
    """Lag [samples] beyond which the error hardly falls: 5 / (bandwidth period), rounded up."""
    return math.ceil(LAG / (bandwidth * period))


def _smooth(T: float, w: float, lag: int | None) -> Recursion:
    h = w * T
    if not _SLOWEST <= h <= _FASTEST:
        raise MethodError(
            "bandwidth out of range for this period",
            where="bandwidth",
            value=w,
            allowed=f"{_SLOWEST / T:g} to {_FASTEST / T:g} rad/s",
        )
    chosen = sensible_lag(w, T) if lag is None else lag
    _check_lag(chosen, 0)
    Phi, C, Q = snap_model(h)
    scaled = fixed_lag(C, steady_filter(Phi, C, Q, np.eye(1)), chosen)
    D = w ** np.arange(4.0)
    return scaled._replace(
        E=scaled.E * D[:, None] / D,
        F=scaled.F * D[:, None],
        G=scaled.G * D[:, None] / D,
        K=scaled.K * D[:, None],
    )


def snap_model(h: float) -> tuple[Array, Array, Array]:
    """Four integrators over a period, driven by white noise, next to unit measurement noise.

    States are ``q^(j) / w^j``: the Riccati equation is then of order one at every period.

    Args:
        h: bandwidth times period, w T [rad].

    Returns:
        Transition (4, 4), output (1, 4) and covariance of the driving noise (4, 4) in units of
        the variance of one measurement, for a ratio of densities of w^8.
    """
    left = 1.0 / np.array([math.factorial(j) for j in range(4)])
    Phi = np.array([[h ** (j - i) * left[j - i] if j >= i else 0.0 for j in range(4)]
                    for i in range(4)])  # fmt: skip
    Q = np.array([[h ** (8 - i - j) * left[3 - i] * left[3 - j] / (7 - i - j) for j in range(4)]
                  for i in range(4)])  # fmt: skip
    return Phi, np.eye(1, 4), Q


def _deadbeat(T: float, lag: int | None) -> Recursion:
    from scipy.signal import savgol_coeffs  # heavy

    chosen = 2 if lag is None else lag
    _check_lag(chosen, 2)
    w = 2 * chosen + 1
    # As functions of samples, scaled afterwards: T^3 of 1 ms is nothing to fit polynomials with.
    K = np.array([savgol_coeffs(w, _DEGREE, deriv=j, use="dot") / T**j for j in range(4)])
    return Recursion(np.zeros((4, 4)), np.zeros((4, w)), np.zeros((4, 4)), K, 1, chosen)


def _check_lag(lag: int, least: int) -> None:
    if lag < least:
        raise MethodError("lag too short", where="lag", value=lag, allowed=f"{least} or more")


def _bandwidth(recursion: Recursion, T: float) -> float:
    """Lowest frequency where ``|jerk| / |(i w)^3 q|`` is 3 dB down [rad/s]; Nyquist at most."""

    def jerk(angles: Array) -> Array:
        return np.asarray(np.abs(recursion.response(angles)[:, 3, 0]) * (T / angles) ** 3)

    return fallen(jerk, 0.1 * _SLOWEST) / T
