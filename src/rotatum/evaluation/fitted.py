"""Fitted columns back into the quantities they stand for, in the device file's side and units."""

from __future__ import annotations

import math

from rotatum.estimators.tuning import Prepared
from rotatum.record import Records


def fitted_quantities(prepared: Prepared, reading: Records) -> dict[str, tuple[float, float]]:
    """Quantity to (value, standard deviation).

    Coefficients are corrections to the device file's values at the joint; they are added to those
    and taken to the motor's side of the gear: inertia and damping by ``gear_ratio^2``, Coulomb
    friction by ``|gear_ratio|``. ``skew`` (s) is its coefficient over the stiffness; ``offset``
    (N m) and ``transmission_damping`` (N m s/rad) are at the joint.

    Args:
        prepared: the joint's constants and columns.
        reading: the last ``Reading``.
    """
    found: dict[str, tuple[float, float]] = {}
    first = len(prepared.columns) - len(prepared.settings.fit)
    for h, name in enumerate(prepared.settings.fit, start=first):
        value = float(reading["coefficients"][h]) / prepared.scales[h]
        std = float(reading["coefficients_std"][h]) / prepared.scales[h]
        found[name] = _quantity(name, value, std, prepared, reading)
    return found


def _quantity(
    name: str, value: float, std: float, prepared: Prepared, reading: Records
) -> tuple[float, float]:
    if name == "skew":
        sigma, sigma_std = float(reading["stiffness"]), float(reading["stiffness_std"])
        if sigma == 0.0:
            return math.nan, math.inf
        skew = value / sigma
        return skew, math.hypot(std / sigma, skew * sigma_std / sigma)
    if name in ("offset", "transmission_damping"):
        return value, std
    motor = prepared.joint.motors[0]
    n = abs(motor.gear_ratio)
    if name == "inertia":
        return (motor.inertia.value if motor.inertia else 0.0) + value / n**2, std / n**2
    if name == "damping":
        return motor.damping.value + value / n**2, std / n**2
    return motor.coulomb.value + value / n, std / n
