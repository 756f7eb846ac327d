"""Rows of the weak form on the motor side: one operator on both sides of the balance.

The balance is tested with hats (linear B-splines) of two periods' width, and the sequence of
tested balances goes through a second-order low-pass:

    B <theta''> + D <theta'> + C <sgn theta'> - <tau> = <F>^T alpha,
    <theta''> = (theta(k) - 2 theta(k-1) + theta(k-2)) / T^2      exactly,
    <x> = (x(k) + 10 x(k-1) + x(k-2)) / 12                        sampled signals,
    <tau> = (tau(k-1) + tau(k-2)) / 2                             exactly, held commands.

No signal is differentiated but under the test function; the same low-pass on every term leaves
no lag bias, whatever its cutoff.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import basis, kinematic, rows
from rotatum.kernels.lowpass import smooth
from rotatum.kernels.rows import (
    COULOMB,
    DAMPING,
    INERTIA,
    SKEW,
    TRANSMISSION_DAMPING,
    find_zero,
    hat,
    read_basis,
)
from rotatum.kernels.status import DISABLED, SETTLING
from rotatum.record import Record, integer, number, vector


class WeakParams(Record):
    """The operator, the motor, and which columns are fitted."""

    period = number("time between samples", unit="s", symbol="T")
    pole = number("pole of the low-pass, exp(-cutoff T)", symbol="a")
    settle = integer("rows after a start until the first one is used")
    held = integer(
        "1: the torque is a command held until the next sample; 0: measured at the instant"
    )
    inertia = number("motor inertia, joint side", unit="kg m^2", symbol="B")
    damping = number("motor damping, joint side", unit="N m s/rad", symbol="D")
    coulomb = number("motor Coulomb friction, joint side", unit="N m", symbol="C")
    width = number("speed below which Coulomb friction is proportional to speed", unit="rad/s")
    kind = vector("p", "what each column is, 0: a term of the basis", kind="int")
    scale = vector("p", "what each column is divided by")


class WeakState(Record):
    """The last two samples and the low-pass of y and of each column."""

    count = integer("samples since (re)start")
    q1 = number("q(k-1)", unit="rad")
    q2 = number("q(k-2)", unit="rad")
    theta1 = number("theta(k-1)", unit="rad")
    theta2 = number("theta(k-2)", unit="rad")
    torque1 = number("torque(k-1)", unit="N m")
    torque2 = number("torque(k-2)", unit="N m")
    sign1 = number("sgn theta'(k-1)")
    sign2 = number("sgn theta'(k-2)")
    F1 = vector("p", "basis(k-1)", symbol="F")
    F2 = vector("p", "basis(k-2)", symbol="F")
    acceleration = number("<theta''>", unit="rad/s^2")
    velocity = number("<theta'>", unit="rad/s")
    friction = number("<sgn theta'>")
    raw_y = number("y before the low-pass", unit="N m")
    raw = vector("p", "columns before the low-pass")
    y1 = number("y after the first pole", unit="N m")
    y2 = number("y after the second pole", unit="N m")
    R1 = vector("p", "columns after the first pole")
    R2 = vector("p", "columns after the second pole")


def motor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    kinematic.init(params.kinematic, state.kinematic)


def motor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row from motor position and torque. ``u`` carries ``fresh``: 1 restarts the filters."""
    w = state.weak
    _deflect(params, state, u, out)
    if w.count == 0:
        kinematic.start(params.kinematic, state.kinematic, u.theta)
    else:
        kinematic.observe(params.kinematic, state.kinematic, u.theta)
    sgn = rows.sign(state.kinematic.velocity, params.weak.width)
    if w.count >= 2:
        _balance(params.weak, w, u, sgn)
        _columns(params.weak, w, state.terms, u)
        _filter(params.weak, w)
    w.sign2 = w.sign1
    w.sign1 = sgn
    _remember(w, state.terms, u.q, u.theta, u.tau)
    _emit(params.weak, w, u, out)


def sensor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.weak.count = 0


