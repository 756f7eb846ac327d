"""What becomes of a sample: a table of streams with the steps taken and the bits set."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.kernels import guard
from rotatum.kernels.guard import PATIENCE
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
from tests.kernels.make import record

T = 1e-3


class Watch:
    """A guard with what it handed on: (time, fresh, channels) per step."""

    def __init__(self, channels=2, *, missing=8, jump=0.0, wrap=0.0, limit=0.0):
        limits = {"jump": jump, "wrap": wrap, "limit": limit}
        self.params = record(
            guard.GuardParams, {"c": channels}, period=T, missing=missing, **limits
        )
        self.state = record(guard.GuardState, {"c": channels})
        guard.init(self.params, self.state)
        self.seen: list[tuple[float, int, list[float]]] = []

    def feed(self, time, *now):
        """One sample: steps taken and status."""
        self.state.now[:] = now
        with np.errstate(all="ignore"):  # inf - inf, as compiled code
            steps = guard.plan(self.params, self.state, time)
            for k in range(steps):
                guard.fill(self.params, self.state, time, k, steps)
                fresh = int(self.state.fresh) if k == 0 else 0
                self.seen.append((float(self.state.mix_time), fresh, self.state.mix.tolist()))
            if steps:
                guard.finish(self.params, self.state, time)
        return steps, int(self.state.status)

    def started(self):
        """Two good samples at 0 and T."""
        assert self.feed(0.0, 1.0, -1.0) == (1, RESTARTED)
        assert self.feed(T, 2.0, -2.0) == (1, 0)
        self.seen.clear()
        return self


def test_good_samples_go_through_as_they_are():
    w = Watch()
    for k in range(5):
        w.feed(k * T, 0.1 * k, 3.0)
    assert w.seen == [(k * T, int(k == 0), [0.1 * k, 3.0]) for k in range(5)]
    assert w.state.accepted == 5


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", ["time", "first", "second"])
def test_not_finite_is_refused(value, where):
    w = Watch().started()
    sample = {"time": 2 * T, "first": 3.0, "second": -3.0} | {where: value}
    assert w.feed(*sample.values()) == (0, NOT_FINITE)
    assert w.seen == []
    assert w.state.not_finite == 1
    # The next good one is two periods on: the lost one is put on the line between.
    assert w.feed(3 * T, 4.0, -4.0) == (2, BRIDGED)
    assert [c for _, _, c in w.seen] == [[3.0, -3.0], [4.0, -4.0]]
    assert w.state.restarts == 0


@pytest.mark.parametrize("value", [1e13, -1e160, 1.7e308])
def test_what_no_sensor_measures_is_refused(value):
    # Its square, or its fifth power in a basis, would be infinite and stay so.
    assert Watch().started().feed(2 * T, 3.0, value) == (0, NOT_FINITE)


def test_refused_before_the_first_good_one():
    w = Watch()
    assert w.feed(0.0, math.nan, 0.0) == (0, NOT_FINITE)
    assert w.feed(T, 1.0, 1.0) == (1, RESTARTED)
    assert w.seen == [(T, 1, [1.0, 1.0])]


@pytest.mark.parametrize("early", [0.0, 0.3, -0.4])
def test_repeated_or_early_is_refused(early):
    w = Watch().started()
    assert w.feed(T + early * T, 5.0, 5.0) == (0, REPEATED)
    assert w.feed(2 * T, 3.0, -3.0) == (1, 0)
    assert (w.state.repeated, w.state.restarts) == (1, 0)


def test_a_sample_from_the_past_is_refused():
    w = Watch().started()
    assert w.feed(-5 * T, 9.0, 9.0) == (0, BACKWARDS)
    assert w.feed(2 * T, 3.0, -3.0) == (1, 0)
    assert (w.state.backwards, w.state.restarts) == (1, 0)


def test_a_clock_set_back_is_believed_after_a_while():
    w = Watch().started()
    for k in range(PATIENCE):
        assert w.feed(-10.0 + k * T, 5.0, 5.0) == (0, BACKWARDS)
    assert w.feed(-10.0 + PATIENCE * T, 6.0, 6.0) == (1, RESTARTED)
    assert w.feed(-10.0 + (PATIENCE + 1) * T, 7.0, 7.0) == (1, 0)
    assert (w.state.backwards, w.state.restarts) == (PATIENCE, 1)


def test_late_ones_now_and_then_do_not_set_the_clock_back():
    w = Watch().started()
    for k in range(2, 3 * PATIENCE):
        w.feed(k * T, 2.0, -2.0)
        assert w.feed((k - 5) * T, 9.0, 9.0) == (0, BACKWARDS)
    assert w.state.restarts == 0


@pytest.mark.parametrize("lost", range(1, 9))
def test_missing_samples_are_bridged_by_straight_lines(lost):
    w = Watch().started()
    end = (2 + lost) * T
    assert w.feed(end, 2.0 + (lost + 1), -2.0 - 2.0 * (lost + 1)) == (lost + 1, BRIDGED)
    line = np.array([c for _, _, c in w.seen])
    k = np.arange(1, lost + 2)
    # Rounding of a few sums of order 10.
    np.testing.assert_allclose(line, np.stack([2.0 + k, -2.0 - 2.0 * k], axis=1), atol=1e-14)
    times = [t for t, _, _ in w.seen]
    np.testing.assert_allclose(times, T + k * T, atol=1e-15)
    assert w.state.bridged == lost
    assert not any(fresh for _, fresh, _ in w.seen)


def test_a_longer_gap_restarts():
    w = Watch().started()
    assert w.feed(11 * T, 2.5, -2.5) == (1, GAP | RESTARTED)
    assert w.seen == [(11 * T, 1, [2.5, -2.5])]
    assert w.feed(12 * T, 2.5, -2.5) == (1, 0)
    assert w.state.restarts == 1


@pytest.mark.parametrize("periods", [9.49, 9.5, 9.51, 10.0])
def test_never_bridges_more_than_it_may(periods):
    # On a power of two the quotient of times is exact.
    w = Watch(1, missing=8)
    w.params.period = 2.0**-10
    w.feed(0.0, 0.0)
    steps, _ = w.feed(periods * 2.0**-10, 1.0)
    assert w.state.bridged <= 8
    assert steps in (1, 9)


def test_a_gap_of_zero_allowed_restarts_at_once():
    w = Watch(missing=0).started()
    assert w.feed(3 * T, 3.0, -3.0) == (1, GAP | RESTARTED)


def test_a_jump_restarts_where_it_lands():
    w = Watch(jump=[2.0, 0.0]).started()
    assert w.feed(2 * T, 2.0, 1e9) == (1, 0)  # the second channel may do as it likes
    assert w.feed(3 * T, 4.5, 1e9) == (1, JUMP | RESTARTED)
    assert w.seen[-1] == (3 * T, 1, [4.5, 1e9])
    assert w.feed(4 * T, 4.6, 1e9) == (1, 0)


def test_the_allowed_jump_grows_with_the_samples_missing():
    assert Watch(jump=[1.0, 0.0]).started().feed(4 * T, 4.9, -2.0) == (3, BRIDGED)
    assert Watch(jump=[1.0, 0.0]).started().feed(4 * T, 5.1, -2.0) == (1, JUMP | RESTARTED)


@pytest.mark.parametrize("speed", [-3.0, 0.4, 3.0])
def test_a_wrapping_channel_is_unwrapped_both_ways_over_many_turns(speed):
    turn = 2.0 * math.pi
    w = Watch(1, wrap=turn, jump=3.1)
    true = speed * np.arange(40)
    for k, angle in enumerate(true):
        w.feed(k * T, math.fmod(angle, turn))
    seen = np.array([c[0] for _, _, c in w.seen])
    # Rounding of up to 20 turns added and taken away.
    np.testing.assert_allclose(seen, true - true[0], atol=1e-12)
    assert w.state.restarts == 0


def test_a_jump_of_several_turns_at_once_is_unwrapped():
    w = Watch(1, wrap=1.0)
    for k, angle in enumerate([0.2, 5.3, -7.6]):
        w.feed(k * T, angle)
    np.testing.assert_allclose([c[0] for _, _, c in w.seen], [0.2, 0.3, 0.4], atol=1e-12)


def test_turns_are_not_lost_in_a_gap():
    # q wraps and theta does not: their difference, less the zero read at the start, must survive.
    w = Watch(wrap=[1.0, 0.0])
    for k in range(30):
        w.feed(k * T, math.fmod(0.1 * k, 1.0), 0.1 * k)
    w.feed(60 * T, math.fmod(2.95, 1.0), 2.95)
    assert w.state.status == GAP | RESTARTED
    q, theta = w.seen[-1][2]
    assert q - theta == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("value", [5.0, -5.0, 7.0])
def test_a_saturated_channel_is_refused_and_the_filters_restart_after_it(value):
    w = Watch(limit=[0.0, 5.0]).started()
    assert w.feed(2 * T, 3.0, value) == (0, SATURATED)
    assert w.feed(3 * T, 3.0, value) == (0, SATURATED)
    _, status = w.feed(4 * T, 3.0, -3.0)
    assert status & RESTARTED
    assert w.seen[0][1] == 1
    assert (w.state.saturated, w.state.restarts) == (2, 1)


def test_a_restart_after_saturation_makes_nothing_up():
    # Between the saturated samples nothing is known, so there is nothing to fill in: a joint that
    # stood still for the missing samples and then ran on would be pure invention.
    w = Watch(limit=[0.0, 5.0]).started()
    w.feed(2 * T, 3.0, 5.0)
    assert w.feed(3 * T, 4.0, -3.0) == (1, RESTARTED)
    assert w.seen == [(3 * T, 1, [4.0, -3.0])]
    assert w.state.bridged == 0


@pytest.mark.parametrize("jitter", [0.05, 0.2, 0.45])
def test_a_jittering_clock_loses_nothing_while_no_step_is_half_a_period_off(jitter):
    rng = np.random.default_rng(50)
    w = Watch(1)
    times = (np.arange(500) + 0.5 * jitter * rng.uniform(-1.0, 1.0, 500)) * T
    for t in times:
        w.feed(t, t)
    assert w.state.accepted == 500
    assert w.state.bridged == w.state.repeated == w.state.restarts == 0


def test_a_clock_far_from_zero_is_as_good():
    w = Watch(1)
    for k in range(1000):  # an ulp at 1.7e9 s is 2.4e-7: a quarter of a thousandth of the period
        assert w.feed(1.7e9 + k * T, 0.0)[0] == 1
    assert w.state.accepted == 1000
