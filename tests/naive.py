"""Slow, obvious twins of the kernels, by definition and not by optimisation.

Nothing here imports the package: where a kernel and its twin agree, they agree for two reasons.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lowpass(pole: float, x: Array, start: float) -> Array:
    """``y(k) = a y(k-1) + (1 - a) x(k)`` from ``y(-1) = start``."""
    y, before = np.empty_like(x), start
    for k, value in enumerate(x):
        before = pole * before + (1.0 - pole) * value
        y[k] = before
    return y


def hat_average(polynomial: np.polynomial.Polynomial, t: float, period: float) -> float:
    """``int (1 - |u|/T)/T x(t + u) du`` over ``|u| < T``, exactly, of a polynomial."""
    x = np.polynomial.Polynomial([1.0])
    left = np.polynomial.Polynomial([1.0 - t / period, 1.0 / period])
    right = np.polynomial.Polynomial([1.0 + t / period, -1.0 / period])
    rising, falling = (polynomial * left * x).integ(), (polynomial * right * x).integ()
    area = rising(t) - rising(t - period) + falling(t + period) - falling(t)
    return float(area / period)


def weak_terms(
    columns: Array,
    theta: Array,
    tau: Array,
    *,
    period: float,
    inertia: float,
    damping: float = 0.0,
    held: bool = False,
) -> tuple[Array, Array]:
    """The motor's balance tested with hats, from the third sample on: ``y (N-2,)``, ``R (N-2, p)``.

    ``columns`` is ``(N, p)``: what is tested with the hat as it stands.
    """
    T = period

    def hat(x: Array) -> Array:
        return (x[2:] + 10.0 * x[1:-1] + x[:-2]) / 12.0

    torque = 0.5 * (tau[1:-1] + tau[:-2]) if held else hat(tau)
    y = inertia * (theta[2:] - 2.0 * theta[1:-1] + theta[:-2]) / T**2
    y = y + damping * (theta[2:] - theta[:-2]) / (2.0 * T) - torque
    return y, np.stack([hat(c) for c in columns.T], axis=1)


def weak_rows(
    columns: Array,
    theta: Array,
    tau: Array,
    *,
    period: float,
    cutoff: float,
    inertia: float,
    damping: float = 0.0,
    held: bool = False,
) -> tuple[Array, Array]:
    """``weak_terms`` through two poles."""
    y, R = weak_terms(
        columns, theta, tau, period=period, inertia=inertia, damping=damping, held=held
    )
    pole = math.exp(-cutoff * period)
    return poles(pole, y, 2), np.stack([poles(pole, c, 2) for c in R.T], axis=1)


def poles(pole: float, x: Array, order: int) -> Array:
    """``order`` equal poles one after the other, each started at the first sample."""
    for _ in range(order):
        x = lowpass(pole, x, x[0])
    return x


def bump(power: int, length: int, derivative: int = 0) -> Array:
    """``(u (1 - u))^power`` at ``length`` inner points of [0, 1], oldest first, one by one.

    With ``derivative`` the central difference of these values, 0 beyond both ends, in u.
    """
    h = 1.0 / (length + 1)
    found = [(h * m * (1.0 - h * m)) ** power for m in range(length + 2)]
    found[0] = found[-1] = 0.0
    inner = range(1, length + 1)
    if derivative:
        return np.array([(found[m + 1] - found[m - 1]) / (2.0 * h) for m in inner])
    return np.array([found[m] for m in inner])


def windowed(weights: Array, x: Array, stride: int, phase: int = 0) -> dict[int, float]:
    """Weighted sums over the last samples, ``weights`` newest first, by the sample they end at.

    The first where the window is full and ``phase`` later, then every ``stride``.
    """
    n = len(weights)
    ends = range(n - 1 + phase, len(x), stride)
    return {k: float(sum(weights[m] * x[k - m] for m in range(n))) for k in ends}


def residual(
    theta: Array, velocity: Array, tau: Array, *, period: float, K: float, B: float, D: float
) -> Array:
    """flacco2012 eq. 17 word for word, growing integral and all; ``rbar(-1) = rbar(0)``."""
    T, r, integral = period, 0.0, 0.0
    out = np.zeros_like(theta)
    before = K * (B * velocity[0] + D * theta[0])
    for k in range(1, len(theta)):
        integral += 0.5 * (tau[k] + tau[k - 1]) * T
        rbar = K * (B * velocity[k] + D * theta[k] - integral)
        r = (2.0 - T * K) / (2.0 + T * K) * r + 2.0 * (rbar - before) / (2.0 + T * K)
        before, out[k] = rbar, r
    return out


def residual_as_printed(
    theta: Array, velocity: Array, tau: Array, *, period: float, K: float, B: float, D: float
) -> Array:
    """flacco2012 eq. 15, Euler at a hundredth of the period, from the printed start.

    At t = 0 the equation reads ``r = K (p(0) + D theta(0))``.
    """
    fine = 100
    t = np.arange(len(theta), dtype=np.float64)
    s = np.arange((len(theta) - 1) * fine + 1) / fine
    p = B * np.interp(s, t, velocity)
    angle, torque = np.interp(s, t, theta), np.interp(s, t, tau)
    total, r = 0.0, np.empty_like(s)
    for k in range(len(s)):
        r[k] = K * (p[k] + D * angle[k] - total)
        total += (torque[k] + r[k]) * period / fine
    return r[::fine].copy()


def measurement_variance(
    speed: float, *, largest: float, smallest: float, steepness: float, count_speed: float
) -> float:
    """flacco2012 eq. 20, corrected: counts moved per sample are ``speed / count_speed``."""
    steep = (abs(speed) / count_speed - 1.0) * steepness
    return (largest - smallest) / (1.0 + math.exp(min(steep, 500.0))) + smallest


def measurement_variance_as_printed(
    speed: float,
    *,
    largest: float,
    smallest: float,
    steepness: float,
    resolution: float,
    period: float,
) -> float:
    """flacco2012 eq. 20 with the printed product, ``w_s`` being the resolution over the period."""
    steep = (abs(speed) * (resolution / period) - 1.0) * steepness
    return (largest - smallest) / (1.0 + math.exp(min(steep, 500.0))) + smallest


def rls_as_printed(R: Array, y: Array, P0: Array, alpha0: Array, c: float | None = None) -> Array:
    """flacco2012 eqs 23, 39 and 41, outer products and all; ``(N, p)`` estimates.

    Without ``c`` it is eq. 23 alone.
    """
    P, alpha = P0.copy(), alpha0.copy()
    found = np.empty((len(y), len(alpha0)))
    for k in range(len(y)):
        F = R[k]
        rho = F @ P @ F
        gain = P @ F / (1.0 + rho)
        a = 1.0 if c is None else (c + c * rho) / (1.0 + c * rho)
        alpha = alpha + a * gain * (y[k] - F @ alpha)
        P = P - a * np.outer(gain, F @ P)
        found[k] = alpha
    return found


def covariance_as_printed(R: Array, P0: Array) -> Array:
    """``P(N)`` of flacco2012 eq. 23 with the outer product as printed."""
    P = P0.copy()
    for F in R:
        P = P - np.outer(P @ F / (1.0 + F @ P @ F), F @ P)
    return P


def ridge(
    R: Array,
    y: Array,
    *,
    spread: Array,
    centre: Array,
    variance: float = 1.0,
    weights: Array | None = None,
) -> tuple[Array, Array]:
    """Batch least squares with a prior: estimate and covariance."""
    w = np.ones(len(y)) if weights is None else weights
    information = np.diag(1.0 / spread) + (R * w[:, None]).T @ R / variance
    right = centre / spread + R.T @ (w * y) / variance
    return np.linalg.solve(information, right), np.linalg.inv(information)


def nested(
    R: Array, y: Array, *, spread: Array, centre: Array, variance: float = 1.0
) -> tuple[Array, Array]:
    """Batch solutions of the models of columns 0..m, each on its own, for every m.

    Row m of ``(p, p)`` holds the coefficients of model m, 0 where it has no column; matrix m of
    ``(p, p, p)`` its covariance in the same way.
    """
    p = R.shape[1]
    alpha, P = np.zeros((p, p)), np.zeros((p, p, p))
    for m in range(p):
        own = slice(0, m + 1)
        alpha[m, own], P[m, own, own] = ridge(
            R[:, own], y, spread=spread[own], centre=centre[own], variance=variance
        )
    return alpha, P


def weighted(weight: Array, models: Array) -> Array:
    """``sum_m w_m (A_m - A_(m-1))``: each model's step beyond the one before, believed by w."""
    steps = np.diff(models, axis=0, prepend=np.zeros_like(models[:1]))
    return np.asarray(np.tensordot(weight, steps, axes=1))


