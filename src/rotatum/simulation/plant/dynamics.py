"""One joint in motion, as kernels: a link, its motors, the springs between, a set-point motor.

Bodies are numbered: 0 the link, 1 to M the motors, M + 1 the set-point motor. The springs' torques
come from the laws, which `rotatum.simulation.plant.stage` calls between these kernels.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.record import Record, integer, number, vector

PRESCRIBED = 0
DYNAMIC = 1
QUASI_STATIC = 2
# A turn beyond this [rad] is a diverged simulation of any joint.
POSITION_LIMIT = 1e6


class PlantParams(Record):
    """Constants of a joint, everything at the joint side; the laws' constants follow."""

    substeps = integer("Runge-Kutta steps per sample")
    step = number("one of them", unit="s", symbol="h")
    drive = integer("the set-point is 0: prescribed, 1: a motor's, 2: a quasi-static motor's")
    inertia = vector("J", "of link, motors, set-point motor", unit="kg m^2")
    damping = vector("J", "their viscous friction", unit="N m s/rad")
    coulomb = vector("J", "their Coulomb friction", unit="N m")
    smoothing = number("velocity its sign is regularised over", unit="rad/s")
    gravity_torque = number("of the link, horizontal", unit="N m")
    preload = vector("M", "added to each deflection", unit="rad")
    spring_damping = vector("M", "in parallel to each spring", unit="N m s/rad")
    offset = number("set-point at angle zero", symbol="r_0")
    slope = number("set-point by angle", symbol="-b")
    start_position = vector("J", "at the first sample", unit="rad")
    start_velocity = vector("J", "at the first sample", unit="rad/s")


class PlantState(Record):
    """Positions and velocities, and what one Runge-Kutta step works on."""

    position = vector("J", "of the bodies", unit="rad")
    velocity = vector("J", "of the bodies", unit="rad/s")
    diverged = integer("1: a position left all bounds; it stands still from there")
    trial_position = vector("J", "where the equations are looked at", unit="rad")
    trial_velocity = vector("J", "where the equations are looked at", unit="rad/s")
    acceleration = vector("J", "what they say there", unit="rad/s^2")
    velocity_sum = vector("J", "weighted, of the parts of a step", unit="rad/s")
    acceleration_sum = vector("J", "weighted, of the parts of a step", unit="rad/s^2")
    stretch = vector("M", "deflection and preload", unit="rad")
    torque = vector("M", "of each spring there", unit="N m", symbol="tau_e")
    setpoint = number("the laws' set-point there", symbol="s")
    push = number("dU/ds there")


class PlantInput(Record):
    """Torques held over one period, and where a prescribed set-point goes in it."""

    tau = vector("M", "on each motor", unit="N m")
    tau_ext = number("on the link", unit="N m")
    tau_setpoint = number("on the set-point motor", unit="N m", symbol="tau_c")
    angle = number("of a prescribed set-point now", unit="rad", symbol="theta_c")
    next_angle = number("at the next sample", unit="rad")


class PlantOutput(Record):
    """The joint at the sample's instant, before the sample's torques have acted."""

    valid = integer("0: the motion has run away")
    q = number("link", unit="rad", symbol="q")
    dq = number("link", unit="rad/s")
    theta = vector("M", "motors", unit="rad", symbol="theta")
    dtheta = vector("M", "motors", unit="rad/s")
    angle = number("set-point motor", unit="rad", symbol="theta_c")
    dangle = number("set-point motor", unit="rad/s")
    setpoint = number("the laws' set-point", symbol="s")
    deflection = vector("M", "q - theta", unit="rad", symbol="phi")
    torque = vector("M", "elastic, without damping", unit="N m", symbol="tau_e")
    stiffness = vector("M", "of each transmission", unit="N m/rad", symbol="sigma")
    torque_total = number("on the link", unit="N m")
    stiffness_total = number("of the joint", unit="N m/rad")


def init(params: Any, state: Any) -> None:
    """Stand at the start."""
    state.diverged = 0
    for j in range(len(state.position)):
        state.position[j] = params.start_position[j]
        state.velocity[j] = params.start_velocity[j]


def begin(params: Any, state: Any, u: Any) -> None:
    """Look at the equations where the joint is.

    A prescribed set-point runs straight to its next sample: a body without acceleration.
    """
    last = len(state.position) - 1
    if params.drive == PRESCRIBED and state.diverged == 0:
        state.position[last] = u.angle
        state.velocity[last] = (u.next_angle - u.angle) / (params.substeps * params.step)
    for j in range(last + 1):
        state.trial_position[j] = state.position[j]
        state.trial_velocity[j] = state.velocity[j]
    deform(params, state)


def deform(params: Any, state: Any) -> None:
    """Set-point and stretch of the springs at the trial point."""
    motors = len(state.stretch)
    state.setpoint = params.offset + params.slope * state.trial_position[motors + 1]
    for m in range(motors):
        deflection = state.trial_position[0] - state.trial_position[m + 1]
        state.stretch[m] = deflection + params.preload[m]