def sensor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row from a torque sensor: the same operator on measured torque and basis."""
    w = state.weak
    _deflect(params, state, u, out)
    if w.count >= 2:
        w.raw_y = hat(w.torque2, w.torque1, u.torque)
        _columns(params.weak, w, state.terms, u)
        _filter(params.weak, w)
    _remember(w, state.terms, u.q, u.theta, u.torque)
    _emit(params.weak, w, u, out)


def _deflect(params: Any, state: Any, u: Any, out: Any) -> None:
    if u.fresh != 0:
        state.weak.count = 0
    raw = u.q - u.theta
    known = find_zero(params.zero, state.zero, raw)
    if known == 0:
        state.weak.count = 0
    phi = raw - state.zero.zero
    basis.evaluate(params.basis, state.terms, phi, 0.0)
    read_basis(state.terms, out)
    out.phi = phi


def _balance(p: Any, w: Any, u: Any, sgn: float) -> None:
    T = p.period
    if p.held != 0:
        tau = 0.5 * (w.torque2 + w.torque1)
    else:
        tau = hat(w.torque2, w.torque1, u.tau)
    w.acceleration = (u.theta - 2.0 * w.theta1 + w.theta2) / (T * T)
    w.velocity = (u.theta - w.theta2) / (2.0 * T)
    w.friction = hat(w.sign2, w.sign1, sgn)
    w.raw_y = p.inertia * w.acceleration + p.damping * w.velocity + p.coulomb * w.friction - tau


def _columns(p: Any, w: Any, terms: Any, u: Any) -> None:
    T = p.period
    for h in range(len(terms.F)):
        w.raw[h] = hat(w.F2[h], w.F1[h], terms.F[h])
    for h in range(len(terms.F), len(w.raw)):
        kind = p.kind[h]
        if kind == INERTIA:
            w.raw[h] = -w.acceleration / p.scale[h]
        elif kind == DAMPING:
            w.raw[h] = -w.velocity / p.scale[h]
        elif kind == COULOMB:
            w.raw[h] = -w.friction / p.scale[h]
        elif kind == SKEW:
            w.raw[h] = (u.q - w.q2) / (2.0 * T * p.scale[h])
        elif kind == TRANSMISSION_DAMPING:
            w.raw[h] = ((u.q - u.theta) - (w.q2 - w.theta2)) / (2.0 * T * p.scale[h])
        else:
            w.raw[h] = 1.0 / p.scale[h]


def _filter(p: Any, w: Any) -> None:
    if w.count == 2:
        # Started at the first raw row, all terms of the balance alike: no transient to wait for.
        w.y1 = w.raw_y
        w.y2 = w.raw_y
        for h in range(len(w.raw)):
            w.R1[h] = w.raw[h]
            w.R2[h] = w.raw[h]
    w.y1 = smooth(p.pole, w.y1, w.raw_y)
    w.y2 = smooth(p.pole, w.y2, w.y1)
    for h in range(len(w.raw)):
        w.R1[h] = smooth(p.pole, w.R1[h], w.raw[h])
        w.R2[h] = smooth(p.pole, w.R2[h], w.R1[h])


def _remember(w: Any, terms: Any, q: float, theta: float, torque: float) -> None:
    w.q2 = w.q1
    w.q1 = q
    w.theta2 = w.theta1
    w.theta1 = theta
    w.torque2 = w.torque1
    w.torque1 = torque
    for h in range(len(terms.F)):
        w.F2[h] = w.F1[h]
        w.F1[h] = terms.F[h]
    w.count = w.count + 1


def _emit(p: Any, w: Any, u: Any, out: Any) -> None:
    out.y = w.y2
    for h in range(len(w.R2)):
        out.R[h] = w.R2[h]
    out.fresh = 0
    if w.count <= 1:
        out.fresh = 1
    out.status = 0
    out.valid = 1
    if w.count <= p.settle:
        out.valid = 0
        out.status = SETTLING
    if u.enable == 0:
        out.valid = 0
        out.status = out.status | DISABLED
