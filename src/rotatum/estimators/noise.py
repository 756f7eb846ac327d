"""What the noise of the positions does to the columns of a row, and to its left side."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rotatum.estimators.columns import Power, deflection_range, fit_scales
from rotatum.estimators.operators import CENTRED, OBSERVER, Operator
from rotatum.estimators.settings import Settings
from rotatum.models import Joint

BOX = {1: (0.5, 0.0, -0.5), 2: tuple(np.convolve((0.5, 0.0, -0.5), (-1, 8, 0, -8, 1)) / 12.0)}
"""Differences of an arm's momentum: across a box, of velocities across five samples."""


class ColumnNoise(NamedTuple):
    """Noise in the columns, fitted ones first.

    Args:
        columns: variance of each scaled column.
        acceleration: variance of the acceleration the residual is held against.
        common: (p,) covariance of each scaled column with the noise of the left side that what is
            known of the load puts there, but for the column's own quantity.
    """

    columns: tuple[float, ...]
    acceleration: float
    common: tuple[float, ...]


def column_noise(
    joint: Joint, settings: Settings, powers: tuple[Power, ...], inertia: float, arm: bool
) -> ColumnNoise:
    """Noise that white noise of the positions gives to each scaled column and the left side.

    With n the noise of the position that is differentiated (the motor's, or the link's from its
    side), ``y`` has ``B <n''>`` in it and the deflection ``-n`` (``-M <n''>`` and ``n``): their
    covariance is ``B var(<n'>)`` either way, because ``<n n''> = -<n'^2>``.

    Args:
        joint: scales.
        settings: operator, noise, columns.
        powers: of the basis.
        inertia: at the joint that is known and not fitted, kg m^2.
        arm: whether the load comes from an arm.
    """
    link, motor = (std**2 for std in settings.noise)
    operator = settings.operator
    if operator.kind == OBSERVER:
        return _rate_noise(joint, operator, link, motor, powers, inertia)
    if settings.method == "residual":
        # Its basis is not filtered as its left side is: they have next to nothing in common.
        operator, inertia = replace(operator, order=0), 0.0
    taps = BOX if arm else CENTRED
    still, speed = operator.noise_gain(0), operator.noise_gain(1)
    bend = operator.noise_gain(2, np.array(taps[2]))
    own = link if settings.side == "link" else motor
    raw = {
        "inertia": motor * bend,
        "damping": motor * speed,
        "skew": (motor if settings.side == "link" else link) * speed,
        "link_damping": link * speed,
        "transmission_damping": (link + motor) * speed,
    }
    scales = fit_scales(joint, settings)
    fitted = [raw.get(n, 0.0) / s**2 for n, s in zip(settings.fit, scales, strict=True)]
    x = deflection_range(joint)
    basis = [(link + motor) * still / x**2 * line for line in _lines(powers)]
    reach = np.zeros(len(taps[2]))
    reach[len(reach) // 2] = 1.0
    both = -operator.cross_gain(reach, np.array(taps[2])) / operator.period**2
    # The constant column of s^0 alone is straight; higher powers of s average out.
    straight = [own * both * inertia / x if p == (1, 0) else 0.0 for p in powers]
    common = (*(0.0 for _ in fitted), *straight)
    return ColumnNoise((*fitted, *basis), own * bend, common)


def _lines(powers: tuple[Power, ...]) -> list[float]:
    """Mean square of what multiplies a straight line: s is spread over -1 to 1."""
    return [1.0 / (2.0 * p.setpoint + 1.0) if p.deflection == 1 else 0.0 for p in powers]


def _rate_noise(
    joint: Joint,
    operator: Operator,
    link: float,
    motor: float,
    powers: tuple[Power, ...],
    inertia: float,
) -> ColumnNoise:
    """Noise of rows of the rotatum: ``-M`` times the jerk's, and the rate's in the straight column.

    Both come out of the same observer, whose covariance is known exactly; that of jerk and rate is
    negative, and pulls the stiffness up.
    """
    covariance = operator.observer.recursion.noise()
    x = deflection_range(joint)
    columns = [(link + motor) * covariance[1, 1] / x**2 * line for line in _lines(powers)]
    straight = [-inertia * link * covariance[3, 1] / x if p == (1, 0) else 0.0 for p in powers]
    return ColumnNoise(tuple(columns), link * covariance[3, 3], tuple(straight))
