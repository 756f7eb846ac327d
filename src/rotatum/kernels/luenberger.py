"""The observer of deluca2007 for one joint: full state from motor position and link acceleration.

``B theta'' + D_m theta' + D (theta' - q') + K (theta - q) = u``, ``u`` the motor's torque less
Coulomb friction and coupling, ``y1 = theta``, ``y2 = q''``, perhaps ``y3 = q'``. With ``k = K/B``,
``d = D/B``, ``c = d + D_m/B`` the state

``w = (theta, theta' + c theta, k q + d q', k q')``

makes eq. 6 with the gains of Remark 3 into ``w' = A w + b``, where A holds nothing but the wanted
poles and, g the gain of the gyroscope,

``b = (a3 - c, a2 - k, a1, a0) y1 + (0, u/B, 0, 0) + (0, 0, d, k) y2 + (0, 0, 0, g k) y3``.

One constant transition and one pair of hold matrices therefore serve every stiffness: one that
changes rescales the last two of w, so that q and q' stay.

Each sample closes an interval: over it theta, acceleration and gyroscope are straight lines
between their samples (first-order hold, exact), the torque is that or constant, and stiffness and
bias torque are those of the closing sample. The estimate belongs to the instant of the sample.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels.guard import BEYOND
from rotatum.kernels.rows import sign
from rotatum.kernels.status import NOT_FINITE, RESTARTED, SETTLING, UNSEEN
from rotatum.record import Record, integer, matrix, number, vector


class LuenbergerParams(Record):
    """One joint and the poles of its observer."""

    transition = matrix(4, 4, "exp(A T)", unit="unit of w / unit of w")
    before = matrix(
        4, 4, "how b at the start of an interval enters", unit="unit of w / unit of its rate"
    )
    after = matrix(4, 4, "how b at its end enters", unit="unit of w / unit of its rate")
    gains = vector(4, "coefficients a3, a2, a1, a0 of the injection", unit="unit of the rate of w")
    gyro = number("gain of the gyroscope, 0: there is none", unit="1/s", symbol="gamma")
    inverse_inertia = number("of the motor at the joint, 1/B", unit="1/(kg m^2)")
    damping = number("of the spring", unit="N m s/rad", symbol="D")
    motor_damping = number("viscous friction of the motor at the joint", unit="N m s/rad")
    coulomb = number("Coulomb friction of the motor at the joint, 0: none", unit="N m")
    width = number("observed motor speed below which it is linear", unit="rad/s")
    stiffness = number("where a sample gives none", unit="N m/rad", symbol="K")
    softest = number("smallest stiffness that is used", unit="N m/rad")
    stiffest = number("largest", unit="N m/rad")
    change = number("largest relative change of the stiffness per sample, 0: no limit")
    held = integer("1: the torque is constant until the next sample; 0: sampled, a straight line")
    settle = integer("samples until a start is forgotten")


class LuenbergerState(Record):
    """Memory of an observer: w, and what the last sample told."""

    w = vector(4, "theta, theta' + c theta, k q + d q', k q'", unit="unit of w", symbol="w")
    ahead = vector(4, "scratch: w of the next sample", unit="unit of w")
    first = vector(4, "scratch: b at the start of the interval", unit="unit of the rate of w")
    last = vector(4, "scratch: b at its end", unit="unit of the rate of w")
    theta = number("of the last sample", unit="rad")
    torque = number("of the last sample", unit="N m")
    coupling = number("of the last sample", unit="N m")
    acceleration = number("of the last sample", unit="rad/s^2")
    rate = number("of the last sample", unit="rad/s")
    stiffness = number("in use", unit="N m/rad", symbol="K")
    bias = number("torque in use", unit="N m")
    started = integer("1: w means something")
    count = integer("samples since the (re)start, settle at most")


class LuenbergerSample(Record):
    """One sample of a joint."""

    time = number("of the sample", unit="s", symbol="t")
    theta = number("motor position, joint side", unit="rad", symbol="theta")
    torque = number("of the motor at the joint", unit="N m", symbol="tau")
    acceleration = number("of the link, q''", unit="rad/s^2")
    rate = number("of the link by a gyroscope, q'", unit="rad/s")
    coupling = number("torque (S^T q'')_i on the motor", unit="N m")
    stiffness = number("0 or less: the params' own", unit="N m/rad", symbol="K")
    bias = number("tau_e - K (q - theta) of a law that is no straight line", unit="N m")
    rest = number("deflection q - theta if the joint starts at rest here", unit="rad")
    seen = integer("0: no sensor determines the acceleration, it is taken for 0")
    fresh = integer("1: what came before does not adjoin: start at rest here")
    hold = integer("1: the sample was refused, the estimate is repeated")
    status = integer("status bits of the sample")


class LuenbergerEstimate(Record):
    """The full state at the sample."""

    time = number("of the sample", unit="s", symbol="t")
    theta_hat = number("motor position", unit="rad")
    q_hat = number("link position", unit="rad")
    dtheta_hat = number("motor velocity", unit="rad/s")
    dq_hat = number("link velocity", unit="rad/s")
    deflection = number("q - theta", unit="rad", symbol="phi")
    torque = number("elastic torque, grows with the deflection", unit="N m", symbol="tau_e")
    transmission_torque = number("elastic torque plus the spring's damping", unit="N m")
    stiffness = number("in use", unit="N m/rad", symbol="K")
    status = integer("status bits")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    for i in range(4):
        state.w[i] = 0.0
    state.stiffness = params.stiffness
    state.bias = 0.0
    state.started = 0
    state.count = 0


def step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Take one sample; samples are equidistant.

    A sample that is held, or lacks a finite number the observer needs, leaves the state and repeats
    the estimate: the front fills it in later or raises ``fresh`` (``kernels.guard``). A stiffness
    or bias torque that is not finite leaves the one in use, a rest that is not finite is 0; the
    rest of the sample counts. The first sample, and a fresh one, start at rest: theta,
    theta + rest, 0, 0.
    """
    status = u.status
    good = _usable(params, u)
    if u.hold == 0 and good == 1:
        if not math.fabs(u.stiffness) + math.fabs(u.bias) + math.fabs(u.rest) <= BEYOND:
            status = status | NOT_FINITE
        acceleration = 0.0
        if u.seen != 0:
            acceleration = u.acceleration
        else:
            status = status | UNSEEN
        stiffness = _wanted(params, state, u.stiffness)
        if u.fresh != 0 or state.started == 0:
            _start(params, state, u, stiffness)
            status = status | RESTARTED
        else:
            _reschedule(params, state, stiffness)
            if math.fabs(u.bias) <= BEYOND:
                state.bias = u.bias
            _advance(params, state, u, acceleration)
            if state.count < params.settle:
                state.count = state.count + 1
        state.theta = u.theta
        state.torque = u.torque
        state.coupling = u.coupling
        state.acceleration = acceleration
        if params.gyro != 0.0:
            state.rate = u.rate
    elif good == 0:
        status = status | NOT_FINITE
    hold(params, state, out)
    out.time = u.time
    out.status = out.status | status


