"""The linear spring."""

from __future__ import annotations

from rotatum.models.laws.law import Constant, Law, Vector

__all__ = ["LINEAR"]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``k phi^2 / 2``."""
    return 0.5 * c[0] * phi * phi


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``k phi``."""
    return c[0] * phi


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``k``."""
    return c[0]


def slope(c: Vector, phi: float, s: float) -> float:
    """Return 0."""
    return 0.0


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return 0."""
    return 0.0


LINEAR = Law(
    name="linear",
    formula=r"k\varphi",
    constants=(Constant("stiffness", "N m/rad", "$k$"),),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="series-elastic actuators, harmonic drives near their working torque",
)
