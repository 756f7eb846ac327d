"""Rows of trumic2022: the elastic rotatum against the rate of the torque's basis.

The balance of the link, differentiated,

    -d/dt (M q'' + D q' + g) = dF/dt^T alpha,

a pendulum's as ``M q''' + D q'' + G d/dt sin q``, an arm's from its model (eq. 9 with its signs
corrected). Jerk, acceleration and rates are estimates of one observer and belong to one instant,
``lag`` samples ago. The terms of the spring are formed of positions as they were measured and then
observed, so that both sides of the balance are as late and as smooth as each other; the paper's
``dF/dt = F_phi phi' + F_s s'`` (Tables I and II, here tied) of observed positions is the same only
where the spring is linear: see ``rates``.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import basis, rates, rows, unknown_input
from rotatum.kernels.rows import find_zero
from rotatum.kernels.status import DISABLED, SETTLING
from rotatum.record import Record, integer, number, vector

RATE = 1
ACCELERATION = 2
JERK = 3
"""Places in what the observer estimates."""
SINE = 0
FIRST = 1
"""Places in the signals whose rates are wanted: sin q, then the terms of the spring."""


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
    sample = vector(1, "what the link's observer is given")
    raw = vector("c", "what the rates are taken of")


class RotatumSample(Record):
    """One sample of a joint seen from its link, as the rows of the rotatum read it."""

    time = number("of the sample", unit="s", symbol="t")
    q = number("link position", unit="rad", symbol="q")
    theta = number("motor position, joint side; the agonist's of two", unit="rad", symbol="theta")
    theta2 = number("the antagonist's", unit="rad", symbol="theta_2")
    setpoint = number("set-point as logged, 0: there is none", symbol="s")
    acceleration = number("of the link as the arm observed it, lag samples ago", unit="rad/s^2")
    rotatum = number("of the arm then, without friction", unit="N m/s", symbol="p_e")
    enable = integer("0: do not learn from this sample")
    fresh = integer("1: the filters must start at this sample")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.rotatum.count = 0
    unknown_input.init(params.observer, state.link)
    rates.init(state.rates)


def one_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Row of a joint with one transmission."""
    raw = u.q - u.theta
    known = find_zero(params.zero, state.zero, raw, u.fresh)
    basis.evaluate(params.basis, state.terms, raw - state.zero.zero, u.setpoint)
    rows.read_basis(state.terms, out)
    out.phi = raw - state.zero.zero
    for h in range(len(state.terms.F)):
        state.rotatum.raw[FIRST + h] = state.terms.F[h]
    _observe(params, state, u, known)
    _balance(params.rotatum, state, u, out)
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
    for h in range(len(state.terms.F)):
        state.rotatum.raw[FIRST + 2 * h] = state.terms.F[h]
        state.rotatum.raw[FIRST + 2 * h + 1] = state.terms2.F[h]
    _observe(params, state, u, known)
    _balance(params.rotatum, state, u, out)
    _emit(state, u.enable, out)


def _observe(params: Any, state: Any, u: Any, known: int) -> None:
    s = state.rotatum
    s.made = 0
    if u.fresh != 0 or known == 0:
        s.count = 0
        unknown_input.restart(state.link)
        rates.restart(state.rates)
    if known != 0:
        s.count = s.count + 1
        s.raw[SINE] = 0.0
        if params.rotatum.arm == 0:
            s.raw[SINE] = math.sin(u.q)
            s.sample[0] = u.q
            unknown_input.push(params.observer, state.link, s.sample)
        else:
            # The arm has observed all its links: none is observed twice.
            state.link.estimate[ACCELERATION] = u.acceleration
        rates.push(params.observer, state.rates, s.raw, RATE)
        s.made = state.rates.valid


def _balance(p: Any, state: Any, u: Any, out: Any) -> None:
    if state.rotatum.made != 0:
        link = state.link.estimate
        if p.arm != 0:
            out.y = u.rotatum - p.damping * link[ACCELERATION]
        else:
            load = p.inertia * link[JERK] + p.damping * link[ACCELERATION]
            out.y = -(load + p.gravity * state.rates.value[SINE])
        out.suspect = link[JERK]
        out.drag = link[ACCELERATION]
        first = len(out.R) + FIRST - len(state.rates.value)
        for h in range(len(state.rates.value) - FIRST):
            out.R[first + h] = state.rates.value[FIRST + h]


def _emit(state: Any, enable: int, out: Any) -> None:
    out.fresh = 0
    if state.rotatum.count <= 1:
        out.fresh = 1
    out.status = 0
    out.valid = state.rotatum.made
    if state.rates.settled == 0:
        out.valid = 0
        out.status = SETTLING
    if enable == 0:
        out.valid = 0
        out.status = out.status | DISABLED