def hold(params: Any, state: Any, out: Any) -> None:
    """Write the estimate again, without a sample."""
    k = state.stiffness * params.inverse_inertia
    d = params.damping * params.inverse_inertia
    dq = state.w[3] / k
    q = (state.w[2] - d * dq) / k
    theta = state.w[0]
    dtheta = _motor_speed(params, state)
    out.theta_hat = theta
    out.q_hat = q
    out.dtheta_hat = dtheta
    out.dq_hat = dq
    out.deflection = q - theta
    out.torque = state.stiffness * (q - theta) + state.bias
    out.transmission_torque = out.torque + params.damping * (dq - dtheta)
    out.stiffness = state.stiffness
    out.status = 0
    if state.count < params.settle:
        out.status = SETTLING


def _usable(params: Any, u: Any) -> int:
    """Whether all is finite, and measurable, that this sample's estimate needs."""
    if not math.fabs(u.time) <= BEYOND or not math.fabs(u.theta) <= BEYOND:
        return 0
    if not math.fabs(u.torque) <= BEYOND or not math.fabs(u.coupling) <= BEYOND:
        return 0
    if u.seen != 0 and not math.fabs(u.acceleration) <= BEYOND:
        return 0
    if params.gyro != 0.0 and not math.fabs(u.rate) <= BEYOND:
        return 0
    return 1


