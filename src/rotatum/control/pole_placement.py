"""Gains of one elastic joint from where its poles are to be."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

__all__ = ["ElasticJoint", "PolePair", "motor_gains", "state_gains"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PolePair:
    """Two poles, ``s^2 + 2 zeta w s + w^2 = 0``.

    Raises `RotatumError` unless both are positive.
    """

    frequency: float  # w [rad/s]
    damping: float = 1.0  # zeta

    def __post_init__(self) -> None:
        """Check them."""
        for name in ("frequency", "damping"):
            value = getattr(self, name)
            if not (value > 0.0 and math.isfinite(value)):
                what = "poles need a positive frequency and damping"
                raise RotatumError(what, where=f"poles.{name}", value=value)

    @property
    def polynomial(self) -> Array:
        """Coefficients (3,), highest power first."""
        return np.array([1.0, 2.0 * self.damping * self.frequency, self.frequency**2])


@dataclass(frozen=True)
class ElasticJoint:
    """A joint alone, linear, at the joint side; the other joints stand still.

    ``B theta'' + V theta' + D (theta' - q') + K (theta - q) = tau``,
    ``M q'' + D (q' - theta') + K (q - theta) = 0``.

    Attributes
    ----------
    motor, link : B and M [kg m^2].
    stiffness, damping : K [N m/rad] and D [N m s/rad] of the spring.
    viscous : V of the motor [N m s/rad].

    Raises `RotatumError` for an inertia or stiffness that is not positive.
    """

    motor: float
    link: float
    stiffness: float
    damping: float = 0.0
    viscous: float = 0.0

    def __post_init__(self) -> None:
        """Check what is divided by."""
        for name in ("motor", "link", "stiffness"):
            value = getattr(self, name)
            if not (value > 0.0 and math.isfinite(value)):
                what = "inertias and stiffness of a joint are positive"
                raise RotatumError(what, where=f"joint.{name}", value=value)

    @property
    def free_frequency(self) -> float:
        """Of motor against link, ``(K (1/B + 1/M))^(1/2)`` [rad/s]: the mode without control."""
        return math.sqrt(self.stiffness * (1.0 / self.motor + 1.0 / self.link))

    @property
    def locked_frequency(self) -> float:
        """Of the link on a motor that stands, ``(K / M)^(1/2)`` [rad/s]."""
        return math.sqrt(self.stiffness / self.link)

    def closed(self, gains: Array) -> Array:
        """Return A, (4, 4), of x = (theta, q, theta', q') under ``tau = -gains^T x``."""
        B, M, K, D = self.motor, self.link, self.stiffness, self.damping
        push = np.array([-K, K, -D - self.viscous, D]) - gains
        pull = np.array([K, -K, D, -D])
        return np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], push / B, pull / M])


def state_gains(joint: ElasticJoint, slow: PolePair, fast: PolePair) -> Array:
    """Return the gains (4,) on theta, q, theta', q' that put the joint's poles there.

    In closed form: ``tau = -k^T x`` gives the characteristic polynomial, times B M,
    ``(B s^2 + (D + V + k3) s + K + k1)(M s^2 + D s + K) + (k2 + k4 s - K - D s)(D s + K)``.

    Returns
    -------
    k1, k2 [N m/rad], k3, k4 [N m s/rad].
    """
    B, M, K, D = joint.motor, joint.link, joint.stiffness, joint.damping
    a3, a2, a1, a0 = (B * M * np.polymul(slow.polynomial, fast.polynomial)[1:]).tolist()
    k3 = (a3 - B * D) / M - D - joint.viscous
    both = a0 / K  # k1 + k2
    k4 = (a1 - D * both) / K - joint.viscous - k3
    k1 = (a2 - (B + M) * K - D * (joint.viscous + k3 + k4)) / M
    return np.array([k1, both - k1, k3, k4])


def motor_gains(joint: ElasticJoint, slow: PolePair) -> Array:
    """Return the gains (4,) of a motor-only PD law: zero on q and q'.

    ``kp = (B + M) w^2``, ``kd = 2 zeta w (B + M)``: were the spring stiff, motor and link together
    would have exactly these two poles. The spring takes away from their damping, the more so the
    nearer its mode is to w.
    """
    inertia = joint.motor + joint.link
    kp, kd = inertia * slow.frequency**2, 2.0 * slow.damping * slow.frequency * inertia
    return np.array([kp, 0.0, kd - joint.viscous, 0.0])
