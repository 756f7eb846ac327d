"""First- and second-order low-pass against scipy and its own definition."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from rotatum.kernels import lowpass
from tests.kernels.make import record


def run(x, *, pole, order):
    params = record(lowpass.LowpassParams, pole=pole, order=order)
    state, u, out = (
        record(kind) for kind in (lowpass.LowpassState, lowpass.Sample, lowpass.Sample)
    )
    lowpass.init(params, state)
    y = np.empty(len(x))
    for k, value in enumerate(x):
        u.x = value
        with np.errstate(invalid="ignore"):  # inf - inf, as compiled code
            lowpass.step(params, state, u, out)
        y[k] = out.x
    return y, state


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("w", [3.0, 300.0, 3000.0])
def test_is_the_recursive_filter_with_its_poles_at_the_matched_place(order, w):
    x = np.random.default_rng(1).standard_normal(500)
    T = 1e-3
    pole = math.exp(-w * T)
    expected = x
    for _ in range(order):
        expected, _ = signal.lfilter([1.0 - pole], [1.0, -pole], expected, zi=[x[0] * pole])
    y, _ = run(x, pole=pole, order=order)
    # Rounding of numbers of order 1, remembered over 1 / (1 - pole) = 330 samples at w = 3.
    np.testing.assert_allclose(y, expected, rtol=0.0, atol=1e-13)


def test_pole_is_that_of_the_continuous_filter():
    # A step through 1/(1 + s/w) reaches 1 - exp(-1) after 1/w; matched poles are exact for a step
    # that is there from the first sample on: y(k) = 1 - a^(k+1).
    w, T = 50.0, 1e-3
    x = np.ones(21)
    x[0] = 0.0
    y, _ = run(x, pole=math.exp(-w * T), order=1)
    assert y[20] == pytest.approx(1.0 - math.exp(-1.0), abs=1e-14)


@pytest.mark.parametrize("order", [1, 2])
def test_starts_in_the_steady_state(order):
    y, state = run(np.full(10, 7.25), pole=0.9, order=order)
    assert y.tolist() == [7.25] * 10
    assert state.count == 10


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("order", [1, 2])
def test_a_sample_that_is_not_finite_leaves_the_state_and_holds_the_output(bad, order):
    x = np.array([1.0, 2.0, bad, bad, 3.0])
    y, state = run(x, pole=0.8, order=order)
    clean, other = run(x[np.isfinite(x)], pole=0.8, order=order)
    assert y[2] == y[1] == y[3]
    assert y[4] == clean[2]
    assert state == other


def test_a_first_sample_that_is_not_finite_is_no_start():
    y, state = run(np.array([math.nan, 5.0, 5.0]), pole=0.8, order=1)
    assert y.tolist() == [0.0, 5.0, 5.0]
    assert state.count == 2


def test_a_true_zero_does_not_start_it_anew():
    # "Not started" is a count, never a value that happens to be zero.
    y, _ = run(np.array([0.0, 1.0]), pole=0.5, order=1)
    assert y[1] == 0.5
