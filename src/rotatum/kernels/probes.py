"""Tests of the model: what the residual goes with that it should not, and when that is believed.

Each probe is a signal that a kind of mistake would leave in the residual: its mean, the change of
the torque, the acceleration, the torque itself, the velocity. Their sums are part of the evidence
(``kernels.evidence``), which this reads and writes.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels import blocks
from rotatum.kernels.status import DRIFT, INERTIA, LAG, OFFSET, VELOCITY

RING = 64
MEAN = 0
SHIFT = 1
PULL = 2
SCALE = 3
DRAG = 4
PROBES = 5
MOMENTS = 8
STREAK = 3  # evaluations in a row before a probe is believed
CONFIDENT = 2.5  # of a self-normalised sum over >= 8 blocks: one in 700 by chance


def take(params: Any, state: Any, sums: Any, at: int, after: float) -> None:
    """Add the residual ``lag`` rows ago times each probe; ``after`` is the torque fitted now."""
    middle = state.head - params.lag
    if middle < 0:
        middle = middle + RING
    first = middle - params.lag
    if first < 0:
        first = first + RING
    e = state.e[middle]
    f = state.f[middle]
    before = state.f[first]
    shift = after - before
    pull = state.pull[middle]
    drag = state.drag[middle]
    state.open[0] = state.open[0] + 1.0
    state.open[1] = state.open[1] + f
    state.open[2] = state.open[2] + f * f
    state.open[3] = state.open[3] + pull * f
    state.open[4] = state.open[4] + shift * shift
    state.open[5] = state.open[5] + pull * pull
    state.open[6] = state.open[6] + drag * f
    state.open[7] = state.open[7] + drag * drag
    sums.part[at + MEAN] = sums.part[at + MEAN] + e
    sums.part[at + SHIFT] = sums.part[at + SHIFT] + e * shift
    sums.part[at + PULL] = sums.part[at + PULL] + e * pull - params.common
    sums.part[at + SCALE] = sums.part[at + SCALE] + e * f
    sums.part[at + DRAG] = sums.part[at + DRAG] + e * drag


def fold(params: Any, state: Any, sums: Any, at: int) -> None:
    """Fade what the tests remember and add the open block's sums, those from ``at`` on."""
    m = params.memory
    for i in range(PROBES):
        state.probe[i] = m * state.probe[i] + sums.part[at + i]
    state.weight = m * state.weight + state.open[0]
    state.torque = m * state.torque + state.open[1]
    state.torque2 = m * state.torque2 + state.open[2]
    state.cross = m * state.cross + state.open[3]
    state.probe2[SHIFT] = m * state.probe2[SHIFT] + state.open[4]
    state.probe2[PULL] = m * state.probe2[PULL] + state.open[5]
    state.drag_cross = m * state.drag_cross + state.open[6]
    state.probe2[DRAG] = m * state.probe2[DRAG] + state.open[7]
    for i in range(MOMENTS):
        state.open[i] = 0.0


def weigh(state: Any, sums: Any, at: int) -> None:
    """Renew what share of the stiffness each probe hints at, and how sure that is."""
    # A torque that hardly varies beside its mean still has the mean to tell gains apart by.
    n = state.weight
    power = state.torque2 - state.torque * state.torque / (n + 1e-300)
    floor = 1e-12 * state.torque2 + 1e-300
    if power < floor:
        power = floor
    for i in range(PROBES):
        total = state.probe[i]
        spread = blocks.worst_term(sums, at + i)
        state.doubt[i] = 0.0
        if spread > 0.0:
            state.doubt[i] = math.fabs(total) / math.sqrt(spread)
    state.share[MEAN] = _ratio(state.probe[MEAN] * state.probe[MEAN], (n + 1e-300) * power)
    shift2 = state.probe[SHIFT] * state.probe[SHIFT]
    state.share[SHIFT] = _ratio(shift2, state.probe2[SHIFT] * power)
    # What inertia the residual asks for, times what a unit of it would do to the stiffness.
    pull2 = state.probe2[PULL] - state.cross * state.cross / (state.torque2 + 1e-300)
    state.share[PULL] = _ratio(math.fabs(state.probe[PULL] * state.cross), pull2 * power)
    drag2 = state.probe2[DRAG] - state.drag_cross * state.drag_cross / (state.torque2 + 1e-300)
    state.share[DRAG] = _ratio(math.fabs(state.probe[DRAG] * state.drag_cross), drag2 * power)
    state.share[SCALE] = _ratio(math.fabs(state.probe[SCALE]), power)


def _ratio(top: float, bottom: float) -> float:
    if bottom > 0.0:
        return top / bottom
    return 0.0


def verdict_bits(params: Any, state: Any, relative: float) -> None:
    """Set or clear ``wrong`` with hysteresis, ``relative`` being the interval over the stiffness.

    A probe speaks when the error it hints at exceeds both the tolerated one and the interval,
    beyond chance, three evaluations in a row; it falls silent at half of that.
    """
    limit = params.bias
    if relative > limit:
        limit = relative
    state.wrong = _one(params, state, MEAN, OFFSET, limit)
    state.wrong = _one(params, state, SHIFT, LAG, limit)
    state.wrong = _one(params, state, PULL, INERTIA, limit)
    state.wrong = _one(params, state, SCALE, DRIFT, limit)
    state.wrong = _one(params, state, DRAG, VELOCITY, limit)


def _one(params: Any, state: Any, i: int, bit: int, limit: float) -> int:
    wrong: int = state.wrong
    if params.mute[i] != 0:
        return wrong
    if state.share[i] > limit and state.doubt[i] > CONFIDENT:
        state.streak[i] = state.streak[i] + 1
    else:
        state.streak[i] = 0
    if state.streak[i] >= STREAK:
        return wrong | bit
    if wrong & bit != 0 and (state.share[i] < 0.5 * limit or state.doubt[i] < 0.6 * CONFIDENT):
        return wrong - bit
    return wrong
