"""Selective updates (trumic2022, Remark 4 and section V): nothing is learnt near a standstill.

Static friction jumps where the link turns round, and a link that stands still tells nothing of what
its motors do to the stiffness. The gate stands between rows and solver, whatever the method: it
closes where the link's speed falls below one threshold and opens above a higher one. What a row is
made of lies ``late`` to ``span`` samples back: it counts where the gate was open all that while,
and so for a while after the gate has closed.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import kinematic
from rotatum.kernels.status import HELD, STILL
from rotatum.record import Field, Record, integer, number


class GateParams(Record):
    """Where updates stop and start."""

    velocity = Field(kinematic.KinematicParams.layout(), doc="filter of the link's velocity")
    low = number("link speed below which the gate closes", unit="rad/s")
    high = number("link speed above which it opens", unit="rad/s")
    span = integer("samples back to where what a row is made of begins")
    late = integer("samples back to where it ends, less than span")
    hold = integer("samples in a row after which the joint is said to stand still")


class GateState(Record):
    """Whether the gate is open, and since when."""

    velocity = Field(kinematic.KinematicState.layout(), doc="position and velocity of the link")
    open = integer("1: the link moves")
    clear = integer("samples since it opened, span at most; 0 while it is closed")
    run = integer("samples it had been open for when it closed, span at most")
    ago = integer("samples since it closed, late + 1 at most")
    held = integer("samples in a row without a row to learn from, hold at most")


def init(params: Any, state: Any) -> None:
    """Closed until the link is seen to move."""
    kinematic.init(params.velocity, state.velocity)
    _shut(params, state)
    state.held = 0


def _shut(params: Any, state: Any) -> None:
    """Close, and forget that it was ever open."""
    state.open = 0
    state.clear = 0
    state.run = 0
    state.ago = params.late + 1


def step(params: Any, state: Any, q: float, fresh: int, row: Any) -> None:
    """Take the link's position; hold the row back where updates are to stop."""
    v = state.velocity
    if fresh != 0 or v.count == 0:
        kinematic.start(params.velocity, v, q)
        _shut(params, state)
    else:
        kinematic.observe(params.velocity, v, q)
    speed = math.fabs(v.velocity)
    if speed < params.low:
        state.open = 0
    if speed > params.high:
        state.open = 1
    _count(params, state)
    if _moved(params, state) != 0:
        state.held = 0
    else:
        row.valid = 0
        row.status = row.status | HELD
        if state.held < params.hold:
            state.held = state.held + 1
        if state.held >= params.hold:
            row.status = row.status | STILL


def _count(params: Any, state: Any) -> None:
    if state.open != 0:
        if state.clear < params.span:
            state.clear = state.clear + 1
        return
    if state.clear > 0:
        state.run = state.clear
        state.clear = 0
        state.ago = 0
    if state.ago <= params.late:
        state.ago = state.ago + 1


def _moved(params: Any, state: Any) -> int:
    """Whether the gate was open all the while that the row is made of."""
    if state.clear >= params.span:
        return 1
    if state.open == 0 and state.ago <= params.late and state.run + state.ago >= params.span:
        return 1
    return 0
