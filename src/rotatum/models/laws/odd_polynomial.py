"""A sum of odd powers of the deflection (flacco2012 eq. 26)."""

from __future__ import annotations

import numpy as np

from rotatum.models.laws.law import Array, Constant, Law, Values, Vector, firm_range

__all__ = ["ODD_POLYNOMIAL"]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``sum k_i phi^(2i+2) / (2i+2)``."""
    x = phi * phi
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * x + c[i] / (2.0 * i + 2.0)
    return total * x


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``sum k_i phi^(2i+1)``."""
    x = phi * phi
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * x + c[i]
    return total * phi


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``sum (2i+1) k_i phi^(2i)``."""
    x = phi * phi
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * x + (2.0 * i + 1.0) * c[i]
    return total


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``sum (2i+1) 2i k_i phi^(2i-1)``."""
    x = phi * phi
    total = 0.0
    for i in range(len(c) - 1, 0, -1):
        total = total * x + (2.0 * i + 1.0) * 2.0 * i * c[i]
    return total * phi


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``sum (2i+1) 2i (2i-1) k_i phi^(2i-2)``."""
    x = phi * phi
    total = 0.0
    for i in range(len(c) - 1, 0, -1):
        total = total * x + (2.0 * i + 1.0) * 2.0 * i * (2.0 * i - 1.0) * c[i]
    return total


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative."""
    sigma = np.zeros(2 * len(c) - 1)
    sigma[::2] = c * (2.0 * np.arange(len(c)) + 1.0)
    return firm_range(sigma)


def wrong(values: Values) -> str | None:
    """Ask for a torque that grows through rest."""
    first = next((k for k in values["coefficients"] if k != 0.0), 0.0)
    if first <= 0.0:
        return "the first coefficient that is not 0 must be positive: torque grows with deflection"
    return None


ODD_POLYNOMIAL = Law(
    name="odd_polynomial",
    formula=r"k_1\varphi + k_3\varphi^3 + k_5\varphi^5 + \ldots",
    constants=(
        Constant(
            "coefficients",
            "N m/rad, N m/rad^3, ...",
            "$k_1, k_3, k_5, ...$, at least one",
            positive=False,
            many=True,
        ),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="flacco2012 eq. 26",
    limits=limits,
    cites=("flacco2012",),
    wrong=wrong,
)
