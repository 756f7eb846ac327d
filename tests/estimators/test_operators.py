"""Operators: their weights, how late they are, and what noise they let pass."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal, special

from rotatum.estimators.operators import CENTRED, EXPONENTIAL, WINDOW, Operator
from tests import naive
from tests.kernels.driven import problem, run

T = 1e-3
POWERS = (2, 3, 4, 5)
TAPS = {0: [0.0, 1.0, 0.0], 1: [0.5, 0.0, -0.5], 2: [1.0, -2.0, 1.0]}


def window(power=3, seconds=0.1, derivative=0, period=T):
    return Operator(WINDOW, power, seconds, period, derivative)


def poles(order=2, cutoff=300.0, period=T):
    return Operator(EXPONENTIAL, order, cutoff, period)


EVERY = [
    *(poles(order, cutoff) for order in (1, 2, 3) for cutoff in (10.0, 300.0, 3000.0)),
    *(window(power, derivative=d) for power in POWERS for d in (0, 1)),
    window(seconds=0.008),
    window(seconds=1.0, derivative=1),
]


# --- weights --------------------------------------------------------------------------------------


@pytest.mark.parametrize("derivative", [0, 1])
@pytest.mark.parametrize("power", POWERS)
def test_weights_are_those_of_the_formula_point_by_point(power, derivative):
    chosen = window(power, 0.05, derivative)
    expected = naive.bump(power, 49, derivative)[::-1]
    weights = chosen.weights()
    assert len(weights) == chosen.length == 49
    # The twin multiplies u out in another order: rounding.
    np.testing.assert_allclose(weights, expected / np.abs(expected).sum(), rtol=1e-11, atol=1e-18)
    assert np.abs(weights).sum() == pytest.approx(1.0, rel=1e-14)
    # In time the window falls towards now, so that its slope is negative there.
    assert (weights[: 49 // 2] > 0.0).all() if derivative == 0 else (weights[:24] < 0.0).all()


@pytest.mark.parametrize("power", POWERS)
def test_weights_become_the_window_and_its_slope_as_samples_get_closer(power):
    u = np.polynomial.Polynomial([0.0, 1.0]) * np.polynomial.Polynomial([1.0, -1.0])
    w = u**power
    area = w.integ()(1.0)  # B(k + 1, k + 1)
    assert area == pytest.approx(special.beta(power + 1, power + 1), rel=1e-12)
    size = 2.0 * 0.25**power  # how far w rises and falls
    off = []
    for n in (400, 800):
        now = 1.0 - np.arange(1, n) / n  # newest first
        mean = n * window(power, 0.1, 0, 0.1 / n).weights() - w(now) / area
        slope = n * window(power, 0.1, 1, 0.1 / n).weights() - w.deriv()(now) / size
        off.append([np.abs(mean).max(), np.abs(slope).max()])
    # The mean of the window errs by h^4 or less: its sum has no other error than at the ends, where
    # two derivatives or more vanish. The slope's central difference is of order h^2, and largest
    # one point from the end.
    assert off[0][0] < 100.0 * 400.0**-4
    assert off[0][1] / off[1][1] == pytest.approx(4.0, rel=0.05)


# --- time -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("chosen", EVERY, ids=str)
def test_the_delay_is_the_first_moment_of_the_response_and_the_hats(chosen):
    # Of a slope, whose mean is 0, the moment of its size: it is odd about the same middle.
    response = np.abs(chosen.response())
    moment = (np.arange(len(response)) @ response) / response.sum()
    # A response is cut off where 1e-9 of it is left.
    assert chosen.delay == pytest.approx((moment + 1.0) * T, rel=1e-7)


@pytest.mark.parametrize("chosen", [poles(2), poles(3), window(2), window(5, 0.05)], ids=str)
def test_a_rising_torque_is_seen_as_it_was_a_delay_ago(chosen):
    width = {"cutoff": chosen.width, "order": chosen.order, "window": None}
    width = width if chosen.kind == EXPONENTIAL else {"window": chosen}
    stage, P = problem([1], torque="sensor", **width)
    t = T * np.arange(400)
    y = run(stage, P, 0.0 * t, 0.0 * t, 7.0 * t)["y"]
    # What the start leaves of the poles after 0.35 s is exp(-100).
    assert y[-1] == pytest.approx(7.0 * (t[-1] - chosen.delay), rel=1e-12)


def test_delays_in_closed_form():
    assert window(3, 0.2).delay == pytest.approx(0.1)
    a = math.exp(-0.3)
    assert poles(2, 300.0).delay == pytest.approx(T * (1.0 + 2.0 * a / (1.0 - a)))
    # Far below the sample rate: order / cutoff, and the hat's period less half a sample a pole.
    assert poles(3, 1.0).delay == pytest.approx(3.0 + T - 1.5 * T, rel=1e-6)


def test_a_window_is_as_wide_as_the_two_poles_that_come_as_late():
    assert poles(2, window(seconds=0.4).cutoff, 1e-6).delay == pytest.approx(0.2, rel=1e-4)
    assert poles(2, 77.0).cutoff == 77.0
    assert Operator(WINDOW, 3, 0.1, T, 0, 10).row_period == pytest.approx(0.01)


# --- noise ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("difference", [0, 1, 2])
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("cutoff", [10.0, 300.0, 3000.0])
def test_noise_gain_of_poles_is_that_of_their_impulse_response(cutoff, order, difference):
    impulse = np.zeros(round(60.0 / (cutoff * T)) + 10)
    impulse[:3] = np.array(TAPS[difference]) / T**difference
    h = impulse
    for _ in range(order):
        h = naive.lowpass(math.exp(-cutoff * T), h, 0.0)
    # Cut off where 1e-9 of a response is left.
    assert poles(order, cutoff).noise_gain(difference) == pytest.approx((h * h).sum(), rel=1e-6)


@pytest.mark.parametrize("cutoff", [30.0, 300.0])
def test_noise_gain_of_poles_in_closed_form(cutoff):
    a = math.exp(-cutoff * T)
    # h(n) = (1 - a)^2 (n + 1) a^n, and sum (n + 1)^2 x^n = (1 + x) / (1 - x)^3.
    expected = (1.0 - a) ** 4 * (1.0 + a * a) / (1.0 - a * a) ** 3
    assert poles(2, cutoff).noise_gain(0) == pytest.approx(expected, rel=1e-8)
    # One pole: (1 - a)^2 / (1 - a^2).
    assert poles(1, cutoff).noise_gain(0) == pytest.approx((1.0 - a) / (1.0 + a), rel=1e-8)


@pytest.mark.parametrize("power", POWERS)
def test_noise_gain_of_windows_in_closed_form(power):
    # int w^2 / (int w)^2 over the samples in the window.
    n = 1000
    mean = special.beta(2 * power + 1, 2 * power + 1) / special.beta(power + 1, power + 1) ** 2
    assert window(power, n * T).noise_gain(0) == pytest.approx(mean / n, rel=1e-5)
    # int w'^2 = k^2 int (u (1 - u))^(2 k - 2) (1 - 2 u)^2; (1 - 2 u)^2 = 1 - 4 u (1 - u).
    slope = power**2 * (
        special.beta(2 * power - 1, 2 * power - 1) - 4.0 * special.beta(2 * power, 2 * power)
    )
    rate = slope / special.beta(power + 1, power + 1) ** 2 / n**3 / T**2
    # The slope of a window of a thousand samples, by differences: 1e-5 of it.
    assert window(power, n * T).noise_gain(1) == pytest.approx(rate, rel=1e-4)
    size = (2.0 * 0.25**power) ** 2
    found = window(power, n * T, derivative=1).noise_gain(0)
    assert found == pytest.approx(slope / size / n, rel=1e-4)


def differenced(chosen, taps, noise):
    """White noise through a difference and the operator, by scipy."""
    through = signal.lfilter(taps, [1.0], noise)
    if chosen.kind == EXPONENTIAL:
        a = chosen.pole
        for _ in range(chosen.order):
            through = signal.lfilter([1.0 - a], [1.0, -a], through)
        return through
    return signal.lfilter(chosen.weights(), [1.0], through)


@pytest.mark.parametrize(
    "chosen", [poles(2), poles(3, 1000.0), window(2, 0.03), window(4, 0.03, 1)], ids=str
)
def test_gains_are_what_noise_does(chosen):
    noise = np.random.default_rng(230).standard_normal(400_000)
    own = {d: differenced(chosen, taps, noise)[1000:] for d, taps in TAPS.items()}
    for d, through in own.items():
        # 399,000 samples, correlated over 30 at worst: a variance is known to 1.2 %; four of them.
        assert through.var() * T ** (-2 * d) == pytest.approx(chosen.noise_gain(d), rel=0.05)
    for one, other in ((0, 2), (0, 1), (1, 2), (2, 2)):
        product = (own[one] * own[other]).mean()
        found = chosen.cross_gain(np.array(CENTRED[one]), np.array(CENTRED[other]))
        size = own[one].std() * own[other].std()
        assert product == pytest.approx(found, abs=0.05 * size)


@pytest.mark.parametrize("chosen", EVERY, ids=str)
def test_a_position_and_its_acceleration_have_their_speed_in_common(chosen):
    # By parts: sum g (g(+1) - 2 g + g(-1)) = -sum (g(+1) - g)^2.
    position, bend = np.array(CENTRED[0]), np.array(CENTRED[2])
    moved = np.diff(chosen.response(), prepend=0.0, append=0.0)
    assert chosen.cross_gain(position, bend) == pytest.approx(-(moved @ moved), rel=1e-9)
    # A difference with itself is its power, whatever it spans.
    wide = np.convolve(CENTRED[1], (-1.0, 8.0, 0.0, -8.0, 1.0)) / 12.0
    power = chosen.noise_gain(2, wide) * T**4
    assert chosen.cross_gain(wide, wide) == pytest.approx(power, rel=1e-12)


def test_says_what_it_is():
    assert str(poles(2)) == "300 rad/s, 2 poles"
    assert str(poles(1)) == "300 rad/s, 1 pole"
    slope = Operator(WINDOW, 3, 1.0, T, 1, 100)
    assert str(slope) == ("the slope of (u (1 - u))^3 over 1 s, a row every 100 ms, 500 ms late")
