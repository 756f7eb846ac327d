"""Position, velocity, acceleration and jerk of one instant."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.observers.jerk import jerk_observer, sensible_lag, snap_model
from rotatum.estimators.observers.smoothing import steady_filter
from rotatum.estimators.observers.triple import printed_observer

CASES = [(1e-3, None, None), (5e-3, None, 4), (1e-3, 60.0, 0), (1e-3, 60.0, None),
         (1e-3, 1500.0, 7), (5e-3, 30.0, None), (5e-3, 100.0, 3)]  # fmt: skip


@pytest.mark.parametrize(("period", "bandwidth", "lag"), CASES)
def test_cubics_are_reproduced_at_the_delayed_instant(period, bandwidth, lag):
    found = jerk_observer(period, bandwidth=bandwidth, lag=lag).recursion
    scale = period if bandwidth is None else 1.0 / bandwidth  # s: time the observer sees
    wait = 10 if bandwidth is None else int(80.0 * scale / period)  # exp(-0.38 * 80) = 5e-14
    k = np.arange(wait + found.window + 50)
    s = (k - k[-1]) * period / scale  # time in units of the observer's
    poly = np.polynomial.Polynomial([1.0, 0.1, -5e-3, 1e-4])
    out = found.run(poly(s))[-50:]
    truth = s[found.window - 1 - found.lag :][: len(k) - found.window + 1][-50:]
    for order in range(4):
        wanted = (poly.deriv(order) if order else poly)(truth)
        # Rounding of q (up to 60), through weights that add up to 30 in these units; the start.
        np.testing.assert_allclose(out[:, order] * scale**order, wanted, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("bandwidth", [None, 100.0])
def test_starts_at_rest(bandwidth):
    out = jerk_observer(1e-3, bandwidth=bandwidth).recursion.run(np.full(80, 0.7))
    scale = np.array([1.0, 1e3, 1e6, 1e9])
    assert np.abs(out / scale - [0.7, 0.0, 0.0, 0.0]).max() < 1e-12


def test_deadbeat_jerk_is_the_mean_of_two_printed_ones():
    T = 5e-3
    q = 0.3 * np.random.default_rng(0).standard_normal(60)
    U = printed_observer(T).recursion.run(q)[3:, 3]
    jerk = jerk_observer(T, bandwidth=None).recursion.run(q)[:, 3]
    n = min(len(U) - 1, len(jerk))
    np.testing.assert_allclose(jerk[-n:] * T**3, 0.5 * (U[1:] + U[:-1])[-n:] * T**3, atol=1e-13)


@pytest.mark.parametrize(("period", "bandwidth"), [(1e-3, 20.0), (5e-3, 40.0)])
def test_poles_lie_on_butterworths_circle(period, bandwidth):
    E = jerk_observer(period, bandwidth=bandwidth).recursion.E
    scale = bandwidth ** np.arange(4.0)
    poles = np.log(np.linalg.eigvals(E / scale[:, None] * scale).astype(complex)) / period
    wanted = bandwidth * np.exp(1j * np.pi * np.array([5, 7, 9, 11]) / 8.0)
    # The sampled filter's poles depart from the continuous one's with (w T)^8 only.
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(wanted),
                               rtol=0.0, atol=1e-6 * bandwidth)  # fmt: skip


def test_with_a_long_lag_all_are_derivatives_of_one_smooth_position():
    T, w = 1e-3, 50.0
    found = jerk_observer(T, bandwidth=w, lag=400)  # 20 / w: exp(-0.38 * 20) = 5e-4 is left
    speed = np.linspace(5.0, 100.0, 60)
    seen = found.recursion.response(speed * T)[:, :, 0] / (1j * speed[:, None]) ** np.arange(4)
    smooth = 1.0 / (1.0 + (speed / w) ** 8)
    # What the lag cuts off; the jerk, lowest of 1 / (i w)^3, feels it most at low speed.
    np.testing.assert_allclose(seen, np.tile(smooth[:, None], 4), rtol=0.0, atol=5e-3)
    # (speed / w)^8 = sqrt 2 - 1.
    assert found.bandwidth == pytest.approx(w * (2.0**0.5 - 1.0) ** 0.125, rel=0.01)


def test_the_lags_the_docstring_names():
    h = 0.02
    Phi, C, Q = snap_model(h)
    steady = steady_filter(Phi, C, Q, np.eye(1))
    left, power, path = steady.P.copy(), np.eye(4), []
    for _ in range(int(30.0 / h)):
        seen = steady.P @ power.T @ C.T
        left = left - seen @ seen.T / steady.S
        power = power @ steady.closed
        path.append(left[3, 3])
    excess = np.array(path) / path[-1] - 1.0
    assert steady.P[3, 3] / path[-1] == pytest.approx(8.0, rel=0.01)
    for lag, share in ((3.2, 0.20), (3.6, 0.10), (5.2, 0.05), (6.6, 0.01)):
        assert excess[int(lag / h)] == pytest.approx(share, abs=0.01)
    assert sensible_lag(50.0, 1e-3) == 100


@pytest.mark.parametrize("bandwidth", [None, 200.0])
def test_std_is_what_noise_does(bandwidth):
    found = jerk_observer(1e-3, bandwidth=bandwidth, lag=10, noise=3e-5)
    noise = 3e-5 * np.random.default_rng(6).standard_normal(15_000)
    sampled = found.recursion.run(noise)[200:].std(axis=0)
    # Positions are correlated over 1 / (w T) = 5 to 10 samples, so 1500 independent ones at least:
    # a std is known to 2 %; three of those.
    np.testing.assert_allclose(sampled, found.std, rtol=0.06)


def test_a_shift_register_of_outputs_does_the_same():
    window = jerk_observer(1e-3, bandwidth=200.0, lag=6).recursion
    plain = window.augmented()
    assert plain.window == 1
    np.testing.assert_allclose(plain.impulse(60), window.impulse(60), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(plain.noise(), window.noise(), rtol=1e-8)


def test_refuses_what_makes_no_sense():
    with pytest.raises(MethodError, match="bandwidth out of range"):
        jerk_observer(1e-3, bandwidth=5000.0)
    with pytest.raises(MethodError, match="lag: lag too short, got 1; allowed: 2 or more"):
        jerk_observer(1e-3, bandwidth=None, lag=1)