def forgetful_information(
    R: Array, y: Array, *, spread: Array, centre: Array, variance: float, forgetting: float
) -> tuple[Array, Array]:
    """Recursive least squares in information form, where every step is a sum.

    After each row everything fades by ``forgetting``; then one column in turn gets back the share
    of its prior that p steps of fading took. Returns estimate and covariance at the end.
    """
    p = len(spread)
    information, right = np.diag(1.0 / spread), centre / spread
    for k in range(len(y)):
        information = forgetting * (information + np.outer(R[k], R[k]) / variance)
        right = forgetting * (right + R[k] * y[k] / variance)
        j = k % p
        share = p * (1.0 - forgetting) / spread[j]
        information[j, j] += share
        right[j] += share * centre[j]
    return np.linalg.solve(information, right), np.linalg.inv(information)


def block_squares(terms: Array, length: int, fade: float) -> tuple[Array, float]:
    """Faded sum over complete blocks of ``length`` of the outer product of a block's sum."""
    total, count = np.zeros((terms.shape[1], terms.shape[1])), 0.0
    for first in range(0, len(terms) - length + 1, length):
        part = terms[first : first + length].sum(axis=0)
        total = fade * total + np.outer(part, part)
        count = fade * count + 1.0
    return total, count


def newey_west(scores: Array, lags: int) -> Array:
    """Long-run covariance of the sum of scores, Bartlett weights."""
    total = scores.T @ scores
    for lag in range(1, lags + 1):
        cross = scores[lag:].T @ scores[:-lag]
        total = total + (1.0 - lag / (lags + 1.0)) * (cross + cross.T)
    return total


