"""The samples of a whole arm before its momentum is known: judged together, link velocities.

Momentum and forces of every joint depend on all link positions, so that a sample is good for the
arm or for none of its joints. Missing samples are bridged here; each filled one goes through the
same difference, and through the arm's dynamics, as a measured one.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import guard
from rotatum.record import Record, integer, matrix, number, vector

SPAN = 5  # samples a link velocity is a difference over; it belongs to the middle one


class ArmSample(Record):
    """One sample of an arm of n joints; what a joint does not have is 0."""

    time = number("of the sample", unit="s", symbol="t")
    q = vector("n", "link positions", unit="rad", symbol="q")
    theta = vector("n", "motor positions, joint side; the agonists'", unit="rad", symbol="theta")
    theta2 = vector("n", "the antagonists'", unit="rad", symbol="theta_2")
    setpoint = vector("n", "set-points as logged")


class ArmParams(Record):
    """How samples are spaced."""

    period = number("time between samples", unit="s", symbol="T")


class ArmState(Record):
    """The last link positions, oldest first."""

    recent = matrix(SPAN, "n", "link positions", unit="rad")
    length = integer("samples in them")


class ArmSteps(Record):
    """What becomes of one sample: up to m of them where some before it were missing."""

    steps = integer("samples to take now, 0: the sample is refused")
    status = integer("status bits of the sample")
    fresh = integer("1: the filters must start at the first of them")
    time = vector("m", "of each", unit="s")
    known = vector("m", "1: q_past and dq_past are known", kind="int")
    q = matrix("m", "n", "link positions", unit="rad")
    theta = matrix("m", "n", "motor positions", unit="rad")
    theta2 = matrix("m", "n", "the antagonists'", unit="rad")
    setpoint = matrix("m", "n", "set-points")
    q_past = matrix("m", "n", "link positions two samples ago", unit="rad")
    dq_past = matrix("m", "n", "link velocities then", unit="rad/s")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    guard.init(params.guard, state.guard)
    state.arm.length = 0


def step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Judge a sample and make link velocities of what it fills in.

    ``q'(k-2) = (8 (q(k-1) - q(k-3)) - (q(k) - q(k-4))) / 12 T``, whose error is T^4/30 times the
    fifth derivative.
    """
    g = state.guard
    n = len(u.q)
    for i in range(n):
        g.now[i] = u.q[i]
        g.now[n + i] = u.theta[i]
        g.now[2 * n + i] = u.theta2[i]
        g.now[3 * n + i] = u.setpoint[i]
    out.steps = guard.plan(params.guard, g, u.time)
    out.status = g.status
    out.fresh = g.fresh
    if g.fresh != 0 and out.steps > 0:
        state.arm.length = 0
    for k in range(out.steps):
        guard.fill(params.guard, g, u.time, k, out.steps)
        out.time[k] = g.mix_time
        for i in range(n):
            out.q[k, i] = g.mix[i]
            out.theta[k, i] = g.mix[n + i]
            out.theta2[k, i] = g.mix[2 * n + i]
            out.setpoint[k, i] = g.mix[3 * n + i]
        _push(state.arm, out, k, n)
        _velocities(params.arm, state.arm, out, k, n)
    if out.steps > 0:
        guard.finish(params.guard, g, u.time)


def _push(s: Any, out: Any, k: int, n: int) -> None:
    for i in range(n):
        for m in range(SPAN - 1):
            s.recent[m, i] = s.recent[m + 1, i]
        s.recent[SPAN - 1, i] = out.q[k, i]
    if s.length < SPAN:
        s.length = s.length + 1


def _velocities(p: Any, s: Any, out: Any, k: int, n: int) -> None:
    out.known[k] = 0
    if s.length >= SPAN:
        out.known[k] = 1
        scale = 1.0 / (12.0 * p.period)
        for i in range(n):
            inner = s.recent[3, i] - s.recent[1, i]
            outer = s.recent[4, i] - s.recent[0, i]
            out.q_past[k, i] = s.recent[2, i]
            out.dq_past[k, i] = (8.0 * inner - outer) * scale
