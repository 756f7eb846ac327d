"""The four-bar transmission of the VSA-II (flacco2012 eqs 47-48)."""

from __future__ import annotations

import math

from rotatum.models.laws.law import Array, Constant, Law, Values, Vector

__all__ = ["FOURBAR"]

NEAREST = 0.999  # of C sin(phi/2), which is 1 where the linkage locks and the stiffness is infinite


def edge(c: Vector) -> float:
    """Return the largest deflection at which the law is evaluated [rad]."""
    return 2.0 * math.asin(NEAREST / c[1])


def inside(c: Vector, phi: float) -> float:
    """Return the deflection, kept inside the range."""
    largest = edge(c)
    if phi > largest:
        return largest
    if phi < -largest:
        return -largest
    return phi


def sine(c: Vector, p: float) -> float:
    """Return ``x = C sin(p / 2)``, of which beta takes the inverse sine."""
    return c[1] * math.sin(0.5 * p)


def cosine(c: Vector, p: float) -> float:
    """Return ``x' = (C / 2) cos(p / 2)``."""
    return 0.5 * c[1] * math.cos(0.5 * p)


def beta(c: Vector, p: float) -> float:
    """Return ``asin(x) - p / 2`` (eq. 48)."""
    return math.asin(sine(c, p)) - 0.5 * p


def beta1(c: Vector, p: float) -> float:
    """Return ``beta' = x' / w - 1/2`` with ``w^2 = 1 - x^2``."""
    x = sine(c, p)
    return cosine(c, p) / math.sqrt(1.0 - x * x) - 0.5


def beta2(c: Vector, p: float) -> float:
    """Return ``beta'' = g x / w^3`` with ``g = (C^2 - 1) / 4``."""
    x = sine(c, p)
    w2 = 1.0 - x * x
    return 0.25 * (c[1] * c[1] - 1.0) * x / (w2 * math.sqrt(w2))


def beta3(c: Vector, p: float) -> float:
    """Return ``beta''' = g x' (1 + 2 x^2) / w^5``."""
    x = sine(c, p)
    w2 = 1.0 - x * x
    return (
        0.25 * (c[1] * c[1] - 1.0) * cosine(c, p) * (1.0 + 2.0 * x * x) / (w2 * w2 * math.sqrt(w2))
    )


def beta4(c: Vector, p: float) -> float:
    """Return ``beta'''' = g (x'' (1 + 2 x^2) w^2 + x'^2 (9 x + 6 x^3)) / w^7``."""
    x = sine(c, p)
    w2 = 1.0 - x * x
    rate = cosine(c, p)
    first = -0.25 * x * (1.0 + 2.0 * x * x) * w2
    second = rate * rate * x * (9.0 + 6.0 * x * x)
    return 0.25 * (c[1] * c[1] - 1.0) * (first + second) / (w2 * w2 * w2 * math.sqrt(w2))


def torque_at(c: Vector, p: float) -> float:
    """Return ``2 k beta beta'`` (eq. 47)."""
    return 2.0 * c[0] * beta(c, p) * beta1(c, p)


def stiffness_at(c: Vector, p: float) -> float:
    """Return ``2 k (beta'^2 + beta beta'')``."""
    rate = beta1(c, p)
    return 2.0 * c[0] * (rate * rate + beta(c, p) * beta2(c, p))


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``k beta^2``; beyond the range what the last stiffness adds."""
    p = inside(c, phi)
    b = beta(c, p)
    d = phi - p
    return c[0] * b * b + (torque_at(c, p) + 0.5 * stiffness_at(c, p) * d) * d


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k beta beta'`` (eq. 47); beyond the range it goes on with the last stiffness."""
    p = inside(c, phi)
    return torque_at(c, p) + stiffness_at(c, p) * (phi - p)


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k (beta'^2 + beta beta'')``; beyond the range it stays."""
    return stiffness_at(c, inside(c, phi))


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k (3 beta' beta'' + beta beta''')``; beyond the range 0."""
    p = inside(c, phi)
    if p != phi:
        return 0.0
    return 2.0 * c[0] * (3.0 * beta1(c, p) * beta2(c, p) + beta(c, p) * beta3(c, p))


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``2 k (3 beta''^2 + 4 beta' beta''' + beta beta'''')``; beyond the range 0."""
    p = inside(c, phi)
    if p != phi:
        return 0.0
    bend = beta2(c, p)
    middle = 3.0 * bend * bend + 4.0 * beta1(c, p) * beta3(c, p)
    return 2.0 * c[0] * (middle + beta(c, p) * beta4(c, p))


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where ``C sin(phi/2)`` stays 0.1 % below 1."""
    largest = edge(c)
    return -largest, largest


def wrong(values: Values) -> str | None:
    """Ask for C > 1; with C = 1 there is no torque at all."""
    return None if values["ratio"][0] > 1.0 else "ratio must be greater than 1"


FOURBAR = Law(
    name="fourbar",
    formula=r"2 k\beta\beta', \quad \beta = \arcsin(C\sin(\varphi/2)) - \varphi/2",
    constants=(
        Constant("spring", "N m/rad", "$k$"),
        Constant("ratio", "", "$C > 1$; the linkage locks at $2\\arcsin(1/C)$"),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="VSA-II, flacco2012 eqs 47-48",
    limits=limits,
    cites=("flacco2012",),
    wrong=wrong,
)