def approach(params: Any, state: Any, part: int) -> None:
    """Trial point of the four parts of a classical Runge-Kutta step; the sums start at the first.

    Positions move with the velocities of the part before, velocities with its accelerations.
    """
    ahead = 0.5 * params.step
    if part == 0:
        ahead = 0.0
    if part == 3:
        ahead = params.step
    for j in range(len(state.position)):
        state.trial_position[j] = state.position[j] + ahead * state.trial_velocity[j]
        state.trial_velocity[j] = state.velocity[j] + ahead * state.acceleration[j]
        if part == 0:
            state.velocity_sum[j] = 0.0
            state.acceleration_sum[j] = 0.0
    deform(params, state)


def balance(params: Any, state: Any, u: Any) -> None:
    """Accelerations at the trial point, flacco2012 eqs 3-4, 7-8 and 12.

    ``M q'' + Dq q' + Cq sgn(q') + G sin(q) + sum tau_e = tau_ext``,
    ``B theta'' + D theta' + C sgn(theta') - tau_e = tau`` for each motor,
    ``Bc theta_c'' + Dc theta_c' + Cc sgn(theta_c') + psi_e = tau_c``, psi_e = dU/ds ds/dtheta_c.
    """
    motors = len(state.torque)
    load = 0.0
    for m in range(motors):
        rate = state.trial_velocity[0] - state.trial_velocity[m + 1]
        pull = state.torque[m] + params.spring_damping[m] * rate
        load = load + pull
        net = u.tau[m] + pull - friction(params, m + 1, state.trial_velocity[m + 1])
        state.acceleration[m + 1] = net / params.inertia[m + 1]
    if math.fabs(state.trial_position[0]) < POSITION_LIMIT:
        load = load + params.gravity_torque * math.sin(state.trial_position[0])
    net = u.tau_ext - load - friction(params, 0, state.trial_velocity[0])
    state.acceleration[0] = net / params.inertia[0]
    _balance_setpoint(params, state, u.tau_setpoint - params.slope * state.push)


def _balance_setpoint(params: Any, state: Any, net: float) -> None:
    last = len(state.position) - 1
    state.acceleration[last] = 0.0
    if params.drive == DYNAMIC:
        net = net - friction(params, last, state.trial_velocity[last])
        state.acceleration[last] = net / params.inertia[last]
    if params.drive == QUASI_STATIC:
        state.trial_velocity[last] = creep(params, last, net)


def friction(params: Any, j: int, velocity: float) -> float:
    """Viscous and Coulomb friction of a body, the sign regularised as ``tanh(v / smoothing)``."""
    loss: float = params.damping[j] * velocity
    # tanh is the dearest operation of the loop, so bodies without Coulomb friction skip it
    if params.coulomb[j] != 0.0:
        loss = loss + params.coulomb[j] * tanh(velocity / params.smoothing)
    return loss


def tanh(x: float) -> float:
    """Hyperbolic tangent out of the exponential, to 1e-16."""
    size = math.fabs(x)
    e = 0.0
    if size < 20.0:
        e = math.exp(-2.0 * size)
    t = (1.0 - e) / (1.0 + e)
    if x < 0.0:
        return -t
    return t


def creep(params: Any, j: int, net: float) -> float:
    """Velocity at which friction alone balances a torque: ``D v + C tanh(v / eps) = net``.

    For net > 0 the left side is concave, so Newton's steps from a point below the root never
    pass it; the larger of ``net / (D + C / eps)`` and ``(net - C) / D`` is below and close.
    """
    D: float = params.damping[j]
    C: float = params.coulomb[j]
    if C == 0.0:
        return net / D
    size = math.fabs(net)
    v: float = size / (D + C / params.smoothing)
    if (size - C) / D > v:
        v = (size - C) / D
    for _ in range(8):
        t = tanh(v / params.smoothing)
        steep = D + C / params.smoothing * (1.0 - t * t)
        v = v + (size - D * v - C * t) / steep
    if net < 0.0:
        return -v
    return v


def gather(state: Any, part: int) -> None:
    """Add a part to the sums of its step."""
    weight = 1.0
    if part == 1 or part == 2:
        weight = 2.0
    for j in range(len(state.position)):
        state.velocity_sum[j] = state.velocity_sum[j] + weight * state.trial_velocity[j]
        state.acceleration_sum[j] = state.acceleration_sum[j] + weight * state.acceleration[j]


def finish(params: Any, state: Any) -> None:
    """Take the step."""
    sixth = params.step / 6.0
    for j in range(len(state.position)):
        state.position[j] = state.position[j] + sixth * state.velocity_sum[j]
        state.velocity[j] = state.velocity[j] + sixth * state.acceleration_sum[j]
        if not math.fabs(state.position[j]) < POSITION_LIMIT:
            state.diverged = 1


def report(state: Any, out: Any) -> None:
    """Write what the joint does now; the stiffnesses are there already."""
    motors = len(state.torque)
    out.valid = 1 - state.diverged
    out.q = state.trial_position[0]
    out.dq = state.trial_velocity[0]
    out.angle = state.trial_position[motors + 1]
    out.dangle = state.trial_velocity[motors + 1]
    out.setpoint = state.setpoint
    out.torque_total = 0.0
    out.stiffness_total = 0.0
    for m in range(motors):
        out.theta[m] = state.trial_position[m + 1]
        out.dtheta[m] = state.trial_velocity[m + 1]
        out.deflection[m] = out.q - out.theta[m]
        out.torque[m] = state.torque[m]
        out.torque_total = out.torque_total + out.torque[m]
        out.stiffness_total = out.stiffness_total + out.stiffness[m]
