"""A lever whose pivot moves: AwAS-II, as the NMMI compliant-actuators plugin models it."""

from __future__ import annotations

import math

from rotatum.models.laws.law import Array, Constant, Law, Vector

__all__ = ["LEVER_RATIO"]

NEAREST = 0.999  # of L: a pivot at the lever's end would make the joint rigid


def pivot(c: Vector, s: float) -> float:
    """Return the pivot's place, kept on the lever [m]."""
    if s < 0.0:
        return 0.0
    if s > NEAREST * c[1]:
        return NEAREST * c[1]
    return s


def ratio(c: Vector, s: float) -> float:
    """Return ``m = (L / r_t) s / (L - s)``."""
    x = pivot(c, s)
    return c[1] / c[2] * x / (c[1] - x)


def ratio_slope(c: Vector, s: float) -> float:
    """Return ``dm/ds = (L / r_t) L / (L - s)^2``; 0 beyond the lever's ends."""
    x = pivot(c, s)
    if x != s:
        return 0.0
    rest = c[1] - x
    return c[1] / c[2] * c[1] / (rest * rest)


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``K_s m^2 sin^2(phi)``."""
    y = ratio(c, s) * math.sin(phi)
    return c[0] * y * y


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``K_s m^2 sin(2 phi)``."""
    m = ratio(c, s)
    return c[0] * m * m * math.sin(2.0 * phi)


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``2 K_s m^2 cos(2 phi)``."""
    m = ratio(c, s)
    return 2.0 * c[0] * m * m * math.cos(2.0 * phi)


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``-4 K_s m^2 sin(2 phi)``."""
    return -4.0 * torque(c, phi, s)


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``-8 K_s m^2 cos(2 phi)``."""
    return -4.0 * stiffness(c, phi, s)


def energy_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``2 K_s m m' sin^2(phi)``."""
    x = math.sin(phi)
    return 2.0 * c[0] * ratio(c, s) * ratio_slope(c, s) * x * x


def torque_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``2 K_s m m' sin(2 phi)``."""
    return 2.0 * c[0] * ratio(c, s) * ratio_slope(c, s) * math.sin(2.0 * phi)


def stiffness_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``4 K_s m m' cos(2 phi)``."""
    return 4.0 * c[0] * ratio(c, s) * ratio_slope(c, s) * math.cos(2.0 * phi)


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative."""
    return -0.25 * math.pi, 0.25 * math.pi


def setpoint_limits(c: Array) -> tuple[float, float]:
    """Return the places on the lever."""
    return 0.0, NEAREST * float(c[1])


LEVER_RATIO = Law(
    name="lever_ratio",
    formula=r"K_s m^2\sin 2\varphi, \quad m = \frac{L}{r_t}\,\frac{s}{L - s}",
    constants=(
        Constant("spring", "N m/rad", "$K_s$"),
        Constant("length", "m", "$L$; the set-point $s$ is the pivot's place on the lever"),
        Constant("arm", "m", "$r_t$"),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="AwAS-II, as in the compliant-actuators plugin of the NMMI project",
    energy_setpoint=energy_setpoint,
    torque_setpoint=torque_setpoint,
    stiffness_setpoint=stiffness_setpoint,
    limits=limits,
    setpoint_unit="m",
    setpoint_limits=setpoint_limits,
)
