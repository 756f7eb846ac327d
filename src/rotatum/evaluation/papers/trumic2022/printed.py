"""The estimator of section IV as printed: eq. 13, the regressors of Table II, least squares.

``rotatum.estimate(method="rotatum")`` is the same idea with everything brought to one instant, one
polynomial behind both blocks of a serial joint, and a bandwidth; this is what the paper's own
choices make of a single link that is a pendulum.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.triple import printed_observer
from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["SPREAD", "Rows", "least_squares", "printed", "read_out", "rows_of", "through"]

Array = NDArray[np.float64]

SPREAD = 1e7  # P(0) of section IV
EVEN = {"series": 1, "antagonistic": 4, "serial": 2}  # even powers of the stiffness, from 0 on
SETPOINTS = 2  # kappa_theta, highest power of the second motor
EVERY = 0.1  # s from one solution of the least squares to the next


class Rows(NamedTuple):
    """``p(k) = psi(k) pi`` (Table II); 0 before the observer's first full window.

    Args:
        p: (N,) elastic rotatum, N m/s.
        psi: (N, b).
    """

    p: Array
    psi: Array


def rows_of(
    device: Device, log: Log, observer: Recursion, *, tied: bool = False, delayed: bool = False
) -> Rows:
    """Make the rows of a joint whose link is a pendulum.

    Eq. 9, its signs corrected: ``p = -(I U + D x3 + m g l cos(x1) x2)``. The paper takes the
    motors' speeds for measured and does not say how; here they come out of the same observer as
    the link's, unless ``delayed``.

    Args:
        device: of one joint.
        log: of its motion.
        observer: with ``out = (q, q', q'', q''')``.
        tied: one torque polynomial behind both blocks of a serial joint, in place of one each.
        delayed: the motors' positions and speeds as they were ``observer.lag`` samples ago (the
            speeds centred differences), whatever instant the observer's own speed belongs to.

    Raises:
        MethodError: the link is an arm's.
    """
    (joint,) = device.joints
    if joint.link is None or joint.link.inertia is None:
        raise MethodError("the printed estimator is one of a single link", where=joint.name)
    logged = log.joints[joint.name]
    q, dq, ddq, jerk = _observed(observer, logged["q"])
    gravity = joint.link.gravity_torque * np.cos(q) * dq
    p = -(joint.link.inertia.value * jerk + joint.link.damping.value * ddq + gravity)

    def motor(role: str) -> tuple[Array, Array]:
        if not delayed:
            x, dx, _, _ = _observed(observer, logged[role])
            return x, dx
        late = np.roll(logged[role], observer.lag)
        return late, np.gradient(late, log.period)

    psi = np.hstack(
        [
            _powers(q - theta, EVEN[joint.actuation]) * (dq - dtheta)[:, None]
            for theta, dtheta in map(motor, _ends(joint.actuation))
        ]
    )
    if joint.actuation == "serial":
        phi = q - motor("theta")[0]
        psi = _serial(psi, phi, *motor("setpoint"), tied)
    psi[: observer.window + 1] = p[: observer.window + 1] = 0.0
    return Rows(p, psi)


def _observed(observer: Recursion, x: Array) -> tuple[Array, ...]:
    """Value and derivatives, (N,) each; 0 before the first full window."""
    found = np.zeros((len(x), 4))
    found[observer.window - 1 :] = observer.run(x)
    return tuple(found.T)


def _ends(actuation: str) -> tuple[str, ...]:
    return ("theta1", "theta2") if actuation == "antagonistic" else ("theta",)


def _powers(phi: Array, even: int) -> Array:
    found: Array = phi[:, None] ** (2 * np.arange(even))
    return found


def _serial(stiff: Array, phi: Array, s: Array, ds: Array, tied: bool) -> Array:
    """Both blocks of Psi_sVSA, or the derivative of one torque polynomial."""
    even, powers = EVEN["serial"], np.arange(SETPOINTS + 1)
    odd = phi[:, None] * _powers(phi, even)
    block = _kron(stiff, s[:, None] ** powers)
    if not tied:
        return np.hstack([block, _kron(odd, s[:, None] ** powers[:-1]) * ds[:, None]])
    slope = powers * s[:, None] ** np.maximum(powers - 1, 0)
    return block + _kron(odd / (2.0 * np.arange(even) + 1.0), slope) * ds[:, None]


def _kron(a: Array, b: Array) -> Array:
    return np.asarray((a[:, :, None] * b[:, None, :]).reshape(len(a), -1))


def least_squares(rows: Rows, period: float, spread: float = SPREAD) -> Array:
    """Return the coefficients at every sample, (N, b), as recursive least squares has them.

    ``pi(k)`` minimises ``|pi|^2 / P(0) + sum_i (p(i) - psi(i) pi)^2``, which RLS from pi = 0 is in
    exact arithmetic. Solved by orthogonal triangularisation, a tenth of a second of rows at a
    time and held in between: the covariance form's rounding is no part of the comparison.

    Args:
        rows: of a motion.
        period: T, s.
        spread: P(0), times the identity, in N m and powers of rad.
    """
    count, b = rows.psi.shape
    told = np.hstack([np.eye(b) / math.sqrt(spread), np.zeros((b, 1))])
    data = np.hstack([rows.psi, rows.p[:, None]])
    found = np.zeros((count, b))
    step = max(1, round(EVERY / period))
    for begin in range(0, count, step):
        every = np.vstack([told, data[begin : begin + step]])
        told = np.asarray(np.linalg.qr(every, mode="r"))[:b]
        found[begin + step : begin + 2 * step] = np.linalg.solve(told[:, :b], told[:, b])
    return found


def read_out(device: Device, log: Log, coefficients: Array) -> Array:
    """Return the stiffness at the logged positions, ``sigma(k) = Phi(k) pi(k)``, (N,) N m/rad.

    Args:
        device, log: as for ``rows_of``.
        coefficients: (N, b) at every sample; of both blocks of a serial joint the first is read.
    """
    (joint,) = device.joints
    logged, even = log.joints[joint.name], EVEN[joint.actuation]
    ends = _ends(joint.actuation)
    Phi = np.hstack([_powers(logged["q"] - logged[role], even) for role in ends])
    if joint.actuation == "serial":
        Phi = _kron(Phi, logged["setpoint"][:, None] ** np.arange(SETPOINTS + 1))
    return np.asarray((Phi * coefficients[:, : Phi.shape[1]]).sum(axis=1))


def through(
    device: Device, log: Log, observer: Recursion, *, tied: bool = False, delayed: bool = False
) -> Array:
    """Return the stiffness with rows of that observer, (N,) N m/rad; see ``rows_of``."""
    rows = rows_of(device, log, observer, tied=tied, delayed=delayed)
    return read_out(device, log, least_squares(rows, log.period))


def printed(device: Device, log: Log, *, delayed: bool = False) -> Array:
    """Return the stiffness by the paper's estimator with the settings of section IV, (N,) N m/rad.

    Args:
        device, log, delayed: as for ``rows_of``.
    """
    return through(device, log, printed_observer(log.period).recursion, delayed=delayed)
