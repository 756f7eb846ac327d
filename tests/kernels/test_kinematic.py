"""Kinematic Kalman filter against filterpy, scipy's Riccati solver and sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from scipy.linalg import solve_discrete_are

from rotatum.estimators.gains import steady_gains, velocity_std
from rotatum.kernels import kinematic
from tests import naive
from tests.kernels.make import plain, record

T = 1e-3


def run(z, **params):
    p = plain(record(kinematic.KinematicParams, period=T, **params))
    s = plain(record(kinematic.KinematicState))
    kinematic.init(p, s)
    kinematic.start(p, s, z[0])
    path = [(s.position, s.velocity)]
    for value in z[1:]:
        kinematic.observe(p, s, value)
        path.append((s.position, s.velocity))
    return np.array(path), s


def reference(z, V_a, R, P0):
    """Filterpy on the same model; R is a function of the velocity."""
    kf = KalmanFilter(dim_x=2, dim_z=1)
    kf.x = np.array([[z[0]], [0.0]])
    kf.F = np.array([[1.0, T], [0.0, 1.0]])
    kf.H = np.array([[1.0, 0.0]])
    gamma = np.array([[0.5 * T * T], [T]])
    kf.Q = V_a * gamma @ gamma.T
    kf.P = P0.copy()
    path, gains = [kf.x.ravel().copy()], []
    for value in z[1:]:
        kf.R = np.array([[R(kf.x[1, 0])]])
        kf.predict()
        kf.update(np.array([[value]]))
        path.append(kf.x.ravel().copy())
        gains.append(kf.K.ravel().copy())
    return np.array(path), np.array(gains)


@pytest.mark.parametrize("bandwidth", [1.0, 30.0, 300.0, 1000.0])
def test_steady_gains_solve_the_riccati_equation(bandwidth):
    R = 1e-8
    gamma = np.array([[0.5 * T * T], [T]])
    Q = bandwidth**4 * R * gamma @ gamma.T  # V_a = w^4 R
    F, H = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    # In units of the noise and of position per sample, or the solver works with 1e-20.
    scale = np.diag([1.0, T]) / math.sqrt(R)
    back = np.linalg.inv(scale)
    P = solve_discrete_are((scale @ F @ back).T, H.T, scale @ Q @ scale.T, np.eye(1))
    K = P[:, 0] / (P[0, 0] + 1.0)
    alpha, beta = steady_gains(bandwidth, T)
    # The Riccati solver loses half of its digits where the tracking index is small: (w T)^2 = 1e-6.
    assert alpha == pytest.approx(K[0], rel=1e-6)
    assert beta == pytest.approx(K[1], rel=1e-6)


def test_constant_gains_are_the_kalman_filter_in_its_steady_state():
    w, R = 200.0, 1e-8
    rng = np.random.default_rng(3)
    t = np.arange(4000) * T
    z = 0.3 * np.sin(3.0 * t) + math.sqrt(R) * rng.standard_normal(len(t))
    alpha, beta = steady_gains(w, T)
    ours, _ = run(z, position_gain=alpha, velocity_gain=beta)
    theirs, gains = reference(z, w**4 * R, lambda speed: R, np.diag([R, w**2 * R]))
    # Rounding of the covariance recursion, 1e-12 of a gain, is all that is left of the start.
    assert gains[-1] == pytest.approx([alpha, beta / T], rel=1e-9)
    # The start is forgotten with exp(-w t / sqrt 2): nothing left of it after the first 2 s.
    np.testing.assert_allclose(ours[2000:], theirs[2000:], rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("bandwidth", [30.0, 300.0])
def test_velocity_std_is_what_quantisation_noise_does(bandwidth):
    resolution = 1e-3
    rng = np.random.default_rng(4)
    z = rng.uniform(-0.5, 0.5, 60_000) * resolution
    alpha, beta = steady_gains(bandwidth, T)
    path, _ = run(z, position_gain=alpha, velocity_gain=beta)
    sampled = path[1000:, 1].std()
    # 59,000 samples, correlated over about 1 / (w T): 30 at worst, so 2,000 independent ones,
    # whose std is known to 1.6 %; three of those.
    assert sampled == pytest.approx(velocity_std(bandwidth, T, resolution), rel=0.05)


def test_velocity_std_of_real_quantisation_is_below_a_count_per_sample():
    # Continuous sense: white noise of density R T through the filter leaves w^3 R T / (2 sqrt 2).
    w, resolution = 10.0, 1e-4
    R = resolution**2 / 12.0
    expected = math.sqrt(R * T * w**3 / (2.0 * math.sqrt(2.0)))
    # The discrete filter departs from the continuous one by about w T = 1 %.
    assert velocity_std(w, T, resolution) == pytest.approx(expected, rel=0.02)


SETTINGS = {
    "largest": 1e-6,
    "smallest": 1e-8,
    "steepness": 6.0,
    "count_speed": 0.5,
}


def encoder(scale=1.0):
    rng = np.random.default_rng(5)
    t = np.arange(600) * T
    z = 0.3 * np.sin(8.0 * t) + 2e-4 * rng.standard_normal(len(t))
    return scale * z


def test_modified_filter_is_a_kalman_filter_with_the_corrected_variance():
    V_a = 1e4
    z = encoder()
    ours, state = run(z, mode=kinematic.MODIFIED, acceleration=V_a, **SETTINGS)
    start = np.diag([SETTINGS["largest"], V_a * T * T])
    theirs, _ = reference(z, V_a, lambda v: naive.measurement_variance(v, **SETTINGS), start)
    assert np.abs(ours[:, 1]).max() > 2.0 * SETTINGS["count_speed"]  # both ends of eq. 20 are seen
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12)  # rounding of 600 recursions
    assert state.count == len(z)


def test_works_on_records_too():
    p = record(kinematic.KinematicParams, period=T, mode=kinematic.MODIFIED, acceleration=1e4)
    for name, value in SETTINGS.items():
        p[name] = value
    s = record(kinematic.KinematicState)
    kinematic.start(p, s, 0.1)
    kinematic.observe(p, s, 0.2)
    path, _ = run([0.1, 0.2], mode=kinematic.MODIFIED, acceleration=1e4, **SETTINGS)
    assert (s.position, s.velocity) == tuple(path[-1])


def test_modified_filter_does_not_depend_on_the_unit_of_angle():
    deg = 180.0 / math.pi
    plain, _ = run(encoder(), mode=kinematic.MODIFIED, acceleration=1e4, **SETTINGS)
    scaled = SETTINGS | {
        "largest": SETTINGS["largest"] * deg**2,
        "smallest": SETTINGS["smallest"] * deg**2,
        "count_speed": SETTINGS["count_speed"] * deg,
    }
    other, _ = run(encoder(deg), mode=kinematic.MODIFIED, acceleration=1e4 * deg**2, **scaled)
    np.testing.assert_allclose(other / deg, plain, rtol=1e-10, atol=1e-13)  # rounding


def test_high_speed_does_not_overflow_the_exponential():
    z = np.arange(500) * 1e3 * T  # 1000 rad/s against 1e-6 rad/s a count: exp(6e9) unclamped
    settings = SETTINGS | {"count_speed": 1e-6}
    path, state = run(z, mode=kinematic.MODIFIED, acceleration=1e10, **settings)
    assert np.isfinite(path).all()
    assert path[-1, 1] == pytest.approx(1e3, rel=1e-3)  # and follows, after 0.5 s
    assert state.pp > 0.0
    assert state.vv > 0.0


def test_starts_at_rest_where_the_encoder_stands():
    alpha, beta = steady_gains(100.0, T)
    path, _ = run(np.full(20, 1e6), position_gain=alpha, velocity_gain=beta)
    assert path[:, 0].tolist() == [1e6] * 20
    assert path[:, 1].tolist() == [0.0] * 20
