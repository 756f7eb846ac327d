"""Two tiny stages whose arithmetic can be done in the head."""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, number
from rotatum.runtime.stage import Stage


class Gain(Record):
    """Constants."""

    gain = number("what is multiplied")
    start = number("where the sum starts")


class Total(Record):
    """Memory."""

    total = number("sum so far")
    count = integer("samples")


class Signal(Record):
    """One number."""

    x = number("signal")


class Both(Record):
    """Two numbers."""

    x = number("one")
    y = number("other")


def total_init(params: Any, state: Any) -> None:
    """Start where the params say, which is not zero."""
    state.total = params.start


def total_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Sum what comes, times the gain."""
    state.total = state.total + params.gain * u.x
    state.count = state.count + 1
    out.x = state.total


def twice_init(params: Any, state: Any) -> None:
    """Nothing to do."""
    state.total = 0.0


def twice_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Double the first number, add the second."""
    out.x = 2.0 * u.x + u.y


TOTAL = Stage(
    "total",
    Gain.layout(),
    Total.layout(),
    Signal.layout(),
    Signal.layout(),
    total_init,
    total_step,
    ("one2000",),
)
TWICE = Stage(
    "twice",
    Gain.layout(),
    Total.layout(),
    Both.layout(),
    Signal.layout(),
    twice_init,
    twice_step,
    ("two2001", "one2000"),
)
