"""One joint in motion, as kernels: a link, its motors, the springs between, a set-point motor.

The springs' torques come from the laws, which `rotatum.simulation.plant.stage` calls between these
kernels. The body of a prescribed set-point is where it is: nothing is integrated.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.simulation.plant.friction import creep, friction
from rotatum.simulation.plant.records import DYNAMIC, PRESCRIBED, QUASI_STATIC
from rotatum.simulation.plant.springs import deform, drift, recall, remember

# A turn beyond this [rad] is a diverged simulation of any joint.
POSITION_LIMIT = 1e6


def init(params: Any, state: Any) -> None:
    """Stand at the start."""
    state.diverged = 0
    state.scale = 1.0
    for j in range(len(state.position)):
        state.position[j] = params.start_position[j]
        state.velocity[j] = params.start_velocity[j]


def begin(params: Any, state: Any, u: Any) -> None:
    """Look at the equations where the joint is.

    A prescribed set-point runs straight to its next sample.
    """
    last = len(state.position) - 1
    if params.drive == PRESCRIBED and state.diverged == 0:
        state.position[last] = u.angle
        state.velocity[last] = (u.next_angle - u.angle) / (params.substeps * params.step)
    for j in range(last + 1):
        state.trial_position[j] = state.position[j]
        state.trial_velocity[j] = state.velocity[j]
    for m in range(len(state.hysteresis)):
        state.trial_hysteresis[m] = state.hysteresis[m]
    drift(state, u, 0.0)
    deform(params, state)


def approach(params: Any, state: Any, u: Any, step: int, part: int) -> None:
    """Trial point of the four parts of a classical Runge-Kutta step.

    Positions move with the velocities of the part before, velocities with its accelerations.
    """
    ahead = 0.5
    if part == 0:
        ahead = 0.0
    if part == 3:
        ahead = 1.0
    time = ahead * params.step
    last = len(state.position) - 1
    for j in range(last):
        _go(state, j, time)
    # where neither set-point nor springs change, no division
    share = 0.0
    if u.next_angle != u.angle or u.next_scale != u.scale:
        share = (step + ahead) / params.substeps
    if params.drive == PRESCRIBED:
        state.trial_position[last] = u.angle + share * (u.next_angle - u.angle)
    else:
        _go(state, last, time)
    drift(state, u, share)
    deform(params, state)
    if params.hysteresis_torque != 0.0:
        recall(params, state)


def _go(state: Any, j: int, time: float) -> None:
    state.trial_position[j] = state.position[j] + time * state.trial_velocity[j]
    state.trial_velocity[j] = state.velocity[j] + time * state.acceleration[j]


def balance(params: Any, state: Any, u: Any) -> None:
    """Accelerations at the trial point, flacco2012 eqs 3-4, 7-8 and 12, with friction F.

    ``M q'' + F_q(q') + G sin(q) + sum pull = tau_ext``,
    ``B theta'' + F(theta') - pull = tau`` for each motor,
    ``Bc theta_c'' + F_c(theta_c') + psi_e = tau_c``, psi_e = dU/ds ds/dtheta_c;
    pull = tau_e + Dt phi' + h z.
    """
    motors = len(state.torque)
    load = 0.0
    for m in range(motors):
        rate = state.trial_velocity[0] - state.trial_velocity[m + 1]
        pull = state.torque[m] + state.contact[m] * params.spring_damping[m] * rate
        pull = pull + params.hysteresis_torque * state.trial_hysteresis[m]
        state.pull[m] = pull
        load = load + pull
        rubbed = params.load_friction * math.fabs(state.torque[m])
        net = u.tau[m] + pull - friction(params, m + 1, state.trial_velocity[m + 1], rubbed)
        state.acceleration[m + 1] = net / params.inertia[m + 1]
    if math.fabs(state.trial_position[0]) < POSITION_LIMIT:
        gravity = params.gravity_torque + u.added_gravity
        load = load + gravity * math.sin(state.trial_position[0])
    net = u.tau_ext - load - friction(params, 0, state.trial_velocity[0], 0.0)
    state.acceleration[0] = net / (params.inertia[0] + u.added_inertia)
    if params.drive != PRESCRIBED:
        _balance_setpoint(params, state, u.tau_setpoint - params.slope * state.push)


def _balance_setpoint(params: Any, state: Any, net: float) -> None:
    last = len(state.position) - 1
    state.acceleration[last] = 0.0
    if params.drive == DYNAMIC:
        net = net - friction(params, last, state.trial_velocity[last], 0.0)
        state.acceleration[last] = net / params.inertia[last]
    if params.drive == QUASI_STATIC:
        state.trial_velocity[last] = creep(params, last, net)


def gather(params: Any, state: Any, part: int) -> None:
    """Add a part to the sums of its step, which start at the first."""
    weight = 1.0
    if part == 1 or part == 2:
        weight = 2.0
    last = len(state.position) - 1
    for j in range(last):
        _add(state, j, weight, part)
    if params.drive != PRESCRIBED:
        _add(state, last, weight, part)


def _add(state: Any, j: int, weight: float, part: int) -> None:
    if part == 0:
        state.velocity_sum[j] = 0.0
        state.acceleration_sum[j] = 0.0
    state.velocity_sum[j] = state.velocity_sum[j] + weight * state.trial_velocity[j]
    state.acceleration_sum[j] = state.acceleration_sum[j] + weight * state.acceleration[j]


def finish(params: Any, state: Any) -> None:
    """Take the step."""
    if params.hysteresis_torque != 0.0:
        remember(params, state)
    last = len(state.position) - 1
    for j in range(last):
        _take(params, state, j)
    if params.drive != PRESCRIBED:
        _take(params, state, last)


def _take(params: Any, state: Any, j: int) -> None:
    sixth = params.step / 6.0
    state.position[j] = state.position[j] + sixth * state.velocity_sum[j]
    state.velocity[j] = state.velocity[j] + sixth * state.acceleration_sum[j]
    if not math.fabs(state.position[j]) < POSITION_LIMIT:
        state.diverged = 1


def report(params: Any, state: Any, out: Any) -> None:
    """Write what the joint does now; the stiffnesses are there already."""
    motors = len(state.torque)
    out.valid = 1 - state.diverged
    out.q = state.trial_position[0]
    out.dq = state.trial_velocity[0]
    out.ddq = state.acceleration[0]
    out.angle = state.trial_position[motors + 1]
    out.dangle = state.trial_velocity[motors + 1]
    out.setpoint = state.setpoint
    out.scale = state.scale
    out.torque_total = 0.0
    out.stiffness_total = 0.0
    for m in range(motors):
        out.theta[m] = state.trial_position[m + 1]
        out.dtheta[m] = state.trial_velocity[m + 1]
        out.deflection[m] = out.q - out.theta[m]
        out.torque[m] = state.torque[m]
        out.hysteresis[m] = params.hysteresis_torque * state.trial_hysteresis[m]
        out.transmitted[m] = state.pull[m]
        out.torque_total = out.torque_total + out.torque[m]
        out.stiffness_total = out.stiffness_total + out.stiffness[m]
