"""Selective updates (trumic2022, Remark 4 and section V): nothing is learnt near a standstill.

Static friction jumps where the link turns round, and a link that stands still tells nothing of what
its motors do to the stiffness. The gate stands between rows and solver, whatever the method: it
closes where the link's speed falls below one threshold and opens above a higher one; a row counts
again once its operator has forgotten what came before that.
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
    span = integer("samples a row remembers")
    hold = integer("samples in a row after which the joint is said to stand still")


class GateState(Record):
    """Whether the gate is open, and since when."""

    velocity = Field(kinematic.KinematicState.layout(), doc="position and velocity of the link")
    open = integer("1: the link moves")
    clear = integer("samples since it opened, span at most")
    held = integer("samples in a row without a row to learn from, hold at most")


def init(params: Any, state: Any) -> None:
    """Closed until the link is seen to move."""
    kinematic.init(params.velocity, state.velocity)
    state.open = 0
    state.clear = 0
    state.held = 0


def step(params: Any, state: Any, q: float, fresh: int, row: Any) -> None:
    """Take the link's position; hold the row back where updates are to stop."""
    v = state.velocity
    if fresh != 0 or v.count == 0:
        kinematic.start(params.velocity, v, q)
        state.open = 0
    else:
        kinematic.observe(params.velocity, v, q)
    speed = math.fabs(v.velocity)
    if speed < params.low:
        state.open = 0
    if speed > params.high:
        state.open = 1
    if state.open == 0:
        state.clear = 0
    elif state.clear < params.span:
        state.clear = state.clear + 1
    if state.clear >= params.span:
        state.held = 0
    else:
        row.valid = 0
        row.status = row.status | HELD
        if state.held < params.hold:
            state.held = state.held + 1
        if state.held >= params.hold:
            row.status = row.status | STILL
