"""How steep Coulomb friction of the motor may be at rest, in an observer that takes it off."""

from __future__ import annotations

import math

import numpy as np

from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.poles import discretise, injection

_DAMPING = 0.5  # of a3: more delays what the observer learns at rest, less takes it for torsion
_MARGIN = 0.5  # of the steepest
_ANGLES = math.pi * np.geomspace(1e-5, 1.0, 500)  # 2 % apart; half of the steepest is kept anyway


def steepest_friction(design: Design) -> float:
    """Return the slope over inertia [1/s] below which the error decays whatever friction does.

    Friction ``B s v`` of the observed speed v, taken off at both ends of an interval, makes of the
    error ``e+ = (Phi - s g h) e``, with ``g = (G0 + G1) e_2`` of `discretise` and h what reads the
    speed from w. By the circle criterion it decays for every s, and every change of s, between 0
    and ``-1 / min Re h (z - Phi)^-1 g`` over the unit circle.

    Args:
        design: an observer.

    Raises:
        MethodError: poles that do not fit the period.
    """
    constants = design.drivetrain
    step = discretise(design.pairs, design.period, design.gyro)
    push = (step.before + step.after)[:, 1]
    speed = np.array([-(constants.damping + constants.motor_damping) / constants.inertia, 1, 0, 0])
    shifted = np.exp(1j * _ANGLES)[:, None, None] * np.eye(4) - step.transition
    response = np.linalg.solve(shifted, np.broadcast_to(push[:, None], (len(shifted), 4, 1)))
    return float(-1.0 / (speed @ response[..., 0].T).real.min())


def friction_slope(design: Design) -> float:
    """Return the slope over inertia [1/s] that friction has at rest.

    Half of a3, the damping of the error, and at most half of `steepest_friction`.

    Args:
        design: an observer.

    Raises:
        MethodError: poles that do not fit the period.
    """
    damping = _DAMPING * float(injection(design.pairs, design.gyro)[0])
    return min(damping, _MARGIN * steepest_friction(design))


def friction_width(design: Design) -> float:
    """Return the motor speed within which friction is linear [rad/s]; 1 where there is none.

    Args:
        design: an observer.

    Raises:
        MethodError: poles that do not fit the period.
    """
    constants = design.drivetrain
    if constants.coulomb == 0.0:
        return 1.0
    return constants.coulomb / (constants.inertia * friction_slope(design))
