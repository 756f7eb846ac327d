"""Terms of the weak form on the link side: no torque, and nothing of the motor but its position.

A joint of its own (a pendulum) is tested with the hats of ``kernels.weak``,

    -M <q''> - D <q'> - C <sgn q'> - G <sin q> = <F>^T alpha,

exactly in q''. A joint of an arm is tested with boxes of two periods, whose derivative is a
difference of the momentum ``p = M(q) q'`` across them,

    -(p(k) - p(k-2)) / 2T + <(C^T q' - g)_i> - D <q'> - C <sgn q'> = <F>^T alpha,
    <x> = (x(k) + 4 x(k-1) + x(k-2)) / 6.

The velocity inside p is a difference across its sample (``kernels.arm``): on time two samples
later, so that everything else waits for it. A velocity filtered causally would come late where the
rest is on time.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import basis, rows
from rotatum.kernels.rows import (
    FIRST,
    GRAVITY_TORQUE,
    LINK_COULOMB,
    LINK_DAMPING,
    MOVED,
    PAYLOAD,
    PULL,
    SKEW,
    TRANSMISSION_DAMPING,
    Y,
    find_zero,
)
from rotatum.record import Record, integer, number, vector

RING = 64
AHEAD = 2  # samples by which what the arm says comes late


class LinkParams(Record):
    """The link, and which columns are fitted."""

    period = number("time between samples", unit="s", symbol="T")
    delay = integer("samples the terms lag behind: half the span of the velocity; 0: none needed")
    arm = integer("1: momentum and force come from an arm; 0: the link is a pendulum of its own")
    inertia = number("of the pendulum", unit="kg m^2", symbol="M")
    damping = number("of the link", unit="N m s/rad", symbol="D")
    coulomb = number("Coulomb friction of the link", unit="N m", symbol="C")
    gravity = number("of the pendulum, g(q) = G sin q", unit="N m", symbol="G")
    width = number("speed below which Coulomb friction is proportional to speed", unit="rad/s")
    kind = vector("p", "what each column before the basis is", kind="int")
    scale = vector("p", "what each of these is divided by")


class LinkMoment(Record):
    """One instant of the joint, as the test function reads it."""

    q = number("link position", unit="rad")
    theta = number("motor position, the mean of two", unit="rad")
    sign = number("sgn q'")
    sine = number("sin q")
    momentum = number("of the arm", unit="N m s")
    force = number("C^T q' - g of the arm", unit="N m")
    payload_momentum = number("of 1 kg", unit="N m s/kg")
    payload_force = number("of 1 kg", unit="N m/kg")
    F = vector("p", "basis", symbol="F")


class LinkState(Record):
    """Samples in rings, three instants, and the balance tested with them."""

    count = integer("instants since (re)start")
    head = integer("where the sample of now is in the rings")
    length = integer("samples in the rings")
    q = vector(RING, "link positions", unit="rad")
    theta = vector(RING, "motor positions", unit="rad")
    theta2 = vector(RING, "the antagonist's", unit="rad")
    setpoint = vector(RING, "set-points")
    momentum = vector(RING, "of the arm, as they came", unit="N m s")
    force = vector(RING, "of the arm, as they came", unit="N m")
    payload_momentum = vector(RING, "of 1 kg, as they came", unit="N m s/kg")
    payload_force = vector(RING, "of 1 kg, as they came", unit="N m/kg")
    raw = vector("c", "left side, acceleration, link moved in two periods, columns")
    made = integer("1: there are terms at this sample")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.link.count = 0


def one_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Terms of a joint with one transmission."""
    s = state.link
    raw = u.q - u.theta
    known = find_zero(params.zero, state.zero, raw, u.fresh)
    _start(s, u.fresh, known)
    phi = raw - state.zero.zero
    basis.evaluate(params.basis, state.terms, phi, u.setpoint)
    rows.read_basis(state.terms, out)
    out.phi = phi
    _store(s, u)
    if s.length > 2 * params.link.delay:
        _shift(state.before, state.middle)
        _shift(state.middle, state.now)
        at = _instant(params.link, s, state.now)
        state.now.theta = s.theta[at]
        phi = s.q[at] - s.theta[at] - state.zero.zero
        basis.evaluate(params.basis, state.terms, phi, s.setpoint[at])
        for h in range(len(state.terms.F)):
            state.now.F[h] = state.terms.F[h]
        _advance(params.link, state, s, len(state.terms.F))


