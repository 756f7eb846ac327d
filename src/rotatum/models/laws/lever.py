"""The lever arm of the AwAS (flacco2012 eqs 49-52)."""

from __future__ import annotations

import math

from rotatum.models.laws.law import Array, Constant, Law, Vector

__all__ = ["LEVER"]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``k_s r^2 sin^2(phi)``."""
    y = s * math.sin(phi)
    return c[0] * y * y


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``k_s r^2 sin(2 phi)`` (eq. 49)."""
    return c[0] * s * s * math.sin(2.0 * phi)


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k_s r^2 cos(2 phi)`` (eq. 50)."""
    return 2.0 * c[0] * s * s * math.cos(2.0 * phi)


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``-4 k_s r^2 sin(2 phi)``."""
    return -4.0 * c[0] * s * s * math.sin(2.0 * phi)


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``-8 k_s r^2 cos(2 phi)``."""
    return -8.0 * c[0] * s * s * math.cos(2.0 * phi)


def energy_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k_s r sin^2(phi)``; times dr/dtheta_c = -b it is psi_e (eq. 52)."""
    x = math.sin(phi)
    return 2.0 * c[0] * s * x * x


def torque_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k_s r sin(2 phi)``."""
    return 2.0 * c[0] * s * math.sin(2.0 * phi)


def stiffness_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``4 k_s r cos(2 phi)``."""
    return 4.0 * c[0] * s * math.cos(2.0 * phi)


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative."""
    return -0.25 * math.pi, 0.25 * math.pi


def setpoint_limits(c: Array) -> tuple[float, float]:
    """Return that an arm has a length."""
    return 0.0, math.inf


LEVER = Law(
    name="lever",
    formula=r"k_s s^2\sin 2\varphi",
    constants=(Constant("spring", "N/m", "$k_s$; the set-point $s$ is the lever arm"),),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="AwAS, flacco2012 eqs 49-52",
    energy_setpoint=energy_setpoint,
    torque_setpoint=torque_setpoint,
    stiffness_setpoint=stiffness_setpoint,
    limits=limits,
    setpoint_unit="m",
    setpoint_limits=setpoint_limits,
    cites=("flacco2012",),
)
