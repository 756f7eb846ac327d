"""Kernels that break one clause of the contract each."""

from __future__ import annotations

import math
from typing import Any


def init(params: Any, state: Any) -> None:
    """Start at nothing."""
    state.x = 0.0
    state.n = 0


def good(params: Any, state: Any, u: Any, out: Any) -> None:
    """Filter what is finite and not absurd."""
    out.status = 1
    if u.x - u.x == 0.0:
        state.x = state.x + params.a * (u.x - state.x)
        state.n = state.n + 1
        out.status = 0
    out.x = state.x


def with_power(params: Any, state: Any, u: Any, out: Any) -> None:
    """Leave the subset."""
    out.x = u.x**3


def with_list(params: Any, state: Any, u: Any, out: Any) -> None:
    """Allocate."""
    memory = [u.x]
    memory.append(state.x)
    out.x = memory[0] + memory[1]


def undocumented(params: Any, state: Any, u: Any, out: Any) -> None:
    out.x = u.x


def sticking(params: Any, state: Any, u: Any, out: Any) -> None:
    """Let a NaN into the state."""
    state.x = state.x + params.a * (u.x - state.x)
    out.x = state.x


def silent(params: Any, state: Any, u: Any, out: Any) -> None:
    """Hold on a bad sample and not say so."""
    if u.x - u.x == 0.0:
        state.x = u.x
    out.x = state.x
    out.status = 0


def raising(params: Any, state: Any, u: Any, out: Any) -> None:
    """Overflow where Python raises and C does not."""
    state.x = 0.0
    out.x = 0.0
    if u.x - u.x == 0.0:
        out.x = math.exp(u.x * u.x)


def writing(params: Any, state: Any, u: Any, out: Any) -> None:
    """Change the input."""
    u.x = 0.5 * u.x
    out.x = u.x


def partial(params: Any, state: Any, u: Any, out: Any) -> None:
    """Leave a field of the output as it was."""
    out.x = state.x
    if out.x > 0.0:
        out.status = 1


def growing(params: Any, state: Any, u: Any, out: Any) -> None:
    """Wind up."""
    state.x = 1.001 * state.x + 1.0
    out.x = state.x


def unscaled(params: Any, state: Any, u: Any, out: Any) -> None:
    """Compare with a number that has a unit."""
    out.x = u.x
    if math.fabs(u.x) > 1.0:
        out.x = 0.0
