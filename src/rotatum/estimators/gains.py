"""Gains of the filters from what is declared: resolution, period, bandwidth."""

from __future__ import annotations

import math


def steady_gains(bandwidth: float, period: float) -> tuple[float, float]:
    """Constant gains (alpha, beta) of the filter whose bandwidth is declared.

    In continuous time white acceleration of density ``q`` and position noise of density ``r``
    give the filter the poles of ``s^2 + sqrt(2) w s + w^2``, ``w^4 = q / r``. With
    ``q = V_a T`` and ``r = R T``, ``R = resolution^2 / 12``: ``V_a = w^4 R``. The steady state of
    eqs 18-19 then depends on the tracking index ``(w T)^2`` alone (Kalata 1984):
    ``g = (4 + L - sqrt(8 L + L^2)) / 4``, ``alpha = 1 - g^2``, ``beta = 2 (1 - g)^2``.

    Args:
        bandwidth: w, rad/s.
        period: T, s.

    Returns:
        alpha, beta; ``x += alpha e``, ``xdot += beta e / T``.
    """
    L = (bandwidth * period) ** 2
    g = (4.0 + L - math.sqrt(8.0 * L + L * L)) / 4.0
    alpha = 1.0 - g * g
    return alpha, 2.0 * (1.0 - g) ** 2


def velocity_std(bandwidth: float, period: float, resolution: float) -> float:
    """Standard deviation of the steady filter's velocity, rad/s, from encoder quantisation alone.

    White noise of variance ``R = resolution^2 / 12`` through the alpha-beta filter:
    ``var(xdot) = R 2 beta^2 / (T^2 alpha (4 - 2 alpha - beta))``.
    """
    alpha, beta = steady_gains(bandwidth, period)
    R = resolution**2 / 12.0
    return math.sqrt(R * 2.0 * beta**2 / (alpha * (4.0 - 2.0 * alpha - beta))) / period
