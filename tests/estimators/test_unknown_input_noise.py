"""What noise the designs leave: predictions, what poles and delay buy, least noise, intensity."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from rotatum.errors import MethodError, RotatumError
from rotatum.estimators.observers.decoupled import exact_observer
from rotatum.estimators.observers.existence import exists
from rotatum.estimators.observers.figures import figures, settle
from rotatum.estimators.observers.finite import finite_observer
from rotatum.estimators.observers.least_noise import least_noise_observer
from rotatum.estimators.observers.recursion import stable_sum
from rotatum.estimators.observers.smoothing import fixed_lag, steady_filter
from rotatum.estimators.observers.system import system
from rotatum.estimators.observers.triple import printed_observer, triple_integrator
from tests.estimators.observed import mixed, redundant, simulate, siso

T = 5e-3


@pytest.mark.parametrize("given", [mixed(), triple_integrator(T), siso(0.6)],
                         ids=["mixed", "triple", "siso"])  # fmt: skip
def test_poles_buy_no_noise_where_outputs_are_as_many_as_inputs(given):
    found = exists(given)
    delay, free = found.delay, given.sizes[0] - len(found.zeros)
    fast = exact_observer(given, delay).recursion.impulse(80)
    slow = exact_observer(given, delay, np.linspace(0.7, 0.9, free)).recursion.impulse(80)
    later = exact_observer(given, delay + 2).recursion.impulse(82)
    size = np.abs(fast).max(axis=(0, 2))[:, None]
    # Rounding: in units of each estimate's own response to an output.
    np.testing.assert_allclose(slow / size, fast / size, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(later[2:] / size, fast / size, rtol=0.0, atol=1e-9)
    assert np.abs(later[:2] / size).max() < 1e-9


def test_the_printed_observer_multiplies_noise_by_the_root_of_twenty_over_T_cubed():
    found = figures(triple_integrator(T), printed_observer(T).recursion, T)
    assert found.noise_gain == pytest.approx([20.0 / T**6], rel=1e-12)
    assert found.bandwidth == pytest.approx([math.pi / T])  # exact up to the Nyquist frequency
    assert found.settle <= 3
    assert found.lag == 3


def sampled(recursion, samples=20_000, seed=1):
    """Covariance of ``out`` under white noise."""
    y = np.random.default_rng(seed).standard_normal((samples, recursion.channels))
    return np.cov(recursion.run(y)[recursion.window + 50 :].T)


@pytest.mark.parametrize("kind", ["placed", "least", "finite"])
def test_predicted_variances_are_what_noise_does(kind):
    given = redundant()
    recursion = {
        "placed": lambda: exact_observer(given, 1, [0.1, 0.2, 0.3, 0.4]).recursion,
        "least": lambda: least_noise_observer(given, 1, memory=12),
        "finite": lambda: finite_observer(given, 1, 10.0),
    }[kind]()
    predicted = recursion.noise()
    # 20,000 samples correlated over at most 5: a variance is known to sqrt(2 * 5 / 20000) = 2.2 %;
    # three of those.
    np.testing.assert_allclose(np.diag(sampled(recursion)), np.diag(predicted), rtol=0.07)


def test_least_noise_beats_placed_poles_in_prediction_and_sampling():
    given = redundant()
    n = given.sizes[0]
    least = least_noise_observer(given, 1)
    placed = exact_observer(given, 1, [0.1, 0.2, 0.3, 0.4]).recursion
    deadbeat = exact_observer(given, 1).recursion
    seen = sampled(least, 8000)
    for other in (placed, deadbeat):
        assert (np.diag(least.noise()) < np.diag(other.noise()) * (1.0 + 1e-9)).all()
        assert (np.diag(least.noise())[n:] < 0.7 * np.diag(other.noise())[n:]).all()
        assert (np.diag(seen)[n:] < np.diag(sampled(other, 8000))[n:]).all()


def test_least_noise_is_unbiased_for_inputs_of_any_size():
    given = redundant(7, 5, feedthrough=True)
    u = 1e3 * np.random.default_rng(4).standard_normal((60, 2)).cumsum(axis=0)
    x, y = simulate(given, u, x0=1.0)
    observer = least_noise_observer(given, 1, memory=10)
    out = observer.run(y)
    truth = np.hstack([x, u])[observer.window - 2 : -1]
    np.testing.assert_allclose(out, truth, rtol=0.0, atol=1e-9 * np.abs(truth).max())


def test_least_noise_is_the_limit_of_the_kalman_filter_for_large_intensity():
    """Two derivations of the best unbiased observer: least squares, and a Riccati equation."""
    given = redundant()
    R = np.array([[1.0, 0.3, 0.0], [0.3, 2.0, 0.0], [0.0, 0.0, 0.5]])
    least = np.diag(least_noise_observer(given, 2, R, memory=40).noise(R))
    last = np.inf
    for intensity in (1e1, 1e2, 1e4):
        finite = np.diag(finite_observer(given, 2, intensity, R, "white").noise(R))
        apart = np.abs(finite / least - 1.0).max()
        assert apart < last
        last = apart
    assert last < 1e-6  # falls with the square of the intensity; 1e-8 was left, and rounding


def test_least_noise_says_what_it_cannot_do():
    with pytest.raises(MethodError, match="without invariant zeros"):
        least_noise_observer(siso(0.6), 1)
    with pytest.raises(MethodError, match="memory"):
        least_noise_observer(redundant(), 2, memory=2)
    with pytest.raises(MethodError, match="1 or more"):
        least_noise_observer(redundant(), 0)


@pytest.mark.parametrize("sizes", [(3, 1), (5, 2), (4, 4)])
def test_the_steady_filter_solves_the_riccati_equation(sizes):
    n, p = sizes
    rng = np.random.default_rng(n)
    A, C, B = (rng.standard_normal(s) for s in ((n, n), (p, n), (n, 2)))
    R = 0.3 * np.eye(p)
    wanted = solve_discrete_are(A.T, C.T, B @ B.T, R)
    found = steady_filter(A, C, B @ B.T, R)
    np.testing.assert_allclose(found.P, wanted, rtol=0.0, atol=1e-11 * np.abs(wanted).max())


def test_a_fixed_lag_smoother_is_the_conditional_mean():
    """Against batch least squares over a long window with the steady prior at its start."""
    rng = np.random.default_rng(9)
    A = np.array([[0.9, 0.3], [-0.2, 0.8]])
    C, Q, R = np.array([[1.0, 0.0]]), np.diag([0.0, 0.4]), np.eye(1)
    lag = 4
    filtered = steady_filter(A, C, Q, R)
    smoother = fixed_lag(C, filtered, lag)
    # Stack x(k-L), w(k-L), ..., w(k-1): prior of x with mean m, y = H s + v.
    prior, states = rng.standard_normal(2), 2 + 2 * lag
    S0 = np.zeros((states, states))
    S0[:2, :2] = filtered.P
    for i in range(lag):
        S0[2 + 2 * i : 4 + 2 * i, 2 + 2 * i : 4 + 2 * i] = Q
    rows, x = [], np.eye(2, states)
    for i in range(lag + 1):
        rows.append(C @ x)
        if i < lag:
            x = A @ x
            x[:, 2 + 2 * i : 4 + 2 * i] += np.eye(2)
    H = np.vstack(rows)
    y = rng.standard_normal(lag + 1)
    mean = np.concatenate([prior, np.zeros(states - 2)])
    gain = S0 @ H.T @ np.linalg.inv(H @ S0 @ H.T + np.eye(lag + 1))
    wanted = (mean + gain @ (y - H @ mean))[:2]
    np.testing.assert_allclose(smoother.G @ prior + smoother.K @ y, wanted, atol=1e-12)


def test_intensity_trades_bandwidth_for_noise():
    given = triple_integrator(T)
    exact = figures(given, printed_observer(T).recursion, T)
    found = [figures(given, finite_observer(given, 20, i, 1e-8), T) for i in (1e3, 10.0, 0.1)]
    assert found[0].noise_gain[0] < exact.noise_gain[0]
    assert found[0].noise_gain[0] > found[1].noise_gain[0] > found[2].noise_gain[0]
    assert found[0].bandwidth[0] > found[1].bandwidth[0] > found[2].bandwidth[0]
    lags = [figures(given, finite_observer(given, L, 10.0, 1e-8), T).noise_gain[0]
            for L in (3, 10, 30)]  # fmt: skip
    assert lags[0] > lags[1] > lags[2]


def test_bandwidth_is_where_a_sine_comes_out_3_dB_down():
    given = triple_integrator(T)
    recursion = finite_observer(given, 10, 10.0, 1e-8)
    w = figures(given, recursion, T).bandwidth[0] * T
    k = np.arange(3000)
    u = np.exp(1j * w * k)
    x = np.zeros(3, dtype=complex)
    # A start from which the plant only swings: no polynomial drift to drown the sine.
    x = np.linalg.solve(np.exp(1j * w) * np.eye(3) - given.A, given.B[:, 0])
    y = (given.C @ x)[0] * u
    out = recursion.run(y.real)[:, 3] + 1j * recursion.run(y.imag)[:, 3]
    assert np.abs(out[-500:]) == pytest.approx(math.sqrt(0.5), rel=1e-3)


def test_it_needs_no_decaying_zeros_but_an_observable_mode():
    assert settle(finite_observer(siso(1.25), 3, 1.0)) > 0
    unseen = system(np.diag([0.5, 1.1]), [[1.0], [1.0]], [[1.0, 0.0]])
    with pytest.raises(MethodError, match="not seen by the outputs"):
        finite_observer(unseen, 2, 1.0)
    with pytest.raises(MethodError, match="must be positive"):
        finite_observer(siso(0.6), 2, 0.0)
    with pytest.raises(RotatumError, match="Did you mean 'walk'"):
        finite_observer(siso(0.6), 2, 1.0, model="wallk")


def test_settle_is_when_the_start_is_forgotten():
    given = redundant()
    recursion = exact_observer(given, 1, [0.1, 0.2, 0.3, 0.8]).recursion
    # 0.8^k reaches 1e-6 at k = 62; what it multiplies is of order one.
    assert 50 <= settle(recursion) <= 75
    # A thousand times more left: log(1000) / log(1 / 0.8) = 31 steps earlier.
    assert settle(recursion) - settle(recursion, 1e-3) == pytest.approx(31, abs=2)
    with pytest.raises(MethodError, match="does not forget"):
        stable_sum(np.diag([0.5, 1.01]), np.eye(2))
