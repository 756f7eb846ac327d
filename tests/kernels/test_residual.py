"""The momentum residual against closed forms and the paper's own recursion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.kernels import residual
from tests import naive
from tests.kernels.make import Sines, plain, record

T = 1e-3
B, D = 0.02, 0.3


def run(theta, velocity, tau, *, K, inertia=B, damping=D, width=1e-3, **more):
    motor = {"inertia": inertia, "damping": damping, "width": width}
    p = plain(record(residual.ResidualParams, period=T, gain=K, **motor, **more))
    s = plain(record(residual.ResidualState))
    out = np.empty(len(theta))
    for k in range(len(theta)):
        residual.momentum(p, s, theta[k], velocity[k], tau[k])
        out[k] = s.r
    return out


def sine_motion(w, seconds=1.0, *, stiffness=50.0):
    """A motor moved as a sine against a spring to ground, and the torque that takes."""
    t = np.arange(round(seconds / T)) * T
    theta, velocity = 0.1 * np.sin(w * t), 0.1 * w * np.cos(w * t)
    elastic = -stiffness * theta
    tau = -B * 0.1 * w * w * np.sin(w * t) + D * velocity - elastic
    return t, theta, velocity, tau, elastic


@pytest.mark.parametrize("K", [30.0, 100.0, 300.0])
@pytest.mark.parametrize("w", [5.0, 40.0])
def test_is_the_elastic_torque_through_a_first_order_low_pass(K, w):
    t, theta, velocity, tau, _ = sine_motion(w)
    r = run(theta, velocity, tau, K=K)
    # r' = K (tau_e - r), r(0) = 0, tau_e = -5 sin(w t): eq. 16 solved by hand.
    size = -5.0 * K / (K * K + w * w)
    closed = size * (K * np.sin(w * t) - w * np.cos(w * t) + w * np.exp(-K * t))
    # The Tustin rule departs by about (K T)^2 / 12 on the transient, whose share is below w / K,
    # and by (w T)^2 / 12 on the sine; twice that, of 5 N m.
    error = ((K * T) ** 2 * w / K + (w * T) ** 2) / 6.0 * 5.0
    np.testing.assert_allclose(r, closed, rtol=0.0, atol=error)
    # It could fail: the torque itself, which the filter lags behind, is far off.
    assert np.abs(r + 5.0 * np.sin(w * t)).max() > 10.0 * error


def test_starts_from_zero_wherever_the_motor_stands():
    # Sin: momentum and damping torque at the start must not appear in the residual.
    _, theta, velocity, tau, _ = sine_motion(10.0)
    near = run(theta, velocity, tau, K=100.0)
    far = run(theta + 1e3, velocity, tau, K=100.0)
    assert far[0] == 0.0
    # theta's rounding at 1000 rad is 6e-14; times K D, and summed over 1 / (K T) samples.
    np.testing.assert_allclose(far, near, rtol=0.0, atol=2.0 * 6e-14 * 100.0 * D * 10.0)


def test_is_eq_17_without_the_growing_integral():
    _, theta, velocity, tau, _ = sine_motion(10.0)
    ours = run(theta, velocity, tau, K=100.0)
    printed = naive.residual(theta, velocity, tau, period=T, K=100.0, B=B, D=D)
    # Both sum 1000 terms of order K times 6 N m T; rounding of sums of order 100 at most.
    np.testing.assert_allclose(ours, printed, rtol=0.0, atol=1e-11)


def test_a_torque_that_stays_does_not_wear_the_residual_out():
    # 1e6 N m s of impulse: the integral of eq. 17 has lost 1e-10 by then; increments lose nothing.
    tau = np.full(2000, 500.0)
    r = run(np.zeros(2000), np.zeros(2000), tau, K=100.0)
    assert r[-1] == pytest.approx(-500.0, rel=1e-14)


def test_a_held_torque_counts_from_its_own_sample_on():
    # A free rotor under commands kept constant: velocity is piecewise linear, the elastic torque 0.
    tau = np.random.default_rng(6).standard_normal(300)
    velocity = np.concatenate([[0.0], np.cumsum(tau)[:-1]]) * T / B
    theta = np.zeros_like(velocity)
    held = run(theta, velocity, tau, K=300.0, damping=0.0, held=1)
    sampled = run(theta, velocity, tau, K=300.0, damping=0.0, held=0)
    assert np.abs(held).max() < 1e-13  # rounding of 300 sums of order 1
    assert np.abs(sampled).max() > 0.1  # half a sample late: K T / 2 of the torque's steps


def test_known_coulomb_friction_is_taken_off():
    C, width = 1.5, 1e-3
    _, theta, velocity, tau, _ = sine_motion(10.0)
    friction = C * np.clip(velocity / width, -1.0, 1.0)
    clean = run(theta, velocity, tau, K=100.0)
    known = run(theta, velocity, tau + friction, K=100.0, coulomb=C, width=width)
    unknown = run(theta, velocity, tau + friction, K=100.0)
    # Friction and torque meet in the same trapezoid, so that they cancel to rounding.
    np.testing.assert_allclose(known, clean, rtol=0.0, atol=1e-12)
    assert np.abs(unknown - clean).max() > 0.9 * C


def test_random_motion_agrees_with_a_fine_integration_of_eq_16():
    rng = np.random.default_rng(7)
    motion, load = Sines(rng, 0.2, 5.0, 60.0), Sines(rng, 5.0, 5.0, 60.0)
    K = 200.0
    t = np.arange(800) * T
    theta, velocity, elastic = motion(t), motion(t, 1), load(t)
    tau = B * motion(t, 2) + D * velocity - elastic
    fine = np.arange(800 * 20) * T / 20
    pole = math.exp(-K * T / 20)
    # Exact for a torque that is constant over a twentieth of a sample.
    expected = naive.lowpass(pole, load(fine + 0.5 * T / 20), 0.0)[19::20][:-1]
    r = run(theta, velocity, tau, K=K)
    # (K T)^2 / 12 = 0.33 % of the start's transient, (w T)^2 / 12 = 0.03 % of the rest, and as much
    # for theta' and the torque, which the trapezoid takes as linear between samples.
    np.testing.assert_allclose(r[1:], expected, rtol=0.0, atol=0.006 * load.bound(0))
