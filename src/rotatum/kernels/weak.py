"""Terms of the weak form on the motor side: one operator on both sides of the balance.

The balance is tested with hats (linear B-splines) of two periods' width:

    B <theta''> + D <theta'> + C <sgn theta'> - <tau> = <F>^T alpha,
    <theta''> = (theta(k) - 2 theta(k-1) + theta(k-2)) / T^2      exactly,
    <x> = (x(k) + 10 x(k-1) + x(k-2)) / 12                        sampled signals,
    <tau> = (tau(k-1) + tau(k-2)) / 2                             exactly, held commands.

The sequence of tested balances then goes through an operator: poles (``kernels.cascade``) or a
window (``kernels.window``). No signal is differentiated but under the test function; the same
operator on every term leaves no lag bias, whatever its width.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import basis, rows
from rotatum.kernels.rows import (
    COULOMB,
    DAMPING,
    FIRST,
    INERTIA,
    MOVED,
    PULL,
    SKEW,
    TRANSMISSION_DAMPING,
    Y,
    find_zero,
    hat,
    read_basis,
)
from rotatum.record import Record, integer, number, vector

RING = 64


class WeakParams(Record):
    """The motor, and which columns are fitted."""

    period = number("time between samples", unit="s", symbol="T")
    delay = integer("samples a row lags behind, half the span of the velocity; 0: no friction")
    held = integer(
        "1: the torque is a command held until the next sample; 0: measured at the instant"
    )
    inertia = number("motor inertia, joint side", unit="kg m^2", symbol="B")
    damping = number("motor damping, joint side", unit="N m s/rad", symbol="D")
    coulomb = number("motor Coulomb friction, joint side", unit="N m", symbol="C")
    width = number("speed below which Coulomb friction is proportional to speed", unit="rad/s")
    kind = vector("p", "what each column before the basis is", kind="int")
    scale = vector("p", "what each of these is divided by")


class WeakState(Record):
    """The samples a hat spans, and the balance tested with it."""

    count = integer("samples since (re)start")
    q = vector(RING, "link positions, the last ones in a ring", unit="rad")
    theta = vector(RING, "motor positions, the same", unit="rad")
    torque = vector(RING, "torques, the same", unit="N m")
    head = integer("where the sample of now is in the ring")
    length = integer("samples in the ring")
    q0 = number("q(k), k being `delay` samples ago", unit="rad")
    q1 = number("q(k-1)", unit="rad")
    q2 = number("q(k-2)", unit="rad")
    theta0 = number("theta(k)", unit="rad")
    theta1 = number("theta(k-1)", unit="rad")
    theta2 = number("theta(k-2)", unit="rad")
    setpoint0 = number("set-point(k)")
    torque0 = number("torque(k)", unit="N m")
    torque1 = number("torque(k-1)", unit="N m")
    torque2 = number("torque(k-2)", unit="N m")
    sign0 = number("sgn theta'(k)")
    sign1 = number("sgn theta'(k-1)")
    sign2 = number("sgn theta'(k-2)")
    setpoint = vector(RING, "set-points, the same")
    F1 = vector("p", "basis(k-1)", symbol="F")
    F2 = vector("p", "basis(k-2)", symbol="F")
    acceleration = number("<theta''>", unit="rad/s^2")
    velocity = number("<theta'>", unit="rad/s")
    friction = number("<sgn theta'>")
    raw = vector("c", "left side, acceleration, link moved in two periods, columns")
    made = integer("1: there are terms at this sample")


def motor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.weak.count = 0


def motor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Terms from motor position and torque. ``u`` carries ``fresh``: 1 starts anew."""
    p = params.weak
    w = state.weak
    w.made = 0
    _deflect(params, state, u, out)
    if p.delay == 0:
        _now(w, u)
        _advance(p, w, state.terms)
    else:
        _store(w, u)
        if w.length > 2 * p.delay:
            _past(p, w)
            phi = w.q0 - w.theta0 - state.zero.zero
            basis.evaluate(params.basis, state.past, phi, w.setpoint0)
            _advance(p, w, state.past)


def sensor_init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.weak.count = 0


