"""MACCEPA: a spring between a lever and a base, with a motor that pulls on it."""

from __future__ import annotations

import math

from rotatum.models.laws.law import Array, Constant, Law, Values, Vector

__all__ = ["MACCEPA"]

_STEPS = 400  # of the scan for the deflection at which the stiffness ends; then halved
_HALVINGS = 60


def inverse(c: Vector, phi: float) -> float:
    """Return ``h = 1 / A``, A the distance ``sqrt(B^2 + C^2 - 2 B C cos(phi))`` [1/m]."""
    return 1.0 / math.sqrt(c[1] * c[1] + c[2] * c[2] - 2.0 * c[1] * c[2] * math.cos(phi))


def inverse1(c: Vector, phi: float) -> float:
    """Return ``h' = -g sin(phi) h^3`` with ``g = B C``."""
    h = inverse(c, phi)
    return -c[1] * c[2] * math.sin(phi) * h * h * h


def inverse2(c: Vector, phi: float) -> float:
    """Return ``h'' = -g cos(phi) h^3 + 3 g^2 sin^2(phi) h^5``."""
    h = inverse(c, phi)
    h3 = h * h * h
    g = c[1] * c[2]
    x = g * math.sin(phi)
    return 3.0 * x * x * h3 * h * h - g * math.cos(phi) * h3


def inverse3(c: Vector, phi: float) -> float:
    """Return ``h''' = g sin h^3 + 9 g^2 sin cos h^5 - 15 g^3 sin^3 h^7``."""
    h = inverse(c, phi)
    h2 = h * h
    g = c[1] * c[2]
    x = g * math.sin(phi)
    return x * h2 * h * (1.0 + 9.0 * g * math.cos(phi) * h2 - 15.0 * x * x * h2 * h2)


def pull(c: Vector, s: float) -> float:
    """Return ``P = r s - (C - B)``: the spring's extension less the distance A [m]."""
    return c[3] * s - (c[2] - c[1])


def energy(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa (A + P)^2 / 2``, the pretension's included: 0 where phi and s are 0."""
    x = 1.0 / inverse(c, phi) + pull(c, s)
    return 0.5 * c[0] * x * x


def torque(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C sin(phi) (1 + P / A)``."""
    return c[0] * c[1] * c[2] * math.sin(phi) * (1.0 + pull(c, s) * inverse(c, phi))


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C (cos + P (cos h + sin h'))``."""
    sine = math.sin(phi)
    cosine = math.cos(phi)
    inner = cosine * inverse(c, phi) + sine * inverse1(c, phi)
    return c[0] * c[1] * c[2] * (cosine + pull(c, s) * inner)


def slope(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C (-sin + P (-sin h + 2 cos h' + sin h''))``."""
    sine = math.sin(phi)
    cosine = math.cos(phi)
    inner = sine * (inverse2(c, phi) - inverse(c, phi)) + 2.0 * cosine * inverse1(c, phi)
    return c[0] * c[1] * c[2] * (pull(c, s) * inner - sine)


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C (-cos + P (-cos h - 3 sin h' + 3 cos h'' + sin h'''))``."""
    sine = math.sin(phi)
    cosine = math.cos(phi)
    inner = cosine * (3.0 * inverse2(c, phi) - inverse(c, phi))
    inner = inner + sine * (inverse3(c, phi) - 3.0 * inverse1(c, phi))
    return c[0] * c[1] * c[2] * (pull(c, s) * inner - cosine)


def energy_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa r (A + P)``: the spring's force times the drum's radius."""
    return c[0] * c[3] * (1.0 / inverse(c, phi) + pull(c, s))


def torque_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C r sin(phi) / A``."""
    return c[0] * c[1] * c[2] * c[3] * math.sin(phi) * inverse(c, phi)


def stiffness_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return ``kappa B C r (cos h + sin h')``."""
    inner = math.cos(phi) * inverse(c, phi) + math.sin(phi) * inverse1(c, phi)
    return c[0] * c[1] * c[2] * c[3] * inner


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return where the stiffness is not negative: up to its first zero beyond rest."""
    step = math.pi / _STEPS
    low = step
    while low < math.pi and stiffness(c, low + step, s) >= 0.0:
        low += step
    high = low + step
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if stiffness(c, middle, s) >= 0.0:
            low = middle
        else:
            high = middle
    return -low, low


def setpoint_limits(c: Array) -> tuple[float, float]:
    """Return that the drum pulls and does not push."""
    return 0.0, math.inf


def wrong(values: Values) -> str | None:
    """Ask for a lever shorter than the base's distance."""
    shorter = values["lever"][0] < values["base"][0]
    return None if shorter else "lever must be less than base"


MACCEPA = Law(
    name="maccepa",
    formula=(
        r"\kappa B C\sin\varphi\left(1 + \frac{r s - (C - B)}"
        r"{\sqrt{B^2 + C^2 - 2 B C\cos\varphi}}\right)"
    ),
    constants=(
        Constant("spring", "N/m", "$\\kappa$"),
        Constant("lever", "m", "$B$"),
        Constant("base", "m", "$C > B$"),
        Constant("drum", "m", "$r$; the set-point $s$ is the angle of the drum"),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="MACCEPA (Van Ham et al. 2007)",
    energy_setpoint=energy_setpoint,
    torque_setpoint=torque_setpoint,
    stiffness_setpoint=stiffness_setpoint,
    limits=limits,
    setpoint_unit="rad",
    setpoint_limits=setpoint_limits,
    wrong=wrong,
)