def autoregressive(rng: np.random.Generator, size: int, a: float) -> Array:
    """AR(1) noise of unit innovations, from its stationary distribution."""
    e = rng.standard_normal(size)
    x = np.empty(size)
    x[0] = e[0] / math.sqrt(1.0 - a * a)
    for k in range(1, size):
        x[k] = a * x[k - 1] + e[k]
    return x


def stencils(x: Array, period: float) -> Array:
    """Value and three derivatives of the quartic through five samples, at the middle one: (4, N-4).

    The textbook's central differences: of order 4, 4 and 2.
    """
    a, b, c, d, e = (x[i : len(x) - 4 + i] for i in range(5))
    T = period
    return np.stack(
        [
            c,
            (a - 8.0 * b + 8.0 * d - e) / (12.0 * T),
            (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * T**2),
            (e - 2.0 * d + 2.0 * b - a) / (2.0 * T**3),
        ]
    )


def rotatum_rows(
    observe: Callable[[Array], Array],
    q: Array,
    theta: Array,
    s: Array,
    powers: list[tuple[int, int]],
    *,
    inertia: float,
    damping: float,
    gravity: float,
) -> tuple[Array, Array]:
    """trumic2022 eq. 10 of a pendulum with tied columns: ``y (N,)``, ``R (N, b)``, of one instant.

    ``observe`` makes value and three derivatives (4, N) of a signal; terms are ``phi^i s^j``.
    """
    _, _, ddq, dddq = observe(q)
    y = -(inertia * dddq + damping * ddq + gravity * observe(np.sin(q))[1])
    columns = [observe((q - theta) ** i * s**j)[1] for i, j in powers]
    return y, np.stack(columns, axis=1)


def gated(
    speeds: Array, low: float, high: float, span: int, hold: int, late: int = 0
) -> tuple[list[bool], list[bool]]:
    """Whether a row is held back, and whether that is called a standstill, sample by sample."""
    moving: list[bool] = []
    for speed in speeds:
        moving.append(bool(speed >= low if moving and moving[-1] else speed > high))
    held, still, last = [], [], -1
    for k in range(len(moving)):
        end = k
        while end >= 0 and not moving[end]:
            end -= 1
        first = end
        while first >= 0 and moving[first]:
            first -= 1
        # The latest spell of moving: first + 1 to end.
        free = k - first >= span and k - end <= late
        held.append(not free)
        last = k if free else last
        still.append(not free and k - last >= hold)
    return held, still


def acceleration_observer(
    L: Array,
    *,
    inertia: float,
    stiffness: Array,
    damping: float,
    motor_damping: float,
    period: float,
    theta: Array,
    torque: Array,
    acceleration: Array,
    start: Array,
    held: bool,
    substeps: int = 20,
) -> Array:
    """deluca2007 eq. 6 of one joint in the paper's state (theta, q, theta', q'): (N, 4).

    By Runge and Kutta in small steps; inputs are straight lines between samples, a held torque is
    constant. ``L`` (N, 4) and ``stiffness`` (N,) are those of the interval that ends at a sample.
    """
    inputs = (theta, torque, acceleration)

    def rate(x: Array, k: int, s: float) -> Array:
        y1, u, y2 = (v[k - 1] + s * (v[k] - v[k - 1]) for v in inputs)
        u = torque[k - 1] if held else u
        spring = stiffness[k] * (x[0] - x[1]) + damping * (x[2] - x[3])
        motor = (u - spring - motor_damping * x[2]) / inertia
        return np.asarray(np.array([x[2], x[3], motor, y2]) + L[k] * (y1 - x[0]))

    x = np.array(start)
    found = [x]
    h, part = period / substeps, 1.0 / substeps
    for k in range(1, len(theta)):
        for i in range(substeps):
            a = rate(x, k, i * part)
            b = rate(x + 0.5 * h * a, k, (i + 0.5) * part)
            c = rate(x + 0.5 * h * b, k, (i + 0.5) * part)
            d = rate(x + h * c, k, (i + 1.0) * part)
            x = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        found.append(x)
    return np.array(found)
