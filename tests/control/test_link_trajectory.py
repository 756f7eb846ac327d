"""Motions from rest to rest: how smooth, how long, and that they hold."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotatum.control.trajectory import RestToRest, blend, shortest_duration
from rotatum.errors import RotatumError

START, END = np.array([0.3, -0.2]), np.array([1.1, -0.5])
MOTION = RestToRest(START, END, begin=0.1, seconds=0.8)


def test_the_blend_of_two_derivatives_is_the_known_quintic():
    u = np.linspace(0.0, 1.0, 11)
    # rounding of numbers up to 1
    np.testing.assert_allclose(blend(2)(u - 0.5), 6 * u**5 - 15 * u**4 + 10 * u**3, atol=1e-14)


@pytest.mark.parametrize("smooth", [1, 4, 6])
def test_the_blend_stands_at_both_ends_in_all_its_derivatives_and_has_the_least_degree(smooth):
    s = blend(smooth)
    assert s.degree() == 2 * smooth + 1
    assert s(-0.5) == pytest.approx(0.0, abs=1e-14)
    assert s(0.5) == pytest.approx(1.0, abs=1e-14)
    for order in range(1, smooth + 2):
        rate = s.deriv(order)
        scale = np.max(np.abs(rate(np.linspace(-0.5, 0.5, 101))))
        ends = np.abs(rate(np.array([-0.5, 0.5]))) / scale
        # the derivative after the last continuous one jumps, else rounding
        assert np.all(ends > 0.1 if order > smooth else ends < 1e-11)


def test_the_derivatives_are_those_of_the_position():
    time = np.linspace(0.0, 1.0, 4001)
    rows = MOTION.derivatives(time)
    assert rows.shape == (7, time.size, 2)
    for lower, higher in pairwise(rows):
        # differences over 0.25 ms; the sixth has corners, where they are off by h/4 of the seventh
        miss = np.gradient(lower, time, axis=0)[2:-2] - higher[2:-2]
        assert np.max(np.abs(miss)) < 5e-3 * np.max(np.abs(higher))


def test_it_holds_before_and_after():
    rows = MOTION.derivatives(np.array([-1.0, 0.1, 0.9, 5.0]))
    np.testing.assert_allclose(rows[0], [START, START, END, END], atol=1e-15)
    assert not np.any(rows[1:])
    assert MOTION.stop == pytest.approx(0.9)


@settings(max_examples=20)
@given(st.floats(0.01, 3.0), st.lists(st.floats(0.1, 1e4), min_size=1, max_size=4), st.floats(0, 1))
def test_the_shortest_duration_reaches_one_limit_and_passes_none(distance, limits, other):
    seconds = shortest_duration([distance, -other * distance], limits)
    motion = RestToRest(np.zeros(1), np.array([distance]), 0.0, seconds)
    rows = motion.derivatives(np.linspace(0.0, seconds, 1001), len(limits))[1:, :, 0]
    used = np.max(np.abs(rows), axis=1) / limits
    # peaks are missed by at most (pi / 1000)^2 of a few turns each
    assert np.max(used) == pytest.approx(1.0, abs=1e-4)


def test_impossible_motions_are_refused():
    with pytest.raises(RotatumError, match="positive duration"):
        RestToRest(START, END, 0.0, 0.0)
    with pytest.raises(RotatumError, match="one position for each joint"):
        RestToRest(START, END[:1], 0.0, 1.0)
    with pytest.raises(RotatumError, match="limits"):
        shortest_duration([1.0], [1.0, -2.0])
