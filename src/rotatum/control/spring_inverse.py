"""From the torque a spring has to transmit to how far, and how fast, it is deflected."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

if TYPE_CHECKING:
    from rotatum.models.transmission import Transmission

__all__ = ["Deflections", "deflections_for"]

Array = NDArray[np.float64]

DEGREE = 7  # of the splines: two derivatives of them are good to h^6
_NEWTON = 60
_TOLERANCE = 1e-10  # of the implicit integration, relative


class Deflections(NamedTuple):
    """Of one spring: ``phi = q - theta`` and its derivatives.

    Parameters
    ----------
    phi, dphi, ddphi : (N,) rad, rad/s, rad/s^2.
    """

    phi: Array
    dphi: Array
    ddphi: Array


def deflections_for(spring: Transmission, torque: Array, period: float) -> Deflections:
    """Return the deflections that transmit a torque: ``tau_e(phi) + D phi' = torque``.

    Between the instants the torque follows a spline of degree 7. Before the first one it stood:
    ``tau_e(phi) = torque``, phi' = 0. Without damping the law is inverted, by Newton's method; with
    it and a linear law the stable first-order equation is solved exactly for that spline; with a
    law that is not linear implicitly (Radau IIA of order 5), its derivatives along with it.

    Parameters
    ----------
    spring
        The law and D.
    torque
        (N,) N m, on the link taken negative: what ``tau_e + D phi'`` is to be.
    period
        Between the instants [s].

    Raises `RotatumError` for fewer than 8 instants, and for a torque the law does not reach.
    """
    if torque.size <= DEGREE:
        what = "inverse dynamics needs more instants"
        raise RotatumError(what, where="time", value=torque.size, allowed=f"{DEGREE + 1} or more")
    if spring.damping == 0.0:
        return _without_damping(spring, torque, period)
    if spring.law == "linear":
        return _linear(spring, torque, period)
    return _implicit(spring, torque, period)


def _spline(torque: Array, period: float) -> Any:
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(period * np.arange(torque.size), torque, DEGREE)


def _without_damping(spring: Transmission, torque: Array, period: float) -> Deflections:
    spline, time = _spline(torque, period), period * np.arange(torque.size)
    phi = inverted(spring, torque)
    sigma, slope = spring.stiffness(phi), spring.slope(phi)
    dphi = spline(time, 1) / sigma
    return Deflections(phi, dphi, (spline(time, 2) - slope * dphi**2) / sigma)


def inverted(spring: Transmission, torque: Array) -> Array:
    """Return the deflections (N,) [rad] at which a law gives these torques (N,) [N m].

    Raises `RotatumError` where it gives them nowhere within its range.
    """
    low, high = spring.model.limits(spring.constants, 0.0)
    phi = np.zeros_like(torque)
    scale = float(np.max(np.abs(torque), initial=0.0))
    for _ in range(_NEWTON):
        miss = spring.torque(phi) - torque
        if np.all(np.abs(miss) <= 1e-14 * scale):
            return phi
        with np.errstate(divide="ignore", invalid="ignore"):
            step = miss / spring.stiffness(phi)
        # half way to the end of the range at most: a hardening law overshoots at first
        phi = np.clip(phi - step, 0.5 * (phi + low), 0.5 * (phi + high))
    if not np.all(np.abs(miss) <= 1e-9 * scale):
        worst = float(torque[np.argmax(np.abs(miss))])
        what = "no deflection of this spring gives the torque the motion asks for"
        raise RotatumError(what, where="transmission", value=worst)
    return phi


def _linear(spring: Transmission, torque: Array, period: float) -> Deflections:
    """Solve ``D x' + K x = p(t)`` for a spline p and its derivatives; x stands at first."""
    K = float(spring.stiffness(0.0))
    spline = _spline(torque, period)
    ratio = period * K / spring.damping
    starts = (float(torque[0]), 0.0, 0.0)
    found = [
        _relaxed(spline.derivative(order) if order else spline, start, torque.size, period, ratio)
        for order, start in enumerate(starts)
    ]
    return Deflections(*(x / K for x in found))


def _relaxed(spline: Any, start: float, size: int, period: float, ratio: float) -> Array:
    """Return x of ``x' = (p - x) ratio / period`` at the instants, exact for the spline p.

    Over an interval ``x(h) = exp(-r) x(0) + sum_k c_k m_k``, c_k the powers of p's piece there and
    ``m_k = r int_0^1 exp(-r (1 - u)) u^k du h^k = r h^k / (k + 1) 1F1(1; k + 2; -r)``.
    """
    from scipy.signal import lfilter
    from scipy.special import factorial, hyp1f1

    time: Array = period * np.arange(size, dtype=np.float64)
    forced = np.zeros(size - 1)
    for k in range(spline.k + 1):
        moment = ratio * period**k / (k + 1.0) * hyp1f1(1.0, k + 2.0, -ratio)
        # the piece that begins at the instant, from its right side
        power = spline(time[:-1], k) if k < spline.k else _last_power(spline, time)
        forced += power / factorial(k) * moment
    decay = float(np.exp(-ratio))
    # lfilter's state before the first interval is what is left of the start after it
    return np.concatenate([[start], lfilter([1.0], [1.0, -decay], forced, zi=[decay * start])[0]])


def _last_power(spline: Any, time: Array) -> Array:
    """Return the piecewise constant derivative of order k, to the right of each instant."""
    values: Array = spline(0.5 * (time[:-1] + time[1:]), spline.k)
    return values


def _implicit(spring: Transmission, torque: Array, period: float) -> Deflections:
    """Integrate phi, phi' and phi'' together: each equation is stable, and none divides twice."""
    from scipy.integrate import solve_ivp

    time = period * np.arange(torque.size)
    spline, D = _spline(torque, period), spring.damping
    rates = [spline, spline.derivative(1), spline.derivative(2)]
    law, c, preload = spring.model, spring.constants, spring.preload

    def slope(t: float, y: Array) -> list[float]:
        phi, dphi, ddphi = y.tolist()
        x = phi + preload
        sigma, bend = law.stiffness(c, x, 0.0), law.slope(c, x, 0.0)
        push = [float(rate(t)) for rate in rates]
        return [
            (push[0] - law.torque(c, x, 0.0)) / D,
            (push[1] - sigma * dphi) / D,
            (push[2] - sigma * ddphi - bend * dphi * dphi) / D,
        ]

    def jacobian(t: float, y: Array) -> Array:
        phi, dphi, ddphi = y.tolist()
        x = phi + preload
        sigma, bend, turn = (f(c, x, 0.0) for f in (law.stiffness, law.slope, law.curvature))
        last = [-bend * ddphi - turn * dphi * dphi, -2.0 * bend * dphi, -sigma]
        return np.array([[-sigma, 0.0, 0.0], [-bend * dphi, -sigma, 0.0], last]) / D

    begin = np.array([inverted(spring, torque[:1])[0], 0.0, 0.0])
    size = np.array([np.max(np.abs(inverted(spring, torque))), 1.0, 1.0])
    found = solve_ivp(
        slope, (0.0, time[-1]), begin, method="Radau", t_eval=time, jac=jacobian,
        rtol=_TOLERANCE, atol=_TOLERANCE * size,
    )  # fmt: skip
    return Deflections(*found.y)
