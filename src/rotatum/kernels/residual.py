"""Rows of flacco2012: the momentum residual against the basis, unfiltered, as printed."""

from __future__ import annotations

from typing import Any

from rotatum.kernels import basis, kinematic, rows
from rotatum.kernels.rows import find_zero, read_basis
from rotatum.kernels.status import DISABLED, SETTLING
from rotatum.record import Record, integer, number


class ResidualParams(Record):
    """The residual's gain and the motor."""

    period = number("time between samples", unit="s", symbol="T")
    gain = number("bandwidth of the residual", unit="rad/s", symbol="K_I")
    settle = integer("samples after a start until the first row is used")
    held = integer(
        "1: the torque is a command held until the next sample; 0: measured at the instant"
    )
    inertia = number("motor inertia, joint side", unit="kg m^2", symbol="B")
    damping = number("motor damping, joint side", unit="N m s/rad", symbol="D_theta")
    coulomb = number("motor Coulomb friction, joint side", unit="N m", symbol="C")
    width = number("speed below which Coulomb friction is proportional to speed", unit="rad/s")
    offset = integer("1: the first column is the constant, which is fitted")


class ResidualState(Record):
    """The residual and what eq. 17 remembers."""

    count = integer("samples since (re)start")
    r = number("residual: elastic torque through a first-order low-pass", unit="N m", symbol="r_e")
    acceleration = number("the motor's, through the same low-pass", unit="rad/s^2")
    theta = number("motor position before", unit="rad", symbol="theta(k-1)")
    velocity = number("motor velocity before", unit="rad/s", symbol="theta'(k-1)")
    torque = number("motor torque before", unit="N m", symbol="tau(k-1)")
    sign = number("sign of the velocity before")


def momentum(p: Any, s: Any, theta: float, velocity: float, torque: float) -> None:
    """One step of flacco2012 eq. 17, for a motor position and velocity already filtered.

    ``r(k) = ((2 - T K) r(k-1) + 2 (rbar(k) - rbar(k-1))) / (2 + T K)``, r(0) = 0,
    ``rbar = K (B theta' + D theta + C int sgn theta' - int tau)``.

    Departures: only increments of rbar are kept, so nothing grows and the residual starts from 0
    and not from ``K (p(0) + D theta(0))``; a held torque contributes ``T tau(k-1)``, which is
    exact for it; Coulomb friction is taken off where it is known.
    """
    T = p.period
    K = p.gain
    sgn = rows.sign(velocity, p.width)
    if s.count == 0:
        s.r = 0.0
        s.acceleration = 0.0
    else:
        if p.held != 0:
            impulse = T * s.torque
        else:
            impulse = 0.5 * T * (s.torque + torque)
        change = p.inertia * (velocity - s.velocity) + p.damping * (theta - s.theta) - impulse
        change = K * (change + 0.5 * T * p.coulomb * (sgn + s.sign))
        jerk = 2.0 * K * (velocity - s.velocity)
        s.acceleration = ((2.0 - T * K) * s.acceleration + jerk) / (2.0 + T * K)
        s.r = ((2.0 - T * K) * s.r + 2.0 * change) / (2.0 + T * K)
    s.theta = theta
    s.velocity = velocity
    s.torque = torque
    s.sign = sgn
    s.count = s.count + 1


def motor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    _init(params, state)


def motor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row ``r_e = F(phi)^T alpha``, positions and velocity from the kinematic filters."""
    s = state.residual
    _observe(params, state, u)
    momentum(params.residual, s, state.motor.position, state.motor.velocity, u.torque)
    known = _deflect(params, state, u, out)
    _emit(params.residual, s, known, s.r, state.link.velocity, u, out)


def sensor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    _init(params, state)


def sensor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row ``tau_measured = F(phi)^T alpha`` (flacco2012, SENSOR)."""
    s = state.residual
    _observe(params, state, u)
    s.count = s.count + 1
    known = _deflect(params, state, u, out)
    _emit(params.residual, s, known, u.torque, state.link.velocity, u, out)


def _init(params: Any, state: Any) -> None:
    kinematic.init(params.kinematic, state.link)
    kinematic.init(params.kinematic, state.motor)
    kinematic.init(params.setpoint, state.setpoint)


def _observe(params: Any, state: Any, u: Any) -> None:
    if u.fresh != 0:
        state.residual.count = 0
    if state.residual.count == 0:
        kinematic.start(params.kinematic, state.link, u.q)
        kinematic.start(params.kinematic, state.motor, u.theta)
    else:
        kinematic.observe(params.kinematic, state.link, u.q)
        kinematic.observe(params.kinematic, state.motor, u.theta)
    if params.basis.setpoint_order > 0:
        if state.residual.count == 0:
            kinematic.start(params.setpoint, state.setpoint, u.setpoint)
        else:
            kinematic.observe(params.setpoint, state.setpoint, u.setpoint)


def _deflect(params: Any, state: Any, u: Any, out: Any) -> int:
    raw = state.link.position - state.motor.position
    known = find_zero(params.zero, state.zero, raw, u.fresh)
    phi = raw - state.zero.zero
    basis.evaluate(params.basis, state.terms, phi, state.setpoint.position)
    read_basis(state.terms, out)
    out.phi = phi
    return known


def _emit(p: Any, s: Any, known: int, y: float, velocity: float, u: Any, out: Any) -> None:
    out.y = y
    out.suspect = s.acceleration
    out.drag = velocity
    for h in range(len(out.R)):
        out.R[h] = out.F[h]
    if p.offset != 0:
        out.R[0] = 1.0
    out.fresh = 0
    if s.count <= 1:
        out.fresh = 1
    out.status = 0
    out.valid = 1
    if s.count <= p.settle or known == 0:
        out.valid = 0
        out.status = SETTLING
    if u.enable == 0:
        out.valid = 0
        out.status = out.status | DISABLED
