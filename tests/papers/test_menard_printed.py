"""Ménard et al. 2013's observer as printed, against quadrature, an ODE solver and known springs."""

from __future__ import annotations

from dataclasses import replace
from math import factorial
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from rotatum.evaluation.metrics import msrep_percent
from rotatum.evaluation.papers.menard2013.methods import SECTION4, motion, truth_of
from rotatum.evaluation.papers.menard2013.printed import (
    Observer,
    Rows,
    coefficients_of,
    printed,
    rows_of,
    stiffness_of,
)

J, B = 2e-3, 0.4  # kg m^2, N m s/rad
SPRING = (3.0, -2.0, 60.0)  # a_0, a_1, a_2: N m/rad, per rad, per rad^2
OBSERVER = Observer(order=2, spread=1e4, window=0.8)
T_S = 1e-3


class Signals(NamedTuple):
    """Motor position, deflection, and the torque that goes with them."""

    theta: np.ndarray
    phi: np.ndarray
    tau: np.ndarray


def theta(t):
    return 1.5 + 0.8 * np.sin(3.0 * t) + 0.3 * np.cos(7.0 * t)


def phi(t):
    return 0.2 + 0.3 * np.sin(2.0 * t + 0.4) + 0.1 * np.sin(9.0 * t)


def tau(t):
    """``J q'' + b q' - f(phi)`` (eq. 12)."""
    velocity = 2.4 * np.cos(3.0 * t) - 2.1 * np.sin(7.0 * t)
    acceleration = -7.2 * np.sin(3.0 * t) - 14.7 * np.cos(7.0 * t)
    spring = sum(a * phi(t) ** (j + 1) / factorial(j + 1) for j, a in enumerate(SPRING))
    return J * acceleration + B * velocity - spring


def signals(period: float = T_S, seconds: float = 4.0) -> Signals:
    t = period * np.arange(round(seconds / period) + 1)
    return Signals(theta(t), phi(t), tau(t))


def rows(period: float = T_S) -> Rows:
    return rows_of(*signals(period), inertia=J, damping=B, observer=OBSERVER, period=period)


def integrals(now: float) -> tuple[float, np.ndarray]:
    """C and b_j of eqs 20 and 21 by adaptive quadrature."""
    T = OBSERVER.window

    def w(u, k, m):
        return (1.0 - u) ** k * u**m

    def left(u):
        s = now + T * (u - 1.0)
        G1 = w(u, 3, 0) - 9.0 * w(u, 2, 1) + 9.0 * w(u, 1, 2) - w(u, 0, 3)
        G2 = -w(u, 3, 1) + 3.0 * w(u, 2, 2) - w(u, 1, 3)
        G3 = 0.5 * w(u, 2, 3) - 0.5 * w(u, 3, 2)
        return (J * G1 + T * B * G2) * theta(s) + T**2 * G3 * tau(s)

    def right(u, j):
        slope = 3.0 * w(u, 3, 2) - 3.0 * w(u, 2, 3)
        return T**2 / 6.0 * slope * phi(now + T * (u - 1.0)) ** (j + 1) / factorial(j + 1)

    tight = {"epsabs": 1e-14, "epsrel": 1e-12, "limit": 200}
    C, _ = quad(left, 0.0, 1.0, **tight)
    return C, np.array([quad(right, 0.0, 1.0, (j,), **tight)[0] for j in range(3)])


@pytest.mark.parametrize("now", [0.8, 2.3, 4.0])
def test_sums_are_the_integrals_but_for_the_trapezoids_error(now: float) -> None:
    C, b = integrals(now)
    found = rows()
    at = round((now - OBSERVER.window) / T_S)
    size = np.abs(found.C).max()
    # h^2 / 12, h = 1/800, times the integrand's slope at both ends, T b |G2'| theta = 0.3 * 2:
    # 2e-7 of a C of 4e-3.
    assert found.C[at] == pytest.approx(C, abs=1e-4 * size)
    # w33' has no value and no slope at its ends: the next term, h^4.
    np.testing.assert_allclose(found.b[at], b, rtol=0.0, atol=1e-10 * np.abs(found.b).max())
    assert np.dot(b, SPRING) == pytest.approx(C, abs=1e-12)  # the identity itself