def pair_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Terms of a joint with two transmissions: their torques add up on the link.

    Columns of the basis come in pairs, agonist first, from low to high order.
    """
    s = state.link
    known = find_zero(params.zero, state.zero, u.q - u.theta, u.fresh)
    known = known * find_zero(params.zero2, state.zero2, u.q - u.theta2, u.fresh)
    _start(s, u.fresh, known)
    phi = u.q - u.theta - state.zero.zero
    phi2 = u.q - u.theta2 - state.zero2.zero
    basis.evaluate(params.basis, state.terms, phi, u.setpoint)
    basis.evaluate(params.basis, state.terms2, phi2, u.setpoint)
    rows.read_pair(state.terms, state.terms2, out)
    out.phi = phi
    out.phi2 = phi2
    _store(s, u)
    s.theta2[s.head] = u.theta2
    if s.length > 2 * params.link.delay:
        _shift(state.before, state.middle)
        _shift(state.middle, state.now)
        at = _instant(params.link, s, state.now)
        state.now.theta = 0.5 * (s.theta[at] + s.theta2[at])
        phi = s.q[at] - s.theta[at] - state.zero.zero
        phi2 = s.q[at] - s.theta2[at] - state.zero2.zero
        basis.evaluate(params.basis, state.terms, phi, s.setpoint[at])
        basis.evaluate(params.basis, state.terms2, phi2, s.setpoint[at])
        for h in range(len(state.terms.F)):
            state.now.F[2 * h] = state.terms.F[h]
            state.now.F[2 * h + 1] = state.terms2.F[h]
        _advance(params.link, state, s, 2 * len(state.terms.F))


def _start(s: Any, fresh: int, known: int) -> None:
    s.made = 0
    if fresh != 0 or known == 0:
        s.count = 0
        s.length = 0


def _store(s: Any, u: Any) -> None:
    s.head = s.head + 1
    if s.head >= RING:
        s.head = 0
    s.q[s.head] = u.q
    s.theta[s.head] = u.theta
    s.setpoint[s.head] = u.setpoint
    s.momentum[s.head] = u.momentum
    s.force[s.head] = u.force
    s.payload_momentum[s.head] = u.payload_momentum
    s.payload_force[s.head] = u.payload_force
    if s.length < RING:
        s.length = s.length + 1


def _ago(s: Any, samples: int) -> int:
    at: int = s.head - samples
    if at < 0:
        at = at + RING
    return at


def _instant(p: Any, s: Any, now: Any) -> int:
    """Fill in the instant ``delay`` samples ago; returns where it is in the rings."""
    at = _ago(s, p.delay)
    now.q = s.q[at]
    now.sine = math.sin(s.q[at])
    now.sign = 0.0
    if p.delay > 0:
        ends = s.q[s.head] - s.q[_ago(s, 2 * p.delay)]
        now.sign = rows.sign(ends / (2.0 * p.delay * p.period), p.width)
    if p.arm != 0:
        came = _ago(s, p.delay - AHEAD)
        now.momentum = s.momentum[came]
        now.force = s.force[came]
        now.payload_momentum = s.payload_momentum[came]
        now.payload_force = s.payload_force[came]
    return at


def _shift(target: Any, source: Any) -> None:
    target.q = source.q
    target.theta = source.theta
    target.sign = source.sign
    target.sine = source.sine
    target.momentum = source.momentum
    target.force = source.force
    target.payload_momentum = source.payload_momentum
    target.payload_force = source.payload_force
    for h in range(len(source.F)):
        target.F[h] = source.F[h]


def _advance(p: Any, state: Any, s: Any, terms: int) -> None:
    if s.count >= 2:
        s.made = 1
        _balance(p, s, state.before, state.middle, state.now)
        _columns(p, s, state.before, state.middle, state.now, terms)
    s.count = s.count + 1


def _edge(p: Any) -> float:
    """Weight of either end in the mean under the test function: a hat's, or a box's."""
    if p.arm != 0:
        return 1.0 / 6.0
    return 1.0 / 12.0


def _mean(edge: float, before: float, middle: float, after: float) -> float:
    return edge * (before + after) + (1.0 - 2.0 * edge) * middle


def _balance(p: Any, s: Any, before: Any, middle: Any, now: Any) -> None:
    rate = 1.0 / p.period
    edge = _edge(p)
    acceleration = (now.q - 2.0 * middle.q + before.q) * rate * rate
    velocity = 0.5 * (now.q - before.q) * rate
    if p.arm != 0:
        load = 0.5 * (now.momentum - before.momentum) * rate
        load = load - _mean(edge, before.force, middle.force, now.force)
    else:
        load = p.inertia * acceleration
        load = load + p.gravity * _mean(edge, before.sine, middle.sine, now.sine)
    friction = p.coulomb * _mean(edge, before.sign, middle.sign, now.sign)
    s.raw[Y] = -(load + p.damping * velocity + friction)
    s.raw[PULL] = acceleration
    s.raw[MOVED] = now.q - before.q


def _columns(p: Any, s: Any, before: Any, middle: Any, now: Any, terms: int) -> None:
    rate = 0.5 / p.period
    edge = _edge(p)
    first = len(s.raw) - terms
    for h in range(terms):
        s.raw[first + h] = _mean(edge, before.F[h], middle.F[h], now.F[h])
    for h in range(first - FIRST):
        kind = p.kind[h]
        if kind == LINK_DAMPING:
            column = (now.q - before.q) * rate
        elif kind == LINK_COULOMB:
            column = _mean(edge, before.sign, middle.sign, now.sign)
        elif kind == GRAVITY_TORQUE:
            column = _mean(edge, before.sine, middle.sine, now.sine)
        elif kind == PAYLOAD:
            column = (now.payload_momentum - before.payload_momentum) * rate
            force = _mean(edge, before.payload_force, middle.payload_force, now.payload_force)
            column = column - force
        elif kind == SKEW:
            column = (now.theta - before.theta) * rate
        elif kind == TRANSMISSION_DAMPING:
            column = ((now.q - now.theta) - (before.q - before.theta)) * rate
        else:
            column = 1.0
        s.raw[FIRST + h] = column / p.scale[h]
