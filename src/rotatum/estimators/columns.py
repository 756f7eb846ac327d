"""The regressors of a transmission: names, powers, scales, and the noise they carry."""

from __future__ import annotations

from typing import NamedTuple

from rotatum.estimators.settings import Settings
from rotatum.kernels import rows
from rotatum.models import Joint

KINDS = {
    "inertia": rows.INERTIA,
    "damping": rows.DAMPING,
    "coulomb": rows.COULOMB,
    "skew": rows.SKEW,
    "transmission_damping": rows.TRANSMISSION_DAMPING,
    "offset": rows.OFFSET,
    "link_damping": rows.LINK_DAMPING,
    "link_coulomb": rows.LINK_COULOMB,
    "gravity_torque": rows.GRAVITY_TORQUE,
    "payload": rows.PAYLOAD,
}
SOMEWHERE = 0.01  # rad; with a single power the range only scales: a middling elastic joint


class Power(NamedTuple):
    """A term of the basis, ``x^deflection s^setpoint`` in normalised coordinates."""

    deflection: int
    setpoint: int

    @property
    def name(self) -> str:
        """As in tables: ``constant``, ``phi^3``, ``phi^1 s^2``."""
        phi = f"phi^{self.deflection}"
        if self.setpoint:
            return f"{phi} s^{self.setpoint}"
        return phi if self.deflection else "constant"


def powers_of(joint: Joint, method: str = "weak", together: bool = False) -> tuple[Power, ...]:
    """Terms of a joint's basis from low to high order (flacco2012 eqs 26, 29, 36).

    Odd powers of the deflection, or with ``full`` all from 0, times powers of the set-point.

    Args:
        joint: as described.
        method: ``algebraic`` and ``rotatum`` see no constant (menard2013 eq. 18 starts from phi^1).
        together: whether two transmissions share a row: each term comes twice, agonist's first.
    """
    basis = joint.basis
    own = range(basis.orders) if basis.full else range(1, 2 * basis.orders, 2)
    found = [Power(i, j) for i in own for j in range(basis.setpoint_orders + 1)]
    if method in ("algebraic", "rotatum"):
        found = [power for power in found if power != Power(0, 0)]
    ordered = sorted(found, key=lambda power: (sum(power), power.deflection))
    return tuple(power for power in ordered for _ in range(2 if together else 1))


def first_shrunk(powers: tuple[Power, ...], fitted: int) -> int:
    """Index of the first column that is shrunk: after fitted ones, constants and straight lines."""
    return fitted + sum(1 for power in powers if sum(power) <= 1)


def deflection_range(joint: Joint) -> float:
    """Deflection at which the scaled one is 1, rad."""
    return joint.basis.deflection_range or SOMEWHERE


class SetpointScale(NamedTuple):
    """Normalisation of the set-point: 0 at the middle of its range, +-1 at its ends.

    Args:
        middle, half: of the range, in the unit of the law's set-point.
        logged_middle, logged_half: the same in terms of what is logged.
    """

    middle: float
    half: float
    logged_middle: float
    logged_half: float


def setpoint_scale(joint: Joint) -> SetpointScale:
    """Scale of a joint's set-point; the lever law of what is logged is an affine part of it."""
    low, high = joint.basis.setpoint_range or (-1.0, 1.0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    if joint.setpoint is None:
        return SetpointScale(middle, half, middle, half)
    slope, start = joint.setpoint.slope, joint.setpoint.value(0.0)
    return SetpointScale(middle, half, (middle - start) / slope, half / slope)


def fit_scales(joint: Joint, settings: Settings) -> tuple[float, ...]:
    """Typical size of each fitted column, within a few orders: the prior is relative to it."""
    scale = {
        "inertia": settings.cutoff,
        "transmission_damping": deflection_range(joint) * settings.cutoff,
    }
    return tuple(scale.get(name, 1.0) for name in settings.fit)


def basis_scales(joint: Joint, powers: tuple[Power, ...]) -> tuple[float, ...]:
    """What the basis' coefficients are divided by to be in SI at the joint."""
    half = setpoint_scale(joint).half
    return tuple(deflection_range(joint) ** p.deflection * half**p.setpoint for p in powers)


def known_std(joint: Joint, name: str, motor: int) -> float:
    """Standard deviation of what the device file says, at the joint; 0: it says nothing."""
    value = None
    if name.startswith("link_") and joint.link is not None:
        value = {"link_damping": joint.link.damping, "link_coulomb": joint.link.coulomb}[name]
    elif joint.motors:
        described = joint.motors[motor]
        value = {
            "inertia": described.reflected_inertia,
            "damping": described.reflected_damping,
            "coulomb": described.reflected_coulomb,
        }.get(name)
    return value.std or 0.0 if value is not None else 0.0
