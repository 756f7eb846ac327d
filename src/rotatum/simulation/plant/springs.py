"""What lies between motor and link beside the law, as kernels: play, hysteresis, drift."""

from __future__ import annotations

import math
from typing import Any


def deform(params: Any, state: Any) -> None:
    """Set-point and stretch of the springs at the trial point.

    Play is in series with the spring: it takes up ``clip(x, -b / 2, b / 2)`` of what the
    deflection and the preload make together.
    """
    motors = len(state.stretch)
    state.setpoint = params.offset + params.slope * state.trial_position[motors + 1]
    for m in range(motors):
        deflection = state.trial_position[0] - state.trial_position[m + 1]
        state.stretch[m] = deflection + params.preload[m]
        state.contact[m] = 1.0
        if params.half_play != 0.0:
            _play(params, state, m)


def _play(params: Any, state: Any, m: int) -> None:
    x = state.stretch[m]
    if x > params.half_play:
        state.stretch[m] = x - params.half_play
    elif x < -params.half_play:
        state.stretch[m] = x + params.half_play
    else:
        state.stretch[m] = 0.0
        state.contact[m] = 0.0


def drift(state: Any, u: Any, share: float) -> None:
    """Factor on the springs at a share of the period."""
    state.scale = u.scale + share * (u.next_scale - u.scale)


def hysteresis_rate(params: Any, state: Any) -> None:
    """Rate of Dahl's model at the trial point, ``z' = (phi' - |phi'| z) / d``."""
    for m in range(len(state.stretch)):
        state.hysteresis_rate[m] = 0.0
        if params.hysteresis_torque != 0.0:
            rate = state.trial_velocity[0] - state.trial_velocity[m + 1]
            z = state.trial_hysteresis[m]
            state.hysteresis_rate[m] = (rate - math.fabs(rate) * z) / params.hysteresis_deflection


def recall(params: Any, state: Any) -> None:
    """Hysteresis at the trial point, one way from where the step began.

    Dahl's model depends on the path only, not on time (Dahl 1968): there is nothing to integrate
    that a fast motion could make unstable.
    """
    for m in range(len(state.stretch)):
        start = state.position[0] - state.position[m + 1]
        way = state.trial_position[0] - state.trial_position[m + 1] - start
        state.trial_hysteresis[m] = dahl(params, state.hysteresis[m], way)


def remember(params: Any, state: Any) -> None:
    """Hysteresis at the end of a step, before its positions and velocities are taken.

    Where the deflection turned on the way it goes there and back: the turning point is that of a
    velocity that changes evenly, seen from both ends.
    """
    sixth = params.step / 6.0
    for m in range(len(state.stretch)):
        way = sixth * (state.velocity_sum[0] - state.velocity_sum[m + 1])
        speed = state.velocity[0] - state.velocity[m + 1]
        after = speed + sixth * (state.acceleration_sum[0] - state.acceleration_sum[m + 1])
        if speed * after < 0.0:
            squares = speed * speed + after * after
            turn = 0.5 * way + 0.25 * params.step * squares / (speed - after)
            state.hysteresis[m] = dahl(params, state.hysteresis[m], turn)
            way = way - turn
        state.hysteresis[m] = dahl(params, state.hysteresis[m], way)


def dahl(params: Any, z: float, way: float) -> float:
    """Solution of ``z' = (phi' - |phi'| z) / d`` over a way in one direction s.

    ``s - (s - z) exp(-|way| / d)``.
    """
    left = math.exp(-math.fabs(way) / params.hysteresis_deflection)
    if way < 0.0:
        return (1.0 + z) * left - 1.0
    return 1.0 - (1.0 - z) * left
