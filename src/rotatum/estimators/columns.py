"""The regressors of a transmission: names, powers, scales, and the noise they carry."""

from __future__ import annotations

import math
from typing import NamedTuple

from rotatum.estimators.gains import noise_gain
from rotatum.estimators.settings import MOTOR_COLUMNS, Settings
from rotatum.kernels import rows
from rotatum.models import Joint

KINDS = {
    "inertia": rows.INERTIA,
    "damping": rows.DAMPING,
    "coulomb": rows.COULOMB,
    "skew": rows.SKEW,
    "transmission_damping": rows.TRANSMISSION_DAMPING,
    "offset": rows.OFFSET,
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


def powers_of(joint: Joint) -> tuple[Power, ...]:
    """Terms of a joint's basis from low to high order (flacco2012 eqs 26, 29, 36).

    Odd powers of the deflection, or with ``full`` all from 0, times powers of the set-point.
    """
    basis = joint.basis
    own = range(basis.orders) if basis.full else range(1, 2 * basis.orders, 2)
    found = [Power(i, j) for i in own for j in range(basis.setpoint_orders + 1)]
    return tuple(sorted(found, key=lambda power: (sum(power), power.deflection)))


def first_shrunk(joint: Joint, fitted: int) -> int:
    """Index of the first column that is shrunk: after fitted ones, constant and straight line."""
    return fitted + 1 + [sum(p) for p in powers_of(joint)].index(1)


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
        "damping": 1.0,
        "coulomb": 1.0,
        "skew": 1.0,
        "transmission_damping": deflection_range(joint) * settings.cutoff,
        "offset": 1.0,
    }
    return tuple(scale[name] for name in settings.fit)


def basis_scales(joint: Joint) -> tuple[float, ...]:
    """What the basis' coefficients are divided by to be in SI at the joint."""
    half = setpoint_scale(joint).half
    return tuple(
        deflection_range(joint) ** p.deflection * half**p.setpoint for p in powers_of(joint)
    )


class ColumnNoise(NamedTuple):
    """Variance the encoders give each column, fitted ones first, and the inertia's column's."""

    columns: tuple[float, ...]
    acceleration: float


def column_noise(joint: Joint, settings: Settings, period: float) -> ColumnNoise:
    """Variance that quantisation gives each scaled column."""
    link, motor = ((joint.encoders.resolution(end) or 0.0) ** 2 / 12.0 for end in ("link", "motor"))
    pole = math.exp(-settings.cutoff * period) if settings.method == "weak" else 0.0
    still, speed, bend = (noise_gain(pole, order, period) for order in range(3))
    scale = dict(zip(settings.fit, fit_scales(joint, settings), strict=True))
    raw = {
        "inertia": motor * bend,
        "damping": motor * speed,
        "coulomb": 0.0,
        "skew": link * speed,
        "transmission_damping": (link + motor) * speed,
        "offset": 0.0,
    }
    phi = (link + motor) * still / deflection_range(joint) ** 2
    # s is spread over -1 to 1: the mean of s^2j is 1 / (2 j + 1).
    own = tuple(
        phi / (2.0 * p.setpoint + 1.0) if p.deflection == 1 else 0.0 for p in powers_of(joint)
    )
    fitted = tuple(raw[name] / scale[name] ** 2 for name in settings.fit)
    return ColumnNoise(fitted + own, motor * bend)


def known_std(joint: Joint, name: str, motor: int) -> float:
    """Standard deviation of what the device file says, at the joint; 0: it says nothing."""
    if name not in MOTOR_COLUMNS[:3] or not joint.motors:
        return 0.0
    described = joint.motors[motor]
    value = {
        "inertia": described.reflected_inertia,
        "damping": described.reflected_damping,
        "coulomb": described.reflected_coulomb,
    }[name]
    return value.std or 0.0 if value is not None else 0.0
