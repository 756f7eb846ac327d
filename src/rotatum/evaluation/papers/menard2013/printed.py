"""The observer as its equations print it: trapezoids over a window, Taylor powers, eqs 23-25.

``rotatum.estimate(method="algebraic")`` is the same regression with weights that are exact on the
grid, held torques, powers scaled by their range and a prior that does not depend on a unit; this is
what the paper's own choices make of it.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["Observer", "Printed", "Rows", "coefficients_of", "printed", "rows_of", "stiffness_of"]

Array = NDArray[np.float64]

ENDS = ("1", "2")


class Observer(NamedTuple):
    """The paper's settings.

    Args:
        order: k, the highest power in the Taylor series of the stiffness (eq. 18).
        spread: P(0), times the identity, of coefficients in N m and powers of rad.
        window: T, s.
        held: whether the mean of a held torque over its period is used; the paper does not.
    """

    order: int
    spread: float
    window: float = 1.0
    held: bool = False


class Rows(NamedTuple):
    """``C(t) = sum_j a_j b_j(t)`` (eq. 19) at every sample from the first full window on.

    Args:
        C: (n,).
        b: (n, k + 1).
    """

    C: Array
    b: Array


class Printed(NamedTuple):
    """A run; 0 before the first full window.

    Args:
        stiffness: (N,) both transmissions together, N m/rad.
        parts: (N, 2) each.
        coefficients: (N, 2, k + 1) a_j of each.
    """

    stiffness: Array
    parts: Array
    coefficients: Array


def rows_of(
    theta: Array,
    phi: Array,
    tau: Array,
    *,
    inertia: float,
    damping: float,
    observer: Observer,
    period: float,
) -> Rows:
    """Make the rows of one transmission.

    ``C = int_0^1 (J G1 + T b G2)(u) q(s) + T^2 G3(u) tau(s) du``, ``s = t + T (u - 1)`` (eq. 20),
    ``b_j = T^2/6 int_0^1 w33'(u) phi(s)^(j+1)/(j+1)! du`` (eq. 21), the integrals as trapezoids
    ``sum_m W_m g(1 - m/M) y(l - m)``, ``M = T / T_s`` (eqs 27 and 28).

    Departures: u = 1 is now in both, where eqs 21 and 28 turn time round; W_m are parts of the
    window, not seconds, which is the same for the paper's window of a second.

    Args:
        theta, phi, tau: (N,) motor position, deflection, motor torque.
        inertia: J of the motor, kg m^2.
        damping: b of the motor, N m s/rad.
        observer: settings.
        period: T_s, s.
    """
    T = observer.window
    M = round(T / period)
    u = 1.0 - np.arange(M + 1) / M  # of the sample m ago
    weight = np.full(M + 1, 1.0 / M)
    weight[[0, -1]] *= 0.5
    G1, G2, G3, slope = _kernels(u)

    def filtered(g: Array, y: Array) -> Array:
        return np.convolve(y, weight * g, "valid")

    if observer.held:
        tau = np.concatenate([tau[:1], 0.5 * (tau[1:] + tau[:-1])])
    C = filtered(inertia * G1 + T * damping * G2, theta) + filtered(T**2 * G3, tau)
    powers = (phi ** (j + 1) / factorial(j + 1) for j in range(observer.order + 1))
    b = [T**2 / 6.0 * filtered(slope, power) for power in powers]
    return Rows(C, np.stack(b, axis=1))


def _kernels(u: Array) -> tuple[Array, Array, Array, Array]:
    """G1, G2, G3 below eq. 17 and w33', with ``w_km = (1 - u)^k u^m``."""

    def w(k: int, m: int) -> Array:
        return np.asarray((1.0 - u) ** k * u**m)

    G1 = w(3, 0) - 9.0 * w(2, 1) + 9.0 * w(1, 2) - w(0, 3)
    G2 = -w(3, 1) + 3.0 * w(2, 2) - w(1, 3)
    G3 = -0.5 * w(3, 2) + 0.5 * w(2, 3)
    return G1, G2, G3, 3.0 * w(3, 2) - 3.0 * w(2, 3)


def coefficients_of(rows: Rows, observer: Observer, period: float) -> Array:
    """Integrate eqs 23 to 25 exactly for rows held over a period; (n, k + 1) a_j.

    ``d/dt P^-1 = b b^T`` and ``d/dt (P^-1 A) = b C``, so that
    ``(I + P(0) int b b^T) A = P(0) int b C``. An explicit step of eq. 24 is not stable with the
    paper's P(0).

    Args:
        rows: of a transmission.
        observer: settings.
        period: T_s, s.
    """
    scale = observer.spread * period
    information = scale * np.cumsum(rows.b[:, :, None] * rows.b[:, None, :], axis=0)
    told = scale * np.cumsum(rows.b * rows.C[:, None], axis=0)
    found = np.linalg.solve(np.eye(rows.b.shape[1]) + information, told[:, :, None])
    return np.asarray(found[:, :, 0])


def stiffness_of(coefficients: Array, phi: Array) -> Array:
    """Read the stiffness out, ``sum_j a_j phi^j / j!`` (eq. 18).

    Args:
        coefficients: (N, k + 1) a_j at every sample.
        phi: (N,) deflection there, rad.
    """
    powers = (phi**j / factorial(j) for j in range(coefficients.shape[1]))
    return np.asarray((coefficients * np.stack(list(powers), axis=1)).sum(axis=1))


def printed(device: Device, log: Log, observer: Observer) -> Printed:
    """Run the observer on both transmissions of a joint whose deflections' zeros are 0.

    Args:
        device: of one antagonistic joint; gives the motors' inertia and damping.
        log: of its motion.
        observer: settings.
    """
    (joint,) = device.joints
    logged = log.joints[joint.name]
    parts, coefficients = [], []
    for motor, end in zip(joint.motors, ENDS, strict=True):
        assert motor.reflected_inertia is not None  # the papers' motors all have one
        phi = logged["q"] - logged[f"theta{end}"]
        rows = rows_of(
            logged[f"theta{end}"],
            phi,
            logged[f"tau{end}"],
            inertia=motor.reflected_inertia.value,
            damping=motor.reflected_damping.value,
            observer=observer,
            period=log.period,
        )
        a = np.zeros((log.samples, observer.order + 1))
        a[log.samples - len(rows.C) :] = coefficients_of(rows, observer, log.period)
        coefficients.append(a)
        parts.append(stiffness_of(a, phi))
    each = np.stack(parts, axis=1)
    return Printed(each.sum(axis=1), each, np.stack(coefficients, axis=1))
