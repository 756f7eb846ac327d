"""Rows of trumic2022: the elastic rotatum against the rate of the torque's basis.

The balance of the link, differentiated,

    -d/dt (M q'' + D q' + g) = dF/dt^T alpha,    dF/dt = F_phi phi' + F_s s',

a pendulum's in closed form, ``M q''' + D q'' + G cos(q) q'``, an arm's from its model (eq. 9 with
its signs corrected). Jerk, acceleration, velocity and position come from one observer and belong
to one instant, ``lag`` samples ago; motor positions and set-points go through the same observer, so
that both sides of the balance are as late and as smooth as each other.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import basis, rows, unknown_input
from rotatum.kernels.rows import find_zero
from rotatum.kernels.status import DISABLED, SETTLING
from rotatum.record import Record, integer, number, vector

ANGLE = 0
RATE = 1
ACCELERATION = 2
JERK = 3
"""Places in what the observer estimates."""
MOTION = 2
WHOLE = 4
"""How much of it is wanted: of motors and set-points, and of the link."""


class RotatumParams(Record):
    """The link."""

    arm = integer("1: the rotatum comes from an arm; 0: the link is a pendulum of its own")
    inertia = number("of the pendulum", unit="kg m^2", symbol="M")
    damping = number("of the link", unit="N m s/rad", symbol="D")
    gravity = number("of the pendulum, g(q) = G sin q", unit="N m", symbol="G")


class RotatumState(Record):
    """Which samples the observers have seen."""

    count = integer("samples since (re)start")
    made = integer("1: there are estimates of this sample")
    sample = vector(1, "what an observer is given")


class RotatumSample(Record):
    """One sample of a joint seen from its link, as the rows of the rotatum read it."""

    time = number("of the sample", unit="s", symbol="t")
    q = number("link position", unit="rad", symbol="q")
    theta = number("motor position, joint side; the agonist's of two", unit="rad", symbol="theta")
    theta2 = number("the antagonist's", unit="rad", symbol="theta_2")
    setpoint = number("set-point as logged, 0: there is none", symbol="s")
    angle = number("of the link as the arm observed it, lag samples ago", unit="rad")
    rate = number("its velocity then", unit="rad/s")
    acceleration = number("its acceleration then", unit="rad/s^2")
    rotatum = number("of the arm then, without friction", unit="N m/s", symbol="p_e")
    enable = integer("0: do not learn from this sample")
    fresh = integer("1: the filters must start at this sample")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.rotatum.count = 0
    unknown_input.init(params.observer, state.link)
    unknown_input.init(params.observer, state.motor)
    unknown_input.init(params.observer, state.lever)


def pair_init(params: Any, state: Any) -> None:
    """Nothing seen yet, of two transmissions."""
    init(params, state)
    unknown_input.init(params.observer, state.motor2)


def one_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row of a joint with one transmission."""
    raw = u.q - u.theta
    known = find_zero(params.zero, state.zero, raw, u.fresh)
    basis.evaluate(params.basis, state.terms, raw - state.zero.zero, u.setpoint)
    rows.read_basis(state.terms, out)
    out.phi = raw - state.zero.zero
    _observe(params, state, u, known)
    if state.rotatum.made != 0:
        link = state.link.estimate
        motor = state.motor.estimate
        _rates(params, state, state.terms, link, motor, state.zero.zero)
        first = len(out.R) - len(state.terms.F)
        for h in range(len(state.terms.F)):
            out.R[first + h] = state.terms.D[h]
        _balance(params.rotatum, link, u.rotatum, out)
    _emit(state, u.enable, out)


def pair_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row of a joint with two transmissions, whose torques add up on the link."""
    known = find_zero(params.zero, state.zero, u.q - u.theta, u.fresh)
    known = known * find_zero(params.zero2, state.zero2, u.q - u.theta2, u.fresh)
    phi = u.q - u.theta - state.zero.zero
    phi2 = u.q - u.theta2 - state.zero2.zero
    basis.evaluate(params.basis, state.terms, phi, u.setpoint)
    basis.evaluate(params.basis, state.terms2, phi2, u.setpoint)
    rows.read_pair(state.terms, state.terms2, out)
    out.phi = phi
    out.phi2 = phi2
    if u.fresh != 0 or known == 0:
        unknown_input.restart(params.observer, state.motor2)
    _observe(params, state, u, known)
    if known != 0:
        _push(params, state, state.motor2, u.theta2, MOTION)
    if state.rotatum.made != 0:
        link = state.link.estimate
        _rates(params, state, state.terms, link, state.motor.estimate, state.zero.zero)
        _rates(params, state, state.terms2, link, state.motor2.estimate, state.zero2.zero)
        first = len(out.R) - 2 * len(state.terms.F)
        for h in range(len(state.terms.F)):
            out.R[first + 2 * h] = state.terms.D[h]
            out.R[first + 2 * h + 1] = state.terms2.D[h]
        _balance(params.rotatum, link, u.rotatum, out)
    _emit(state, u.enable, out)


def _observe(params: Any, state: Any, u: Any, known: int) -> None:
    s = state.rotatum
    s.made = 0
    if u.fresh != 0 or known == 0:
        s.count = 0
        unknown_input.restart(params.observer, state.link)
        unknown_input.restart(params.observer, state.motor)
        unknown_input.restart(params.observer, state.lever)
    if known != 0:
        s.count = s.count + 1
        _push(params, state, state.motor, u.theta, MOTION)
        if params.basis.setpoint_order > 0:
            _push(params, state, state.lever, u.setpoint, MOTION)
        if params.rotatum.arm == 0:
            _push(params, state, state.link, u.q, WHOLE)
        else:
            # The arm has observed all its links: none is observed twice.
            state.link.estimate[ANGLE] = u.angle
            state.link.estimate[RATE] = u.rate
            state.link.estimate[ACCELERATION] = u.acceleration
        s.made = state.motor.valid


def _push(params: Any, state: Any, observer: Any, value: float, wanted: int) -> None:
    state.rotatum.sample[0] = value
    unknown_input.push(params.observer, observer, state.rotatum.sample, wanted)


def _rates(params: Any, state: Any, terms: Any, link: Any, motor: Any, zero: float) -> None:
    """Put ``dF/dt`` of the instant where ``terms.D`` is."""
    phi = link[ANGLE] - motor[ANGLE] - zero
    rate = link[RATE] - motor[RATE]
    basis.evaluate(params.basis, terms, phi, state.lever.estimate[ANGLE])
    for h in range(len(terms.F)):
        terms.D[h] = terms.D[h] * rate
    if params.basis.setpoint_order > 0:
        for h in range(len(terms.F)):
            terms.D[h] = terms.D[h] + terms.S[h] * state.lever.estimate[RATE]


def _balance(p: Any, link: Any, rotatum: float, out: Any) -> None:
    if p.arm != 0:
        out.y = rotatum - p.damping * link[ACCELERATION]
    else:
        load = p.inertia * link[JERK] + p.damping * link[ACCELERATION]
        out.y = -(load + p.gravity * math.cos(link[ANGLE]) * link[RATE])
    out.suspect = link[JERK]
    out.drag = link[ACCELERATION]


def _emit(state: Any, enable: int, out: Any) -> None:
    out.fresh = 0
    if state.rotatum.count <= 1:
        out.fresh = 1
    out.status = 0
    out.valid = state.rotatum.made
    if state.motor.settled == 0:
        out.valid = 0
        out.status = SETTLING
    if enable == 0:
        out.valid = 0
        out.status = out.status | DISABLED
