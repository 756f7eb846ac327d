"""menard2013 eqs 23-25 under a hold: the discrete recursion solves them, explicit Euler does not.

``A' = -P B (B^T A - C)``, ``P' = -P B B^T P``. While B and C are held, ``P^-1`` grows by
``h B B^T`` and ``P^-1 A`` by ``h B C``: the least-squares update with measurement variance 1/h,
whatever h.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import prepare
from rotatum.kernels import rls, udrls
from rotatum.models import device_from_tables
from tests.kernels.make import plain, record

LARGE = 1e10  # P(0) of the paper's section IV


def held(seed, rows, p=3):
    """B and C, constant in between, of coefficients that some noise hides."""
    rng = np.random.default_rng(seed)
    B = rng.standard_normal((rows, p))
    return B, B @ np.arange(1.0, p + 1.0) + 0.1 * rng.standard_normal(rows)


def recursion(kernel, state, B, C, h, spread):
    """Estimate and covariance of a solver with measurement variance 1/h."""
    p = B.shape[1]
    params = plain(record(udrls.SolverParams, {"p": p}, forgetting=1.0, variance=1.0 / h))
    params.spread = [spread] * p
    memory = plain(record(state, {"p": p}))
    kernel.init(params, memory)
    for row, y in zip(B.tolist(), C.tolist(), strict=True):
        kernel.update(params, memory, row, y)
    P = np.zeros((p, p))
    for j in range(p):
        column = [0.0] * p
        kernel.multiply(memory, [float(i == j) for i in range(p)], column)
        P[:, j] = column
    return np.array(memory.alpha), P


def integrated(B, C, h, spread, **how):
    """The same by an integrator, restarted where B and C jump."""
    p = B.shape[1]
    state = np.concatenate([np.zeros(p), (spread * np.eye(p)).ravel()])
    for b, c in zip(B, C, strict=True):

        def rate(_, x, b=b, c=c):
            A, P = x[:p], x[p:].reshape(p, p)
            gain = P @ b
            return np.concatenate([-gain * (b @ A - c), -np.outer(gain, gain).ravel()])

        found = solve_ivp(rate, (0.0, h), state, **how)
        assert found.success
        state = found.y[:, -1]
    return state[:p], state[p:].reshape(p, p)


@pytest.mark.parametrize("h", [1e-3, 0.1])
def test_the_recursion_is_the_solution_of_the_stiff_equations(h):
    B, C = held(440, 6)
    A, P = recursion(udrls, udrls.UdState, B, C, h, LARGE)
    expected, covariance = integrated(B, C, h, LARGE, method="Radau", rtol=1e-9, atol=1e-11)
    # Radau's own tolerance, which the first intervals, where P falls from 1e10 to 1/h, amplify.
    np.testing.assert_allclose(A, expected, rtol=1e-5)
    np.testing.assert_allclose(P, covariance, rtol=1e-5, atol=1e-5 * np.abs(P).max())


@pytest.mark.parametrize(
    ("kernel", "state", "close"),
    # Between 1e10 and 1/h the covariance form loses digits in three subtractions, the UD form none.
    [(udrls, udrls.UdState, 1e-9), (rls, rls.RlsState, 1e-4)],
)
@pytest.mark.parametrize("h", [1e-3, 0.1])
def test_the_recursion_is_linear_algebra(kernel, state, close, h):
    B, C = held(443, 30)
    A, _ = recursion(kernel, state, B, C, h, LARGE)
    information = np.eye(3) / LARGE + h * B.T @ B
    np.testing.assert_allclose(A, np.linalg.solve(information, h * B.T @ C), rtol=close)


def euler(B, C, h, spread, steps):
    """Explicit Euler, ``steps`` in each interval."""
    p = B.shape[1]
    A, P = np.zeros(p), spread * np.eye(p)
    with np.errstate(over="ignore", invalid="ignore"):
        for b, c in zip(B, C, strict=True):
            for _ in range(steps):
                gain = P @ b
                A = A - h / steps * gain * (b @ A - c)
                P = P - h / steps * np.outer(gain, gain)
    return A, P


def test_explicit_euler_blows_up():
    # P' = -P^2 B^2 from 1e10: a step of 1 ms overshoots by h P B^2 = 1e7, which is squared.
    B, C = held(441, 12)
    for steps in (1, 100):
        A, _ = euler(B, C, 1e-3, LARGE, steps)
        assert not np.isfinite(A).all() or np.abs(A).max() > 1e6
    # From a P(0) that is no larger than what a row says it would have done.
    A, P = euler(B, C, 1e-3, 10.0, 400)
    expected, covariance = recursion(udrls, udrls.UdState, B, C, 1e-3, 10.0)
    np.testing.assert_allclose(A, expected, rtol=1e-3)  # h P B^2 / 2 / 400 in each interval
    np.testing.assert_allclose(P, covariance, rtol=1e-3, atol=1e-4)


def test_only_the_ratio_of_prior_and_variance_matters():
    # P(0) = 1e10 with rows every h is P(0) = 1e10 h with a variance of 1: nothing else to choose.
    B, C = held(442, 40)
    one, P = recursion(udrls, udrls.UdState, B, C, 0.01, LARGE)
    other, Q = recursion(udrls, udrls.UdState, B, C, 1.0, 0.01 * LARGE)
    np.testing.assert_allclose(one, other, rtol=1e-11)  # rounding
    np.testing.assert_allclose(P * 0.01, Q, rtol=1e-9, atol=1e-15)


def test_asked_for_it_is_the_stage_of_the_recursion():
    device = device_from_tables({"name": "one", "motor": {"inertia": 0.3}}, "test")
    ud, continuous = (
        prepare(
            device.joints[0],
            settle(device.joints[0], device, 1e-3, Request("algebraic", solver=solver)),
            period=1e-3,
            holds={},
        )
        for solver in ("ud", "continuous")
    )
    # The prior is relative to a row's variance: in either unit of time the same numbers.
    assert continuous.stage is ud.stage
    assert continuous.params.tobytes() == ud.params.tobytes()
