"""The gate of selective updates: hysteresis, the wait after a standstill, and what it says."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.estimators.gains import steady_gains
from rotatum.kernels import gate
from rotatum.kernels.status import HELD, SETTLING, STILL
from tests import naive
from tests.kernels.make import plain

T = 1e-3
LOW, HIGH = 0.05, 0.1
Y, R = 3.25, [1.5, -2.5]


def made(span: int = 3, hold: int = 8, late: int = 0, bandwidth: float = 800.0) -> tuple[Any, Any]:
    """Parameters and a memory that has seen nothing."""
    P = gate.GateParams.layout().zeros(1)[0]
    P["low"], P["high"], P["span"], P["late"], P["hold"] = LOW, HIGH, span, late, hold
    P["velocity"]["period"] = T
    gains = steady_gains(bandwidth, T)
    P["velocity"]["position_gain"], P["velocity"]["velocity_gain"] = gains
    params, state = plain(P), plain(gate.GateState.layout().zeros(1)[0])
    gate.init(params, state)
    return params, state


def row(valid: int = 1, status: int = 0) -> Any:
    return SimpleNamespace(valid=valid, status=status, fresh=0, y=Y, R=list(R))


def passed(params: Any, state: Any, q: Any, fresh: tuple[int, ...] = ()) -> tuple[Any, Any]:
    """Rows behind the gate, and the speeds it has seen."""
    rows, speeds = [], []
    for k, angle in enumerate(q):
        one = row()
        gate.step(params, state, float(angle), int(k in fresh), one)
        rows.append(one)
        speeds.append(abs(state.velocity.velocity))
    return rows, np.array(speeds)


def held(rows: Any) -> list[bool]:
    return [bool(one.status & HELD) for one in rows]


def there_and_back(speed: float, samples: int) -> Any:
    """Positions of a link that moves, stops, and moves back."""
    v = np.concatenate([np.full(samples, speed), np.zeros(samples), np.full(samples, -speed)])
    return T * np.cumsum(v)


def test_it_closes_low_opens_high_and_waits_for_the_rows_to_forget() -> None:
    params, state = made()
    rows, speeds = passed(params, state, there_and_back(1.0, 40))
    shut, still = naive.gated(speeds, LOW, HIGH, 3, 8)
    assert held(rows) == shut
    assert [bool(one.status & STILL) for one in rows] == still
    # Closed at the start and in the middle, open in between, and then long enough to be still.
    assert [shut[k] for k in (0, 39, 79, 119)] == [True, False, True, False]
    assert [still[k] for k in (39, 79, 119)] == [False, True, False]
    opened = shut.index(False)
    assert speeds[opened - 2] > HIGH >= speeds[opened - 3]


def test_between_the_thresholds_it_stays_as_it_was() -> None:
    between = 0.5 * (LOW + HIGH)
    for first, expected in ((0.0, True), (1.2 * HIGH, False)):
        params, state = made()
        v = np.concatenate([np.full(60, first), np.full(200, between)])
        rows, speeds = passed(params, state, T * np.cumsum(v))
        assert LOW < speeds[-1] < HIGH
        # The velocity overshoots by less than the hysteresis is wide, from above and from below.
        assert speeds[60:].min() > LOW or first == 0.0
        assert speeds[60:].max() < HIGH or first > HIGH
        assert held(rows)[-1] is expected


def test_a_restart_closes_it() -> None:
    params, state = made()
    q = T * np.arange(100.0)
    shut = held(passed(params, state, q, fresh=(50,))[0])
    assert shut[49] is False
    assert shut[50] is True
    fresh = held(passed(*made(), q[50:])[0])
    assert shut[50:] == fresh


def test_what_lies_back_counts_for_as_long_after_it_has_closed() -> None:
    q = there_and_back(1.0, 40)
    at_once, later = (held(passed(*made(span=12, late=late), q)[0]) for late in (0, 5))
    shuts = at_once.index(True, 39)
    assert later[:shuts] == at_once[:shuts]
    assert later[shuts : shuts + 6] == [False] * 5 + [True]
    assert later[shuts + 6 :] == at_once[shuts + 6 :]
    # Not of what was too short to fill a row.
    assert held(passed(*made(span=60, late=5), q)[0]) == [True] * 120


def test_a_span_of_none_passes_at_once() -> None:
    params, state = made(span=0)
    rows, _ = passed(params, state, there_and_back(1.0, 40))
    assert held(rows) == [False] * 120, "with nothing to forget only the sign of being open counts"


@given(
    speeds=st.lists(st.sampled_from([-0.3, -0.11, -0.07, 0.0, 0.04, 0.08, 0.2]), max_size=60),
    repeats=st.integers(1, 12),
    span=st.integers(1, 6),
    late=st.integers(0, 5),
    hold=st.integers(1, 30),
)
def test_nothing_is_learnt_of_a_standstill_and_nothing_else_is_changed(
    speeds: list[float], repeats: int, span: int, late: int, hold: int
) -> None:
    late = min(late, span - 1)
    params, state = made(span, hold, late)
    q = T * np.cumsum(np.repeat(np.array(speeds, dtype=float), repeats))
    rows, seen = passed(params, state, q)
    shut, still = naive.gated(seen, LOW, HIGH, span, hold, late)
    for k, (one, closed, rests) in enumerate(zip(rows, shut, still, strict=True)):
        assert one.valid == 0 or (seen[k + 1 - span : k + 1 - late] >= LOW).all()
        assert one.valid == int(not closed)
        assert one.status == HELD * closed + STILL * rests
        assert (one.y, one.R, one.fresh) == (Y, R, 0)


@pytest.mark.parametrize("speed", [0.0, 1.0])
def test_a_row_that_was_not_to_be_learnt_from_stays_so(speed: float) -> None:
    params, state = made()
    for k in range(50):
        one = row(valid=0, status=SETTLING)
        gate.step(params, state, speed * T * k, 0, one)
    assert one.valid == 0
    assert one.status == (SETTLING if speed > 0.0 else SETTLING | HELD | STILL)
