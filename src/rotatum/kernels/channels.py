"""Channels of several joints judged together: a sample is good for all of them or for none.

What links tell of each other, an accelerometer's reading above all, belongs to one instant of the
whole arm. Missing samples are bridged here, before whatever needs all channels at once.
"""

from __future__ import annotations

from typing import Any

from rotatum.kernels import guard
from rotatum.record import Record, integer, matrix, number, vector


class ChannelsSample(Record):
    """One sample of c channels."""

    time = number("of the sample", unit="s", symbol="t")
    y = vector("c", "the channels", unit="unit of the channel")


class ChannelsSteps(Record):
    """What becomes of one sample: up to m of them where some before it were missing."""

    steps = integer("samples to take now, 0: the sample is refused")
    status = integer("status bits of the sample")
    fresh = integer("1: what came before the first of them does not adjoin")
    time = vector("m", "of each", unit="s")
    y = matrix("m", "c", "the channels", unit="unit of the channel")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    guard.init(params.guard, state.guard)


def step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Judge a sample; fill in what was missing before it."""
    g = state.guard
    for i in range(len(u.y)):
        g.now[i] = u.y[i]
    out.steps = guard.plan(params.guard, g, u.time)
    out.status = g.status
    out.fresh = g.fresh
    for k in range(out.steps):
        guard.fill(params.guard, g, u.time, k, out.steps)
        out.time[k] = g.mix_time
        for i in range(len(u.y)):
            out.y[k, i] = g.mix[i]
    if out.steps > 0:
        guard.finish(params.guard, g, u.time)