def test_the_rows_error_goes_with_the_square_of_the_period() -> None:
    def worst(period: float) -> float:
        found = rows(period)
        return float(np.abs(found.C - found.b @ np.array(SPRING)).max())

    assert worst(T_S) / worst(0.5 * T_S) == pytest.approx(4.0, rel=0.05)


def test_eq_28_as_printed_turns_time_round_and_breaks_the_identity() -> None:
    # g[m] with y[l - m] is the observer of the same signals played backwards.
    backwards = Signals(*(x[::-1] for x in signals()))
    found = rows_of(*backwards, inertia=J, damping=B, observer=OBSERVER, period=T_S)
    off = np.abs(found.C - found.b @ np.array(SPRING)).max()
    assert off > 0.1 * np.abs(found.C).max()


def test_the_coefficients_solve_eqs_23_to_25() -> None:
    n = 150
    whole = rows()
    short = Rows(whole.C[:n], whole.b[:n])

    def derivative(t, x):
        k = min(int(t / T_S), n - 1)
        a, P = x[:3], x[3:].reshape(3, 3)
        b, C = short.b[k], short.C[k]
        pull = P @ b
        return np.concatenate([-pull * (a @ b - C), -np.outer(pull, pull).ravel()])

    start = np.concatenate([np.zeros(3), OBSERVER.spread * np.eye(3).ravel()])
    steps = T_S * np.arange(n + 1)
    x = start
    for k in range(n):  # the right side jumps from one sample to the next
        done = solve_ivp(derivative, (steps[k], steps[k + 1] - 1e-12), x, rtol=1e-9, atol=1e-12)
        x = done.y[:, -1]
        exact = coefficients_of(short, OBSERVER, T_S)[k]
        # The solver's tolerance over 150 pieces; coefficients are of order 1.
        np.testing.assert_allclose(x[:3], exact, rtol=1e-5, atol=1e-7)


def test_stiffness_is_the_taylor_series() -> None:
    a = np.tile(np.array(SPRING), (5, 1))
    x = np.linspace(-0.5, 0.5, 5)
    np.testing.assert_allclose(stiffness_of(a, x), 3.0 - 2.0 * x + 30.0 * x**2, rtol=1e-15)


def test_a_wide_prior_finds_the_springs_and_the_printed_one_does_not() -> None:
    device, log = motion(0.0, 0.0, 0)
    wide = replace_spread(1e16)
    found = printed(device, log, wide)
    # 10 phi^3: a_2 = 60. The trapezoids' 1e-5 of the rows, where the powers are nearly collinear.
    np.testing.assert_allclose(found.coefficients[-1], [[0.0, 0.0, 60.0]] * 2, atol=0.02)
    seen = log.time >= 2.0
    truth = truth_of(device, log, "total")[seen]
    assert msrep_percent(found.stiffness[seen], truth) < 1e-6
    held_back = printed(device, log, SECTION4).stiffness[seen]
    assert 0.3 < msrep_percent(held_back, truth) < 0.7


def test_a_held_torque_taken_as_sampled_costs_a_thousandfold() -> None:
    device, log = motion(0.0, 0.0, 0)
    seen = log.time >= 2.0
    truth = truth_of(device, log, "total")[seen]
    wide = replace_spread(1e16)
    errors = [
        msrep_percent(printed(device, log, each).stiffness[seen], truth)
        for each in (wide, wide._replace(held=False))
    ]
    assert errors[1] > 300.0 * errors[0]


def replace_spread(spread: float) -> Observer:
    return SECTION4._replace(spread=spread, held=True)


def test_nothing_is_said_before_the_first_full_window() -> None:
    device, log = motion(0.0, 0.0, 0)
    short = replace(
        log,
        time=log.time[:1200],
        joints={
            name: {role: x[:1200] for role, x in roles.items()}
            for name, roles in log.joints.items()
        },
    )
    found = printed(device, short, SECTION4)
    assert not found.stiffness[:1000].any()
    assert found.stiffness[1000:].all()
