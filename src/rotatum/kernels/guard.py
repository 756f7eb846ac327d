"""What becomes of a sample before an estimator sees it: accepted, bridged, restarted or refused."""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels.status import (
    BACKWARDS,
    BRIDGED,
    GAP,
    JUMP,
    NOT_FINITE,
    REPEATED,
    RESTARTED,
    SATURATED,
)
from rotatum.record import Record, integer, number, vector

BEYOND = 1e12  # of any unit: no sensor measures it, and powers of it overflow
PATIENCE = 10  # samples from the past before the clock is believed to have been set back


class GuardParams(Record):
    """What a good sample looks like."""

    period = number("nominal time between samples", unit="s", symbol="T")
    missing = integer("samples in a row that may be missing and are bridged by straight lines")
    jump = vector("c", "largest change per period, 0: no limit", unit="unit of the channel")
    wrap = vector(
        "c", "the channel is counted modulo this, 0: it is not", unit="unit of the channel"
    )
    limit = vector("c", "the channel saturates at +- this, 0: never", unit="unit of the channel")


class GuardState(Record):
    """The last good sample, the one at hand, and counts of what was wrong."""

    now = vector("c", "sample at hand, unwrapped", unit="unit of the channel")
    last = vector("c", "last good sample", unit="unit of the channel")
    mix = vector("c", "sample handed on", unit="unit of the channel")
    time = number("of the last good sample", unit="s")
    mix_time = number("of the sample handed on", unit="s")
    fresh = integer("1: the filters must start at the sample handed on")
    started = integer("1: a good sample has been seen since reset")
    status = integer("status bits of the sample at hand")
    past = integer("samples in a row whose time was before the last good one")
    accepted = integer("good samples")
    bridged = integer("samples filled in")
    not_finite = integer("samples refused: NaN or infinite")
    repeated = integer("samples refused: time stamp repeated or early")
    backwards = integer("samples refused: time ran backwards")
    saturated = integer("samples refused: at a limit")
    restarts = integer("times the filters had to start again: gaps, jumps, saturation")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet; the rest of a zeroed state is as it should be."""
    state.started = 0
    state.fresh = 1


def plan(params: Any, state: Any, time: float) -> int:
    """Judge the sample in ``state.now``: how many steps to take, 0 when it is refused."""
    elapsed = (time - state.time) / params.period
    state.status = _refusal(params, state, time, elapsed)
    if state.status != 0:
        return 0
    steps = 1
    if state.started == 0:
        state.fresh = 1
    else:
        _unwrap(params, state)
        if elapsed >= params.missing + 1.5:
            _restart(state, GAP)
        elif state.fresh == 0:
            steps = int(elapsed + 0.5)
            if _jumped(params, state, steps) != 0:
                _restart(state, JUMP)
            elif steps > 1:
                state.status = state.status | BRIDGED
                state.bridged = state.bridged + steps - 1
    if state.fresh != 0:
        steps = 1
        state.status = state.status | RESTARTED
        for i in range(len(state.now)):
            state.last[i] = state.now[i]
    state.started = 1
    state.past = 0
    state.accepted = state.accepted + 1
    return steps


def _restart(state: Any, reason: int) -> None:
    if state.fresh == 0:
        state.restarts = state.restarts + 1
    state.fresh = 1
    state.status = state.status | reason


def fill(params: Any, state: Any, time: float, k: int, steps: int) -> None:
    """Put step ``k`` of ``steps`` on the straight line from the last good sample to this one."""
    if steps == 1:
        for i in range(len(state.now)):
            state.mix[i] = state.now[i]
        state.mix_time = time
        return
    part = (k + 1.0) / steps
    for i in range(len(state.now)):
        state.mix[i] = state.last[i] + part * (state.now[i] - state.last[i])
    state.mix_time = time - (steps - 1.0 - k) * params.period


def finish(params: Any, state: Any, time: float) -> None:
    """The sample has been used: it is the last good one."""
    for i in range(len(state.now)):
        state.last[i] = state.now[i]
    state.time = time
    state.fresh = 0


def _refusal(params: Any, state: Any, time: float, elapsed: float) -> int:
    broken = time - time
    for i in range(len(state.now)):
        broken = broken + (state.now[i] - state.now[i])
        if math.fabs(state.now[i]) > BEYOND:
            broken = 1.0
    if broken != 0.0:  # x - x is 0 but for NaN and infinities
        state.not_finite = state.not_finite + 1
        return NOT_FINITE
    for i in range(len(state.now)):
        if params.limit[i] > 0.0 and math.fabs(state.now[i]) >= params.limit[i]:
            state.saturated = state.saturated + 1
            if state.fresh == 0:
                state.restarts = state.restarts + 1
            state.fresh = 1
            return SATURATED
    if state.started == 0:
        return 0
    if elapsed < -0.5:
        state.backwards = state.backwards + 1
        state.past = state.past + 1
        if state.past >= PATIENCE:
            state.started = 0  # the clock was set back: the next sample starts anew
            state.past = 0
            state.restarts = state.restarts + 1
        return BACKWARDS
    if elapsed < 0.5:
        state.repeated = state.repeated + 1
        return REPEATED
    return 0


def _unwrap(params: Any, state: Any) -> None:
    for i in range(len(state.now)):
        if params.wrap[i] > 0.0:
            turns = (state.last[i] - state.now[i]) / params.wrap[i]
            if turns > 0.5 and turns < 1e9:
                state.now[i] = state.now[i] + params.wrap[i] * int(turns + 0.5)
            if turns < -0.5 and turns > -1e9:
                state.now[i] = state.now[i] - params.wrap[i] * int(0.5 - turns)


def _jumped(params: Any, state: Any, steps: int) -> int:
    for i in range(len(state.now)):
        change = math.fabs(state.now[i] - state.last[i])
        if params.jump[i] > 0.0 and change > params.jump[i] * steps:
            return 1
    return 0
