"""Records of one joint in motion.

Bodies are numbered: 0 the link, 1 to M the motors, M + 1 the set-point motor.
"""

from __future__ import annotations

from rotatum.record import Record, integer, number, vector

PRESCRIBED = 0
DYNAMIC = 1
QUASI_STATIC = 2


class PlantParams(Record):
    """Constants of a joint, everything at the joint side; the laws' constants follow."""

    substeps = integer("Runge-Kutta steps per sample")
    step = number("one of them", unit="s", symbol="h")
    drive = integer("the set-point is 0: prescribed, 1: a motor's, 2: a quasi-static motor's")
    inertia = vector("J", "of link, motors, set-point motor", unit="kg m^2")
    damping = vector("J", "their viscous friction", unit="N m s/rad")
    coulomb = vector("J", "their Coulomb friction", unit="N m")
    excess = vector("J", "friction at breaking away beyond Coulomb's", unit="N m", symbol="S - C")
    stribeck = vector("J", "velocity at which it fades", unit="rad/s", symbol="v_s")
    load_friction = number("of the motors, by elastic torque", symbol="mu")
    smoothing = number("velocity the sign of friction is regularised over", unit="rad/s")
    gravity_torque = number("of the link, horizontal", unit="N m")
    preload = vector("M", "added to each deflection", unit="rad")
    spring_damping = vector("M", "in parallel to each spring", unit="N m s/rad")
    half_play = number("of each spring, to either side", unit="rad")
    hysteresis_torque = number("of each spring, built up", unit="N m", symbol="h")
    hysteresis_deflection = number("over which it builds up", unit="rad", symbol="d")
    offset = number("set-point at angle zero", symbol="r_0")
    slope = number("set-point by angle", symbol="-b")
    start_position = vector("J", "at the first sample", unit="rad")
    start_velocity = vector("J", "at the first sample", unit="rad/s")


class PlantState(Record):
    """Positions, velocities and hysteresis, and what one Runge-Kutta step works on."""

    position = vector("J", "of the bodies", unit="rad")
    velocity = vector("J", "of the bodies", unit="rad/s")
    hysteresis = vector("M", "share of its torque each spring has built up", symbol="z")
    diverged = integer("1: a position left all bounds; it stands still from there")
    trial_position = vector("J", "where the equations are looked at", unit="rad")
    trial_velocity = vector("J", "where the equations are looked at", unit="rad/s")
    trial_hysteresis = vector("M", "where the equations are looked at", symbol="z")
    acceleration = vector("J", "what they say there", unit="rad/s^2")
    hysteresis_rate = vector("M", "what they say there", unit="1/s")
    velocity_sum = vector("J", "weighted, of the parts of a step", unit="rad/s")
    acceleration_sum = vector("J", "weighted, of the parts of a step", unit="rad/s^2")
    scale = number("factor on all springs there")
    stretch = vector("M", "deflection and preload without the play", unit="rad")
    contact = vector("M", "1; 0 inside the play")
    torque = vector("M", "of each spring there", unit="N m", symbol="tau_e")
    pull = vector("M", "it, damping and hysteresis", unit="N m")
    setpoint = number("the laws' set-point there", symbol="s")
    push = number("dU/ds there")


class PlantInput(Record):
    """Torques held over one period, and where set-point and stiffness go in it."""

    tau = vector("M", "on each motor", unit="N m")
    tau_ext = number("on the link", unit="N m")
    tau_setpoint = number("on the set-point motor", unit="N m", symbol="tau_c")
    angle = number("of a prescribed set-point now", unit="rad", symbol="theta_c")
    next_angle = number("at the next sample", unit="rad")
    scale = number("factor on all springs now; 1: as the laws say")
    next_scale = number("at the end of the period")
    added_inertia = number("of a payload, held", unit="kg m^2")
    added_gravity = number("torque of a payload, horizontal, held", unit="N m")
    share = number("of the period gone; a drive train alone looks at it")


class PlantOutput(Record):
    """The joint at the sample's instant, before the sample's torques have acted."""

    valid = integer("0: the motion has run away")
    q = number("link", unit="rad", symbol="q")
    dq = number("link", unit="rad/s")
    ddq = number("link, under the sample's torques", unit="rad/s^2")
    theta = vector("M", "motors", unit="rad", symbol="theta")
    dtheta = vector("M", "motors", unit="rad/s")
    angle = number("set-point motor", unit="rad", symbol="theta_c")
    dangle = number("set-point motor", unit="rad/s")
    setpoint = number("the laws' set-point", symbol="s")
    scale = number("factor on all springs")
    deflection = vector("M", "q - theta", unit="rad", symbol="phi")
    torque = vector("M", "elastic, without damping and hysteresis", unit="N m", symbol="tau_e")
    hysteresis = vector("M", "torque of the springs' hysteresis", unit="N m")
    transmitted = vector("M", "elastic, damping and hysteresis", unit="N m")
    stiffness = vector("M", "of each transmission", unit="N m/rad", symbol="sigma")
    torque_total = number("elastic, on the link", unit="N m")
    stiffness_total = number("of the joint", unit="N m/rad")
