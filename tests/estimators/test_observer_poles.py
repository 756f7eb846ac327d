"""Poles, gains and discretisation of the observer of deluca2007, and what a design foretells."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotatum.errors import MethodError
from rotatum.estimators.full_state.design import (
    OUTPUTS,
    Design,
    Noise,
    figures,
    link_error,
    quietest,
    recursion_of,
)
from rotatum.estimators.full_state.drivetrain import Drivetrain
from rotatum.estimators.full_state.poles import (
    DEFAULT,
    Pair,
    check_poles,
    coefficients,
    discretise,
    error_matrix,
    gains,
    injection,
)
from tests.kernels.observing import Observer, to_w

T = 1e-3
AXIS = Drivetrain(inertia=14.33, stiffness=474e3, damping=55.0, motor_damping=9.0)
PAIRS = (Pair(250.0, 0.8), Pair(180.0, 0.6))
NOISE = Noise(resolution=2e-5, torque=2.0, acceleration=0.1)
pairs_of_poles = st.tuples(
    *[st.builds(Pair, st.floats(1.0, 600.0), st.floats(0.05, 1.5)) for _ in range(2)]
)


def discrete_pair(pair, period):
    """z^2, z^1 and z^0 of the polynomial with the roots exp(lambda T) of a pair."""
    w, z = pair.frequency * period, pair.damping
    apart = w * math.sqrt(abs(1.0 - z * z))
    turn = math.cos(apart) if z < 1.0 else math.cosh(apart)
    return [1.0, -2.0 * math.exp(-z * w) * turn, math.exp(-2.0 * z * w)]


def characteristic(matrix):
    """Coefficients of det(z I - M) in exact arithmetic (Faddeev and LeVerrier)."""
    M = [[Fraction(float(v)) for v in row] for row in matrix]
    n = len(M)
    found, N = [Fraction(1)], [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(1, n + 1):
        MN = [[sum(M[i][m] * N[m][j] for m in range(n)) for j in range(n)] for i in range(n)]
        found.append(-sum(MN[i][i] for i in range(n)) / k)
        N = [[MN[i][j] + found[-1] * (i == j) for j in range(n)] for i in range(n)]
    return np.array([float(v) for v in found])


@settings(max_examples=15, deadline=None)
@given(pairs_of_poles, st.floats(0.0, 500.0))
def test_the_discrete_observer_has_the_poles_asked_for(pairs, gyro):
    found = characteristic(discretise(pairs, T, gyro).transition)
    expected = np.polymul(*[discrete_pair(pair, T) for pair in pairs])
    np.testing.assert_allclose(found, expected, rtol=1e-12)  # as promised; 1e-14 is seen


@settings(max_examples=15, deadline=None)
@given(pairs_of_poles, st.floats(0.1, 100.0), st.floats(0.0, 1e4), st.floats(0.0, 1e3))
def test_the_gains_of_remark_3_place_them(pairs, inertia, damping, friction):
    joint = Drivetrain(inertia, 1e5, damping, friction)
    k, d, c = 1e5 / inertia, damping / inertia, friction / inertia
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-k, k, -d - c, d], [0, 0, 0, 0]], dtype=float)
    A[:, 0] -= gains(pairs, joint)
    found, expected = characteristic(A)[1:], coefficients(pairs)
    # Differences of terms like c^4 leave a3 .. a0: rounding of them is what is allowed.
    size = 1.0 + d + c + math.sqrt(k) + max(p.frequency for p in pairs)
    terms = size ** np.arange(1, 5) * (1.0 + d / math.sqrt(k)) ** 2
    assert np.all(np.abs(found - expected) <= 1e-12 * terms)


def test_the_gains_are_the_injection_in_the_paper_s_coordinates():
    W = to_w(Design(AXIS, T, PAIRS))
    k, c = AXIS.stiffness / AXIS.inertia, (AXIS.damping + AXIS.motor_damping) / AXIS.inertia
    L = np.linalg.solve(W, injection(PAIRS) - [c, k, 0.0, 0.0])
    np.testing.assert_allclose(gains(PAIRS, AXIS), L, rtol=1e-12)


def test_a_gyroscope_leaves_the_poles_where_they_are():
    found = characteristic(error_matrix(PAIRS, 130.0))[1:]
    np.testing.assert_allclose(found, coefficients(PAIRS), rtol=1e-13)


def test_the_holds_are_exact_for_straight_lines():
    # w' = A w + b0 + b1 t in closed form: the particular solution -A^-1 (b + A^-1 b').
    A, (E, before, after) = error_matrix(PAIRS), discretise(PAIRS, T)
    b0, b1 = np.array([1.0, 200.0, 3e4, 5e6]), np.array([30.0, -1e4, 5e6, 1e8])
    slope = np.linalg.solve(A, b1)

    def particular(t):
        return -np.linalg.solve(A, b0 + b1 * t + slope)

    start = np.array([0.1, 50.0, 4e3, 6e5])
    expected = E @ (start - particular(0.0)) + particular(T)
    found = E @ start + before @ b0 + after @ (b0 + b1 * T)
    np.testing.assert_allclose(found, expected, rtol=1e-10)  # A^-2 loses 1 / (w T)^2 = 20 and more


@pytest.mark.parametrize(
    ("pairs", "period", "words"),
    [
        ((Pair(250.0, 0.0), Pair()), T, ("first pair", "not stable", "0.7 to 1")),
        ((Pair(), Pair(250.0, -0.5)), T, ("second pair", "not stable")),
        ((Pair(-3.0, 0.8), Pair()), T, ("frequency must be positive",)),
        ((Pair(4000.0, 0.8), Pair()), T, ("too fast", "3141.59")),
        ((Pair(250.0, 7.0), Pair()), T, ("too fast", "damping")),
        ((Pair(math.nan, 0.8), Pair()), T, ("frequency must be positive",)),
        ((Pair(),), T, ("two pairs",)),
        (DEFAULT, 0.0, ("period",)),
    ],
)
def test_poles_that_cannot_be_are_refused(pairs, period, words):
    with pytest.raises(MethodError) as error:
        check_poles(pairs, period)
    assert all(word in str(error.value) for word in words)


@pytest.mark.parametrize("name", ["inertia", "stiffness", "damping", "coulomb"])
def test_constants_that_cannot_be_are_refused(name):
    for value in (-1.0, math.nan) + ((0.0,) if name in ("inertia", "stiffness") else ()):
        with pytest.raises(MethodError, match=name):
            recursion_of(Design(AXIS._replace(**{name: value}), T))


def test_what_constant_errors_leave_is_known_in_closed_form():
    a3, a2, a1, a0 = coefficients(PAIRS)
    B, K, D, C, _ = AXIS
    k, d, c = K / B, D / B, (D + C) / B
    found = figures(Design(AXIS, T, PAIRS), NOISE)
    dq = a1 / a0 - d / k
    theta, q = k / a0, a2 / a0 - d / k * dq
    expected = [theta, q, (a3 - c) * k / a0, dq, q - theta, K * (q - theta)]
    np.testing.assert_allclose(found.acceleration_error, expected, rtol=1e-9)  # rounding / (w T)^2
    expected = np.array([0.0, -1.0 / K, 0.0, 0.0, -1.0 / K, -1.0])
    np.testing.assert_allclose(found.torque_error, expected, rtol=1e-9, atol=1e-15)
    # A stiffness told 10 % too large, 300 N m on the spring: it is deflected by that much less.
    wrong = figures(Design(AXIS._replace(stiffness=1.1 * K), T, PAIRS), NOISE)
    error = dict(zip(OUTPUTS, wrong.stiffness_error(0.1, 300.0), strict=True))
    assert error["q_hat"] == pytest.approx(300.0 / (1.1 * K) - 300.0 / K, rel=1e-9)
    assert abs(error["torque"]) < 1e-9 * 300.0
    assert np.all(found.torque_peak >= np.abs(found.torque_error))


def test_the_bandwidth_is_where_the_motor_s_share_of_the_link_falls():
    undamped = AXIS._replace(damping=0.0)
    found = figures(Design(undamped, T, PAIRS), NOISE).bandwidth
    s = 1j * found
    a3, a2, a1, a0 = coefficients(PAIRS)
    share = abs((a1 * s + a0) / (s**4 + a3 * s**3 + a2 * s**2 + a1 * s + a0))
    # Straight lines between samples are (w T)^2 / 12 = 1 % off a sine at 350 rad/s.
    assert share == pytest.approx(math.sqrt(0.5), rel=0.02)


@pytest.mark.parametrize("frequency", [250.0, None])
def test_deviations_are_those_of_many_samples(frequency):
    n, design, rng = 12_000, Design(AXIS, T, held=True), np.random.default_rng(410)
    design = quietest(design, NOISE, count=12) if frequency is None else design.at(frequency)
    expected = figures(design, NOISE)
    observer = Observer(design)
    noise = (
        rng.uniform(-0.5, 0.5, n) * NOISE.resolution,
        *(s * rng.standard_normal(n) for s in (NOISE.torque, NOISE.acceleration)),
    )
    samples = zip(*(v.tolist() for v in noise), strict=True)
    found = np.array([observer.push(theta=a, torque=b, acceleration=c) for a, b, c in samples])
    deviation = found[expected.settle :].std(axis=0)
    # Errors are alike over some 1 / (0.8 * 250 rad/s) = 5 samples: 12000 / 15 are independent, so
    # that one deviation is off by 2.5 %; four standard errors. Faster poles leave more of them.
    np.testing.assert_allclose(deviation, expected.deviation[:4], rtol=0.1)


def test_the_quietest_frequency_is_the_least_of_the_grid_and_weighs_the_bias():
    design = Design(AXIS, T, PAIRS, held=True)
    quiet = quietest(design, NOISE, 30.0, 900.0, count=40)
    biased = quietest(design, NOISE._replace(acceleration_bias=0.2), 30.0, 900.0, count=40)
    w = quiet.pairs[0].frequency
    assert 30.0 < w < biased.pairs[0].frequency < 900.0  # a bias asks for faster poles
    assert quiet.pairs[1].frequency / w == pytest.approx(180.0 / 250.0, rel=1e-12)
    least = link_error(quiet, NOISE)
    for factor in (0.8, 0.95, 1.05, 1.25):
        assert link_error(design.at(factor * w), NOISE) > least * (1.0 - 1e-3)  # flat at its least
    with pytest.raises(MethodError, match="without noise"):
        quietest(design, Noise())
    with pytest.raises(MethodError, match="in order"):
        quietest(design, NOISE, 500.0, 100.0)
