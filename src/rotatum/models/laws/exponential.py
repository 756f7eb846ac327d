"""Two exponentials against each other: one motor's side of the DLR BAVS."""

from __future__ import annotations

import math

from rotatum.models.laws.bounded import LARGEST, bounded
from rotatum.models.laws.law import Array, Constant, Law, Vector

__all__ = ["EXPONENTIAL"]


def up(c: Vector, phi: float) -> float:
    """Return ``exp(ke phi)``, the exponent kept where the result is finite."""
    return math.exp(bounded(c[1] * phi))


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``(k / ke) (b e^(ke phi) + a e^(-ke phi) - 2 sqrt(a b))``, as a square."""
    e = up(c, phi)
    root = math.sqrt(c[3] * e) - math.sqrt(c[2] / e)
    return c[0] / c[1] * root * root


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``k (b e^(ke phi) - a e^(-ke phi))``."""
    e = up(c, phi)
    return c[0] * (c[3] * e - c[2] / e)


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``k ke (b e^(ke phi) + a e^(-ke phi))``."""
    e = up(c, phi)
    return c[0] * c[1] * (c[3] * e + c[2] / e)


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``ke^2 tau``."""
    return c[1] * c[1] * torque(c, phi, s)


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``ke^2 sigma``."""
    return c[1] * c[1] * stiffness(c, phi, s)


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the exponential function is left as it is."""
    return -LARGEST / float(c[1]), LARGEST / float(c[1])


EXPONENTIAL = Law(
    name="exponential",
    formula=r"k(b e^{k_e\varphi} - a e^{-k_e\varphi})",
    constants=(
        Constant("k", "N m", "$k$"),
        Constant("ke", "1/rad", "$k_e$"),
        Constant("a", "", "$a$; at rest where $\\varphi = \\ln(a/b) / (2 k_e)$"),
        Constant("b", "", "$b$; the second transmission has $a$ and $b$ exchanged"),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="DLR BAVS, as in the compliant-actuators plugin of the NMMI project",
    limits=limits,
    odd=False,
)