def sensor_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Terms from a torque sensor: the same operator on measured torque and basis."""
    w = state.weak
    w.made = 0
    _deflect(params, state, u, out)
    _now(w, u)
    if w.count >= 2:
        w.raw[Y] = hat(w.torque2, w.torque1, w.torque0)
        _columns(params.weak, w, state.terms)
    _remember(w, state.terms)


def _deflect(params: Any, state: Any, u: Any, out: Any) -> None:
    raw = u.q - u.theta
    known = find_zero(params.zero, state.zero, raw, u.fresh)
    if u.fresh != 0 or known == 0:
        state.weak.count = 0
        state.weak.length = 0
    phi = raw - state.zero.zero
    basis.evaluate(params.basis, state.terms, phi, u.setpoint)
    read_basis(state.terms, out)
    out.phi = phi


def _now(w: Any, u: Any) -> None:
    w.q0 = u.q
    w.theta0 = u.theta
    w.torque0 = u.torque
    w.sign0 = 0.0


def _store(w: Any, u: Any) -> None:
    w.head = w.head + 1
    if w.head >= RING:
        w.head = 0
    w.q[w.head] = u.q
    w.theta[w.head] = u.theta
    w.torque[w.head] = u.torque
    w.setpoint[w.head] = u.setpoint
    if w.length < RING:
        w.length = w.length + 1


def _past(p: Any, w: Any) -> None:
    """Take the sample ``delay`` ago, with the sign of its velocity from both its sides.

    A velocity filtered causally turns its sign late, and always at the ends of the motion, where
    the deflection is largest: Coulomb friction would leak into the stiffness. The difference
    across the sample is on time, and its row is only ``delay`` samples later.
    """
    middle = w.head - p.delay
    if middle < 0:
        middle = middle + RING
    first = middle - p.delay
    if first < 0:
        first = first + RING
    w.q0 = w.q[middle]
    w.theta0 = w.theta[middle]
    w.torque0 = w.torque[middle]
    w.setpoint0 = w.setpoint[middle]
    velocity = (w.theta[w.head] - w.theta[first]) / (2.0 * p.delay * p.period)
    w.sign0 = rows.sign(velocity, p.width)


def _advance(p: Any, w: Any, terms: Any) -> None:
    if w.count >= 2:
        _balance(p, w)
        _columns(p, w, terms)
    _remember(w, terms)


def _balance(p: Any, w: Any) -> None:
    if p.held != 0:
        tau = 0.5 * (w.torque2 + w.torque1)
    else:
        tau = hat(w.torque2, w.torque1, w.torque0)
    rate = 1.0 / p.period
    w.acceleration = (w.theta0 - 2.0 * w.theta1 + w.theta2) * rate * rate
    w.velocity = 0.5 * (w.theta0 - w.theta2) * rate
    w.friction = hat(w.sign2, w.sign1, w.sign0)
    w.raw[Y] = p.inertia * w.acceleration + p.damping * w.velocity + p.coulomb * w.friction - tau


def _columns(p: Any, w: Any, terms: Any) -> None:
    T = p.period
    w.made = 1
    w.raw[PULL] = w.acceleration
    w.raw[MOVED] = w.q0 - w.q2
    first = len(w.raw) - len(terms.F)
    for h in range(len(terms.F)):
        w.raw[first + h] = hat(w.F2[h], w.F1[h], terms.F[h])
    for h in range(first - FIRST):
        kind = p.kind[h]
        if kind == INERTIA:
            column = -w.acceleration
        elif kind == DAMPING:
            column = -w.velocity
        elif kind == COULOMB:
            column = -w.friction
        elif kind == SKEW:
            column = (w.q0 - w.q2) / (2.0 * T)
        elif kind == TRANSMISSION_DAMPING:
            column = ((w.q0 - w.theta0) - (w.q2 - w.theta2)) / (2.0 * T)
        else:
            column = 1.0
        w.raw[FIRST + h] = column / p.scale[h]


def _remember(w: Any, terms: Any) -> None:
    w.q2 = w.q1
    w.q1 = w.q0
    w.theta2 = w.theta1
    w.theta1 = w.theta0
    w.torque2 = w.torque1
    w.torque1 = w.torque0
    w.sign2 = w.sign1
    w.sign1 = w.sign0
    for h in range(len(terms.F)):
        w.F2[h] = w.F1[h]
        w.F1[h] = terms.F[h]
    w.count = w.count + 1