def _wanted(params: Any, state: Any, asked: float) -> float:
    """The stiffness that was asked for, within what may be used."""
    stiffness: float = state.stiffness
    if math.fabs(asked) <= BEYOND:
        stiffness = params.stiffness
        if asked > 0.0:
            stiffness = asked
    if stiffness < params.softest:
        stiffness = params.softest
    if stiffness > params.stiffest:
        stiffness = params.stiffest
    return stiffness


def _start(params: Any, state: Any, u: Any, stiffness: float) -> None:
    """Begin at rest where the motor stands."""
    rest = 0.0
    if math.fabs(u.rest) <= BEYOND:
        rest = u.rest
    if math.fabs(u.bias) <= BEYOND:
        state.bias = u.bias
    inverse = params.inverse_inertia
    state.stiffness = stiffness
    state.w[0] = u.theta
    state.w[1] = (params.damping + params.motor_damping) * inverse * u.theta
    state.w[2] = stiffness * inverse * (u.theta + rest)
    state.w[3] = 0.0
    state.started = 1
    state.count = 0


def _reschedule(params: Any, state: Any, stiffness: float) -> None:
    """Go over to another stiffness where q and q' stay."""
    if params.change > 0.0:
        highest = state.stiffness * (1.0 + params.change)
        lowest = state.stiffness / (1.0 + params.change)
        if stiffness > highest:
            stiffness = highest
        if stiffness < lowest:
            stiffness = lowest
    if stiffness != state.stiffness:
        ratio = stiffness / state.stiffness
        d = params.damping * params.inverse_inertia
        dq = state.w[3] / (state.stiffness * params.inverse_inertia)
        state.w[2] = ratio * (state.w[2] - d * dq) + d * dq
        state.w[3] = ratio * state.w[3]
        state.stiffness = stiffness


def _motor_speed(params: Any, state: Any) -> float:
    speed: float = state.w[1] - (
        (params.damping + params.motor_damping) * params.inverse_inertia * state.w[0]
    )
    return speed


def _advance(params: Any, state: Any, u: Any, acceleration: float) -> None:
    """``w <- exp(A T) w + before b(start) + after b(end)``."""
    known = state.bias
    if params.coulomb > 0.0:
        known = known - params.coulomb * sign(_motor_speed(params, state), params.width)
    torque = u.torque
    if params.held != 0:
        torque = state.torque
    earlier = state.torque - state.coupling + known
    now = torque - u.coupling + known
    _drive(params, state, state.first, state.theta, earlier, state.acceleration, state.rate)
    rate = 0.0
    if params.gyro != 0.0:
        rate = u.rate
    _drive(params, state, state.last, u.theta, now, acceleration, rate)
    for i in range(4):
        a = params.transition[i, 0] * state.w[0] + params.transition[i, 1] * state.w[1]
        a = a + params.transition[i, 2] * state.w[2] + params.transition[i, 3] * state.w[3]
        b = params.before[i, 0] * state.first[0] + params.before[i, 1] * state.first[1]
        b = b + params.before[i, 2] * state.first[2] + params.before[i, 3] * state.first[3]
        c = params.after[i, 0] * state.last[0] + params.after[i, 1] * state.last[1]
        c = c + params.after[i, 2] * state.last[2] + params.after[i, 3] * state.last[3]
        state.ahead[i] = a + (b + c)
    for i in range(4):
        state.w[i] = state.ahead[i]


def _drive(
    params: Any, state: Any, b: Any, theta: float, torque: float, acceleration: float, rate: float
) -> None:
    """What drives w at one instant."""
    inverse = params.inverse_inertia
    k = state.stiffness * inverse
    d = params.damping * inverse
    c = d + params.motor_damping * inverse
    b[0] = (params.gains[0] - c) * theta
    b[1] = (params.gains[1] - k) * theta + torque * inverse
    b[2] = params.gains[2] * theta + d * acceleration
    b[3] = params.gains[3] * theta + k * (acceleration + params.gyro * rate)
