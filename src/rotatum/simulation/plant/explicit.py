"""Kernels of Dormand and Prince's method of order 8, a joint's part of an arm's step.

Hairer, Norsett, Wanner: Solving Ordinary Differential Equations I, section II.10; the coefficients
are scipy's. An arm asks its robot for the links' accelerations between two looks at the drive
trains, so that a step is taken in parts: 0 looks where the sample begins; 1 to 11 and 12 at the
inner points and at the end; 13 takes the step and estimates its error; 14 goes back to where the
sample began.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.record import Record, Records, integer, matrix, number, vector

__all__ = ["BACK", "END", "TAKE", "MarchInput", "MarchParams", "MarchState", "write_method"]

INNER = 12  # parts that look, from the first to the last but one
END, TAKE, BACK = 12, 13, 14
# Estimated errors of one step that are let pass; the true ones are a hundred times smaller.
ANGLE_ERROR = 1e-8  # [rad]
VELOCITY_ERROR = 1e-6  # [rad/s]
HYSTERESIS_ERROR = 1e-6  # [1]


class MarchParams(Record):
    """The method's coefficients."""

    inner = matrix(INNER + 1, INNER, "weights of the slopes, by part", symbol="a")
    fifth = vector(INNER + 1, "weights of the fifth-order error")
    third = vector(INNER + 1, "weights of the third-order error")


class MarchState(Record):
    """Where a joint is between steps, and the slopes of the step it is in."""

    y = vector("N", "positions, velocities, hysteresis")
    began = vector("N", "the same where the sample began")
    slopes = matrix(INNER + 1, "N", "dy/dt by part")
    first = vector("N", "dy/dt where the sample began")
    error = number("of the last step, over what is let pass")


class MarchInput(Record):
    """The part of the step, and what the robot said about the last one."""

    part = integer("0 to 14")
    fresh = integer("1: the part before was 0")
    step = number("its length", unit="s", symbol="h")
    ddq = number("of the link", unit="rad/s^2")
    coupled = integer("1: `ddtheta` stands for what the motors' equations say")
    ddtheta = number("of the motor", unit="rad/s^2")


def write_method(params: Records) -> None:
    """Write the coefficients to records (n,)."""
    from scipy.integrate import DOP853

    params["inner"][:, :INNER] = DOP853.A
    params["inner"][:, END] = DOP853.B
    params["fifth"] = DOP853.E5
    params["third"] = DOP853.E3


def start(params: Any, march: Any, train: Any) -> None:
    """Stand where the drive train stands."""
    bodies = len(train.position)
    for j in range(bodies):
        march.y[j] = train.position[j]
        march.y[bodies + j] = train.velocity[j]
    for m in range(len(train.hysteresis)):
        march.y[2 * bodies + m] = 0.0


def remember(march: Any, train: Any, u: Any) -> None:
    """Keep the slopes of the part before, with the accelerations the robot found."""
    part = u.part - 1
    if part == 0 and u.fresh == 0:
        return
    bodies = len(train.position)
    train.acceleration[0] = u.ddq
    if u.coupled == 1:
        train.acceleration[1] = u.ddtheta
    for j in range(bodies):
        march.slopes[part, j] = train.trial_velocity[j]
        march.slopes[part, bodies + j] = train.acceleration[j]
    for m in range(len(train.hysteresis)):
        march.slopes[part, 2 * bodies + m] = train.hysteresis_rate[m]
    if part == 0:
        for i in range(len(march.y)):
            march.began[i] = march.y[i]
            march.first[i] = march.slopes[0, i]


def place(params: Any, march: Any, train: Any, u: Any) -> None:
    """Put the drive train where this part looks."""
    bodies = len(train.position)
    for j in range(bodies):
        train.trial_position[j] = _point(params, march, u, j)
        train.trial_velocity[j] = _point(params, march, u, bodies + j)
    for m in range(len(train.hysteresis)):
        train.trial_hysteresis[m] = _point(params, march, u, 2 * bodies + m)


def _point(params: Any, march: Any, u: Any, i: int) -> float:
    total: float = 0.0
    for k in range(u.part):
        total = total + params.inner[u.part, k] * march.slopes[k, i]
    here: float = march.y[i] + u.step * total
    return here


def take(params: Any, march: Any, train: Any, u: Any) -> None:
    """Be where the step ends, and estimate its error as scipy does."""
    bodies = len(train.position)
    a = 0.0
    b = 0.0
    size = len(march.y)
    for i in range(size):
        fifth = 0.0
        third = 0.0
        for k in range(END + 1):
            fifth = fifth + params.fifth[k] * march.slopes[k, i]
            third = third + params.third[k] * march.slopes[k, i]
        allowed = ANGLE_ERROR
        if i >= bodies:
            allowed = VELOCITY_ERROR
        if i >= 2 * bodies:
            allowed = HYSTERESIS_ERROR
        a = a + fifth / allowed * (fifth / allowed)
        b = b + third / allowed * (third / allowed)
    march.error = 0.0
    if a != 0.0:
        # the fifth-order estimate, damped where the third-order one is larger still
        march.error = u.step * a / math.sqrt((a + 0.01 * b) * size)
    for j in range(bodies):
        march.y[j] = train.trial_position[j]
        march.y[bodies + j] = train.trial_velocity[j]
    for m in range(len(train.hysteresis)):
        march.y[2 * bodies + m] = train.trial_hysteresis[m]
    for i in range(size):
        march.slopes[0, i] = march.slopes[END, i]


def back(march: Any) -> None:
    """Be where the sample began."""
    for i in range(len(march.y)):
        march.y[i] = march.began[i]
        march.slopes[0, i] = march.first[i]
