"""Hyperbolic sine: one transmission of a qbmove."""

from __future__ import annotations

import math

from rotatum.models.laws.bounded import LARGEST, bounded
from rotatum.models.laws.law import Array, Constant, Law, Vector

__all__ = ["SINH"]


def argument(c: Vector, phi: float) -> float:
    """Return ``a phi``, kept where the exponential function is finite."""
    return bounded(c[1] * phi)


def sine(x: float) -> float:
    """Return ``sinh x``."""
    return 0.5 * (math.exp(x) - math.exp(-x))


def cosine(x: float) -> float:
    """Return ``cosh x``."""
    return 0.5 * (math.exp(x) + math.exp(-x))


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``(k / a) (cosh(a phi) - 1)``, as a square so that it is never below 0."""
    half = sine(0.5 * argument(c, phi))
    return 2.0 * c[0] / c[1] * half * half


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``k sinh(a phi)``."""
    return c[0] * sine(argument(c, phi))


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``k a cosh(a phi)``."""
    return c[0] * c[1] * cosine(argument(c, phi))


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``k a^2 sinh(a phi)``."""
    return c[0] * c[1] * c[1] * sine(argument(c, phi))


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``k a^3 cosh(a phi)``."""
    return c[0] * c[1] * c[1] * c[1] * cosine(argument(c, phi))


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the exponential function is left as it is."""
    return -LARGEST / float(c[1]), LARGEST / float(c[1])


SINH = Law(
    name="sinh",
    formula=r"k\sinh(a\varphi)",
    constants=(Constant("k", "N m", "$k$"), Constant("a", "1/rad", "$a$")),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="each of the two springs of a qbmove (qbrobotics, data sheet)",
    limits=limits,
)
