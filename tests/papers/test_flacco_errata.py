"""Where Flacco et al. 2012 as printed does not work: each departure pinned, by equation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.kernels import kinematic, residual
from rotatum.runtime.bank import Bank
from tests import naive
from tests.kernels.make import plain, record, solver_stage
from tests.kernels.test_solvers_long import awas_rows

T = 1e-3


def test_eq_15_as_printed_starts_from_where_the_motor_stands():
    # r(0) = K (p(0) + D theta(0)): 3000 N m of residual for a motor at 100 rad, at rest, no torque.
    K, B, D, n = 100.0, 0.02, 0.3, 50
    theta, still = np.full(n, 100.0), np.zeros(n)
    printed = naive.residual_as_printed(theta, still, still, period=T, K=K, B=B, D=D)
    assert printed[0] == pytest.approx(K * D * 100.0)
    motor = {"inertia": B, "damping": D, "width": 1.0}
    p = plain(record(residual.ResidualParams, period=T, gain=K, **motor))
    s = plain(record(residual.ResidualState))
    for _ in range(n):
        residual.momentum(p, s, 100.0, 0.0, 0.0)
        assert s.r == 0.0


def test_eq_17_as_printed_wears_out_while_increments_do_not():
    # A holding torque of 1e4 N m with a small signal on it, for 20 s: the integral is 2e5 by then
    # and the residual the difference of such numbers.
    n, K, B = 20_000, 300.0, 0.02
    tau = -1e4 + 1e-6 * np.sin(0.05 * np.arange(n))
    zero = np.zeros(n)
    printed = naive.residual(zero, zero, tau, period=T, K=K, B=B, D=0.0)
    p = plain(record(residual.ResidualParams, period=T, gain=K, inertia=B, width=1.0))
    s = plain(record(residual.ResidualState))
    ours = np.empty(n)
    for k, torque in enumerate(tau.tolist()):
        residual.momentum(p, s, 0.0, 0.0, torque)
        ours[k] = s.r
    pole = (2.0 - T * K) / (2.0 + T * K)
    exact = np.zeros(n)
    for k in range(1, n):  # the small signal and the large one apart: no cancellation
        exact[k] = pole * exact[k - 1] - (T * K / (2.0 + T * K)) * (
            (tau[k] + 1e4) + (tau[k - 1] + 1e4)
        )
    small = slice(n // 2, n)
    large = 1e4 * (1.0 - pole ** np.arange(n))
    error = np.abs(ours - large - exact)[small].max()
    assert error < 1e-10  # an ulp of 1e4 is 2e-12, remembered over 1 / (K T) samples
    assert np.abs(printed - large - exact)[small].max() > 5.0 * error


def variance_ratio(printed, unit):
    """eq. 20 at 3 counts a sample, in units of angle of 1/unit rad, over the largest variance."""
    resolution = 1e-4 * unit
    speed = 3.0 * resolution / T
    largest, smallest = 10.0, 0.1
    if printed:
        value = naive.measurement_variance_as_printed(
            speed,
            largest=largest,
            smallest=smallest,
            steepness=6.0,
            resolution=resolution,
            period=T,
        )
    else:
        value = naive.measurement_variance(
            speed,
            largest=largest,
            smallest=smallest,
            steepness=6.0,
            count_speed=resolution / T,
        )
    return value / largest


def test_eq_20_as_printed_depends_on_the_unit_of_angle():
    deg = 180.0 / math.pi
    # Three counts a sample, in whatever unit: the quantisation should not matter any more.
    assert variance_ratio(False, 1.0) == pytest.approx(0.01, rel=1e-2)
    assert variance_ratio(False, deg) == pytest.approx(variance_ratio(False, 1.0), rel=1e-9)
    # As printed it is the variance of standstill in rad (0.03 rad^2/s^2 in the exponent) and that
    # of full speed in degrees.
    assert variance_ratio(True, 1.0) > 0.9
    assert variance_ratio(True, deg) < 0.02


def test_eq_20_kernel_follows_the_counts_and_not_the_printed_product():
    resolution = 1e-4
    settings = {
        "mode": kinematic.MODIFIED,
        "acceleration": 1e10,
        "largest": 10.0,
        "smallest": 0.1,
        "steepness": 6.0,
        "count_speed": resolution / T,
    }
    p = plain(record(kinematic.KinematicParams, period=T, **settings))
    gains = []
    for velocity in (0.0, 3.0 * resolution / T):
        s = plain(record(kinematic.KinematicState))
        kinematic.start(p, s, 0.0)
        s.velocity, s.pp, s.vv = velocity, 1.0, 0.0
        p.acceleration = 0.0
        kinematic.observe(p, s, T * velocity + 1.0)  # innovation 1: the position gain is the rest
        gains.append(s.position - T * velocity)
    # P / (P + R) with P = 1: R = 9.97... at rest, 0.1 at three counts a sample.
    assert gains[0] == pytest.approx(1.0 / (1.0 + 9.9 / (1.0 + math.exp(-6.0)) + 0.1), rel=1e-12)
    assert gains[1] == pytest.approx(1.0 / (1.0 + 9.9 / (1.0 + math.exp(12.0)) + 0.1), rel=1e-12)


def test_eq_23_as_printed_loses_symmetry_and_definiteness():
    R, _ = awas_rows(3000)
    P = naive.covariance_as_printed(R, 1e20 * np.eye(18))
    assert np.abs(P - P.T).max() / np.abs(P).max() > 1e-10  # a symmetric update would give 0
    assert np.linalg.eigvalsh(0.5 * (P + P.T)).min() < 0.0
    stage = solver_stage("ud", 18)
    params = stage.params.zeros(1)
    params["forgetting"], params["variance"], params["spread"] = 1.0, 1.0, 1e20
    u = stage.input.zeros(3000, 1)
    u["R"][:, 0] = R
    bank = Bank(stage, params)
    bank.run(u)
    assert (bank.state["d"][0] > 0.0).all()


@pytest.mark.parametrize("c", [1e-5, 1.0])
def test_eqs_39_and_41_are_eq_23_with_a_smaller_prior(c):
    # (1 + rho - a rho) / a = 1 / c identically, so the factor is a measurement variance.
    rho = np.logspace(-6, 6, 50)
    a = (c + c * rho) / (1.0 + c * rho)
    np.testing.assert_allclose((1.0 + rho - a * rho) / a, 1.0 / c, rtol=1e-9)  # cancellation
    rng = np.random.default_rng(80)
    R = rng.standard_normal((100, 3))
    y = R @ [1.0, 2.0, 3.0] + 0.1 * rng.standard_normal(100)
    with_factor = naive.rls_as_printed(R, y, 1e6 * np.eye(3), np.zeros(3), c)
    plainly = naive.rls_as_printed(R, y, c * 1e6 * np.eye(3), np.zeros(3))
    # The outer products of P(0) = 1e6 leave 1e6 ulps.
    np.testing.assert_allclose(with_factor, plainly, rtol=0.0, atol=1e-8)


def test_section_6_settings_depend_on_the_unit_of_the_lever():
    # P(0) = 1e20, c = 1e-20 is a prior variance of 1 in whatever unit the columns are: with the
    # lever in millimetres the stiffness is found, in metres the prior holds it at zero.
    errors = {}
    for unit in (1.0, 1e-3):
        R, y = awas_rows(4000)
        scale = np.array([unit**j for _ in range(6) for j in range(3)])
        stage = solver_stage("ud", 18)
        params = stage.params.zeros(1)
        params["forgetting"], params["variance"], params["spread"] = 1.0, 1e20, 1e20
        u = stage.input.zeros(4000, 1)
        u["R"][:, 0], u["y"][:, 0] = R * scale, y
        out = Bank(stage, params).run(u)[:, 0]
        fit = (u["R"][:, 0] * out["alpha"]).sum(axis=1)
        errors[unit] = np.abs(fit - y)[2000:].max() / np.abs(y).max()
    assert errors[1.0] < 1e-3
    assert errors[1e-3] > 0.5
