"""Fitted columns back into the quantities they stand for, in the device file's side and units."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.tuning import Prepared

Values = NDArray[np.float64]


def fitted_quantities(
    prepared: Prepared,
    part: int,
    values: Values,
    stds: Values,
    sigma: float,
    sigma_std: float,
    unknown: Collection[str] = (),
) -> dict[str, tuple[float, float]]:
    """Quantity to (value, standard deviation), for one transmission.

    Coefficients are corrections to the device file's values at the joint; they are added to those
    and taken to the motor's side of the gear: inertia and damping by ``gear_ratio^2``, Coulomb
    friction by ``|gear_ratio|``. Those of the link are at the joint, ``payload`` is in kg. ``skew``
    (s) is its coefficient over the stiffness; ``offset`` (N m) and ``transmission_damping``
    (N m s/rad) are at the joint.

    Args:
        prepared: the joint's constants and columns.
        part: which transmission.
        values, stds: (p,) its coefficients and their standard deviations, normalised.
        sigma, sigma_std: its stiffness, N m/rad.
        unknown: quantities the data do not tell: NaN with an infinite deviation, never a number.
    """
    found: dict[str, tuple[float, float]] = {}
    for h, name in enumerate(prepared.settings.fit):
        value = float(values[h]) / prepared.scales[h]
        std = float(stds[h]) / prepared.scales[h]
        if name in unknown:
            found[name] = math.nan, math.inf
        elif name == "skew":
            found[name] = _skew(value, std, sigma, sigma_std)
        else:
            found[name] = _quantity(name, value, std, prepared, part)
    return found


def _skew(value: float, std: float, sigma: float, sigma_std: float) -> tuple[float, float]:
    if sigma == 0.0:
        return math.nan, math.inf
    skew = value / sigma
    return skew, math.hypot(std / sigma, skew * sigma_std / sigma)


def _quantity(
    name: str, value: float, std: float, prepared: Prepared, part: int
) -> tuple[float, float]:
    if name in ("offset", "transmission_damping", "payload"):
        return value, std
    if name in ("link_damping", "link_coulomb", "gravity_torque"):
        return value + _of_link(name, prepared), std
    motor = prepared.joint.motors[part]
    n = abs(motor.gear_ratio)
    if name == "inertia":
        return (motor.inertia.value if motor.inertia else 0.0) + value / n**2, std / n**2
    if name == "damping":
        return motor.damping.value + value / n**2, std / n**2
    return motor.coulomb.value + value / n, std / n


def _of_link(name: str, prepared: Prepared) -> float:
    """What the device file says of it."""
    link = prepared.joint.link
    if link is None:
        return 0.0
    known = {
        "link_damping": link.damping.value,
        "link_coulomb": link.coulomb.value,
        "gravity_torque": link.gravity_torque,
    }
    return known[name]
