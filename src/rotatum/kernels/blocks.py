"""Sums over blocks of doubling length: how much a mean of coloured terms really varies.

Terms are added one at a time; level 0 sums ``shortest`` of them, level k twice as many as level
k - 1. Squares of block sums, averaged, grow with the block until it is longer than the terms'
memory. The largest level with enough blocks therefore says what the sum's variance is, whatever
the colour (batch means; Flyvbjerg and Petersen 1989).
"""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, matrix, vector

ENOUGH = 8.0  # blocks a level needs before it is believed


class BlockParams(Record):
    """Length of the shortest block and how fast old ones fade."""

    shortest = integer("terms in a block of level 0")
    fade = vector("L", "weight of a block's square relative to the next one's, per level")
    fade_single = vector("L", "the same for the terms after the first v, which fade sooner")


class BlockState(Record):
    """Open sums and squares of closed ones, for t terms side by side, v of them as a vector."""

    part = vector("t", "open sum of level 0")
    direction = vector("v", "direction over all terms whose products are kept, for whoever asks")
    filled = integer("terms in it")
    carry = matrix("L", "t", "sum of level k waiting for its twin")
    waiting = vector("L", "1: there is one", kind="int")
    square = matrix("L", "s", "sums of squares and products, upper triangle row by row")
    blocks = vector("L", "blocks in the sums")
    blocks_single = vector("L", "blocks in the sums of the terms after the first v")
    closed = integer("blocks of level 0 closed")


def clear(state: Any) -> None:
    """Drop open sums: what follows is not adjacent to what came before."""
    state.filled = 0
    for i in range(len(state.part)):
        state.part[i] = 0.0
    for k in range(len(state.waiting)):
        state.waiting[k] = 0


def count(params: Any, state: Any) -> int:
    """One more set of terms is in the open block; returns 1 when the block is full."""
    state.filled = state.filled + 1
    if state.filled < params.shortest:
        return 0
    return 1


def close(params: Any, state: Any) -> None:
    """Close the open block of level 0 and pass sums up; products among the first v terms."""
    k = 0
    going = 1
    while going != 0 and k < len(state.waiting):
        _square(params, state, k)
        if state.waiting[k] == 0:
            for i in range(len(state.part)):
                state.carry[k, i] = state.part[i]
            state.waiting[k] = 1
            going = 0
        else:
            for i in range(len(state.part)):
                state.part[i] = state.part[i] + state.carry[k, i]
            state.waiting[k] = 0
            k = k + 1
    for i in range(len(state.part)):
        state.part[i] = 0.0
    state.filled = 0
    state.closed = state.closed + 1


def _square(params: Any, state: Any, k: int) -> None:
    v = len(state.direction)
    fade = params.fade[k]
    state.blocks[k] = fade * state.blocks[k] + 1.0
    n = 0
    for i in range(v):
        for j in range(i, v):
            state.square[k, n] = fade * state.square[k, n] + state.part[i] * state.part[j]
            n = n + 1
    fade = params.fade_single[k]
    state.blocks_single[k] = fade * state.blocks_single[k] + 1.0
    for i in range(v, len(state.part)):
        state.square[k, n] = fade * state.square[k, n] + state.part[i] * state.part[i]
        n = n + 1


def correction(blocks: float) -> float:
    """Factor on a variance from few blocks: Student's t for the normal's, and one mean fitted.

    ``(t(97.5 %, n - 1) / 1.96)^2 n / (n - 1)``, t approximated by ``1.96 (1 + 1.42 / (n - 1))``,
    within 2 % from n = 6.
    """
    t = 1.0 + 1.42 / (blocks - 1.0)
    return t * t * blocks / (blocks - 1.0)


def variance_along(state: Any, k: int, at: int, direction: Any) -> float:
    """Sum of squares of level ``k`` along ``direction``, whose terms are those from ``at`` on."""
    v = len(state.direction)
    total = 0.0
    n = 0
    for i in range(at):
        n = n + v - i
    for i in range(len(direction)):
        others = 0.0
        for j in range(i + 1, len(direction)):
            others = others + state.square[k, n + j - i] * direction[j]
        total = total + direction[i] * (state.square[k, n] * direction[i] + 2.0 * others)
        n = n + v - at - i
    return total


def worst(state: Any, at: int, direction: Any) -> float:
    """Variance of the whole sum along ``direction``: the largest over levels with enough blocks."""
    largest = 0.0
    k = 0
    while k < len(state.blocks) and state.blocks[k] >= ENOUGH:  # no level has more than the last
        value = variance_along(state, k, at, direction) * correction(state.blocks[k])
        if value > largest:
            largest = value
        k = k + 1
    return largest


def worst_term(state: Any, i: int) -> float:
    """The same for the single term ``i``, one of those after the first v; no correction."""
    v = len(state.direction)
    n = i - v
    for row in range(v):
        n = n + v - row
    largest = 0.0
    for k in range(len(state.blocks)):
        if state.blocks_single[k] >= ENOUGH and state.square[k, n] > largest:
            largest = state.square[k, n]
    return largest
