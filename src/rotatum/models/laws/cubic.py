"""A linear spring that hardens or softens with the cube of the deflection."""

from __future__ import annotations

import numpy as np

from rotatum.models.laws.law import Array, Constant, Law, Vector, firm_range

__all__ = ["CUBIC"]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``k phi^2 / 2 + k3 phi^4 / 4``."""
    x = phi * phi
    return (0.5 * c[0] + 0.25 * c[1] * x) * x


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``k phi + k3 phi^3``."""
    return (c[0] + c[1] * phi * phi) * phi


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``k + 3 k3 phi^2``."""
    return c[0] + 3.0 * c[1] * phi * phi


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``6 k3 phi``."""
    return 6.0 * c[1] * phi


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``6 k3``."""
    return 6.0 * c[1]


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative."""
    return firm_range(np.array([c[0], 0.0, 3.0 * c[1]]))


CUBIC = Law(
    name="cubic",
    formula=r"k\varphi + k_3\varphi^3",
    constants=(
        Constant("stiffness", "N m/rad", "$k$, at rest"),
        Constant("cubic", "N m/rad^3", "$k_3$", positive=False),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="the first two terms of any odd law",
    limits=limits,
)
