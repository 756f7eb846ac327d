"""A sum of powers of the deflection, from the first on; no torque at rest."""

from __future__ import annotations

import numpy as np

from rotatum.models.laws.law import Array, Constant, Law, Values, Vector, firm_range

__all__ = ["POLYNOMIAL"]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``sum k_i phi^(i+1) / (i+1)``, powers i = 1, 2, ..."""
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * phi + c[i] / (i + 2.0)
    return total * phi * phi


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``sum k_i phi^i``."""
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * phi + c[i]
    return total * phi


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``sum i k_i phi^(i-1)``."""
    total = 0.0
    for i in range(len(c) - 1, -1, -1):
        total = total * phi + (i + 1.0) * c[i]
    return total


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``sum i (i-1) k_i phi^(i-2)``."""
    total = 0.0
    for i in range(len(c) - 1, 0, -1):
        total = total * phi + (i + 1.0) * i * c[i]
    return total


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``sum i (i-1) (i-2) k_i phi^(i-3)``."""
    total = 0.0
    for i in range(len(c) - 1, 1, -1):
        total = total * phi + (i + 1.0) * i * (i - 1.0) * c[i]
    return total


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative."""
    return firm_range(c * (np.arange(len(c)) + 1.0))


def wrong(values: Values) -> str | None:
    """Ask for a torque that grows through rest: there the lowest power must be odd."""
    numbers = values["coefficients"]
    power = next((i for i, k in enumerate(numbers, 1) if k != 0.0), 0)
    if power % 2 == 0 or numbers[power - 1] < 0.0:
        return (
            "the first coefficient that is not 0 must be positive and belong to an odd power: "
            "torque grows with deflection"
        )
    return None


POLYNOMIAL = Law(
    name="polynomial",
    formula=r"k_1\varphi + k_2\varphi^2 + k_3\varphi^3 + \ldots",
    constants=(
        Constant(
            "coefficients",
            "N m/rad, N m/rad^2, ...",
            "$k_1, k_2, k_3, ...$, at least one",
            positive=False,
            many=True,
        ),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="flacco2012 section 3.2, powers 1 to n",
    limits=limits,
    odd=False,
    cites=("flacco2012",),
    wrong=wrong,
)
