"""Recursive least squares, both forms, against batch least squares and statsmodels."""

from __future__ import annotations

import numpy as np
import pytest
import statsmodels.api as sm

from rotatum.kernels import rls, udrls
from tests import naive
from tests.kernels.make import plain, record

FORMS = {"ud": (udrls, udrls.UdState), "covariance": (rls, rls.RlsState)}
BOTH = pytest.mark.parametrize("form", sorted(FORMS))


class Solver:
    """A solver kernel with its state, fast to step."""

    def __init__(self, form, spread, *, centre=0.0, variance=1.0, forgetting=1.0):
        p = len(spread)
        self.module, kind = FORMS[form]
        settings = {"variance": variance, "forgetting": forgetting}
        params = record(udrls.SolverParams, {"p": p}, spread=spread, centre=centre, **settings)
        state = record(kind, {"p": p})
        self.module.init(params, state)
        self.params, self.state = plain(params), plain(state)
        if form == "ud":
            self.state.U = np.array(self.state.U)
        else:
            self.state.P = np.array(self.state.P)

    def feed(self, R, y):
        for row, value in zip(R.tolist(), y.tolist(), strict=True):
            self.module.update(self.params, self.state, row, value)
        return np.array(self.state.alpha)

    def covariance(self):
        p = len(self.state.alpha)
        columns = []
        for e in np.eye(p).tolist():
            out = [0.0] * p
            self.module.multiply(self.state, e, out)
            columns.append(out)
        return np.array(columns)


def problem(p=4, n=200, seed=20):
    rng = np.random.default_rng(seed)
    R = rng.standard_normal((n, p))
    return R, R @ rng.standard_normal(p) + 0.1 * rng.standard_normal(n)


@BOTH
@pytest.mark.parametrize("variance", [1.0, 0.01, 100.0])
def test_is_batch_least_squares_with_the_prior(form, variance):
    R, y = problem()
    spread, centre = np.array([1e-2, 1.0, 1e2, 1e8]), np.array([1.0, -2.0, 0.0, 5.0])
    solver = Solver(form, spread, centre=centre, variance=variance)
    alpha = solver.feed(R, y)
    expected, P = naive.ridge(R, y, spread=spread, centre=centre, variance=variance)
    # A prior variance of 1e8 beside one of 1e-2 costs digits: 1e8 ulps of the smallest in P.
    np.testing.assert_allclose(alpha, expected, rtol=0.0, atol=1e-7 if form != "ud" else 1e-10)
    np.testing.assert_allclose(solver.covariance(), P, rtol=0.0, atol=1e-8 * P.max())
    assert solver.state.count == len(y)


@BOTH
def test_agrees_with_statsmodels(form):
    R, y = problem(p=3)
    theirs = sm.RecursiveLS(y, R).fit()
    ours = Solver(form, np.full(3, 1e8)).feed(R, y)
    # A prior of variance 1e8 against 200 rows pulls by 1 / (200 * 1e8); the rest is rounding
    # of the first update, where P falls by eight orders.
    np.testing.assert_allclose(ours, theirs.params, rtol=1e-6)


def test_both_forms_are_the_same_recursion():
    R, y = problem()
    spread = np.array([1.0, 2.0, 3.0, 4.0])
    for forgetting in (1.0, 0.98):
        ud = Solver("ud", spread, forgetting=forgetting, centre=0.5)
        cov = Solver("covariance", spread, forgetting=forgetting, centre=0.5)
        np.testing.assert_allclose(ud.feed(R, y), cov.feed(R, y), rtol=1e-11)  # rounding
        np.testing.assert_allclose(ud.covariance(), cov.covariance(), rtol=0.0, atol=1e-13)
        assert ud.state.innovation == pytest.approx(cov.state.innovation, rel=1e-9)
        assert ud.state.leverage == pytest.approx(cov.state.leverage, rel=1e-9)


@BOTH
def test_innovation_and_leverage_are_those_before_the_update(form):
    R, y = problem(n=20)
    spread, centre = np.full(4, 2.0), np.zeros(4)
    before, P = naive.ridge(R[:-1], y[:-1], spread=spread, centre=centre)
    solver = Solver(form, spread)
    solver.feed(R, y)
    assert solver.state.innovation == pytest.approx(y[-1] - R[-1] @ before, rel=1e-10)
    assert solver.state.leverage == pytest.approx(R[-1] @ P @ R[-1], rel=1e-10)


@BOTH
def test_squared_innovations_add_up_to_the_least_squares_objective(form):
    # What the evidence rests on: sum e^2 / (1 + rho) = |y - R alpha|^2 + |alpha|^2 / spread.
    R, y = problem()
    solver = Solver(form, np.full(4, 3.0))
    total = 0.0
    for k in range(len(y)):
        solver.feed(R[k : k + 1], y[k : k + 1])
        total += solver.state.innovation**2 / (1.0 + solver.state.leverage)
    alpha, _ = naive.ridge(R, y, spread=np.full(4, 3.0), centre=np.zeros(4))
    assert total == pytest.approx(((y - R @ alpha) ** 2).sum() + (alpha @ alpha) / 3.0, rel=1e-10)


@BOTH
def test_an_anchor_is_a_row_that_reads_one_coefficient(form):
    R, y = problem(n=50)
    one, other = Solver(form, np.full(4, 9.0)), Solver(form, np.full(4, 9.0), variance=0.25)
    for solver in (one, other):
        solver.params.variance = 1.0
        solver.feed(R, y)
    one.module.anchor(one.state, 2, -1.5, 0.25)
    other.params.variance = 0.25
    other.feed(np.eye(4)[2:3], np.array([-1.5]))
    np.testing.assert_allclose(one.state.alpha, other.state.alpha, rtol=1e-12)
    np.testing.assert_allclose(one.covariance(), other.covariance(), rtol=0.0, atol=1e-14)


@BOTH
def test_spread_and_multiply_are_those_of_the_dense_covariance(form):
    R, y = problem(n=3)  # fewer rows than columns: P far from diagonal
    solver = Solver(form, np.array([1.0, 10.0, 100.0, 1e3]))
    solver.feed(R, y)
    _, P = naive.ridge(R, y, spread=np.array([1.0, 10.0, 100.0, 1e3]), centre=np.zeros(4))
    c = np.random.default_rng(21).standard_normal(4)
    out = [0.0] * 4
    solver.module.multiply(solver.state, c.tolist(), out)
    np.testing.assert_allclose(out, P @ c, rtol=0.0, atol=1e-11 * P.max())  # rounding
    assert solver.module.spread(solver.state, c.tolist(), 0) == pytest.approx(c @ P @ c, rel=1e-9)
    c[:2] = 0.0
    assert solver.module.spread(solver.state, c.tolist(), 2) == pytest.approx(c @ P @ c, rel=1e-9)


@BOTH
def test_forgetting_with_its_prior_is_a_weighted_sum_of_information(form):
    R, y = problem(n=400)
    spread, centre = np.array([0.1, 1.0, 10.0, 100.0]), np.array([1.0, 0.0, 2.0, 0.0])
    solver = Solver(form, spread, centre=centre, variance=4.0, forgetting=0.97)
    alpha = solver.feed(R, y)
    expected, P = naive.forgetful_information(
        R, y, spread=spread, centre=centre, variance=4.0, forgetting=0.97
    )
    np.testing.assert_allclose(alpha, expected, rtol=1e-9)  # rounding, forgotten after 33 rows
    np.testing.assert_allclose(solver.covariance(), P, rtol=0.0, atol=1e-10 * P.max())


@BOTH
def test_forgetting_in_the_long_run_is_batch_with_the_same_prior(form):
    # The prior comes back one column at a time: within p (1 - lambda) / 2 of a constant one.
    forgetting, n = 0.99, 2000
    R, y = problem(n=n)
    spread = np.full(4, 0.05)
    alpha = Solver(form, spread, forgetting=forgetting).feed(R, y)
    weights = forgetting ** np.arange(n, 0, -1.0)
    expected, _ = naive.ridge(R, y, spread=spread, centre=np.zeros(4), weights=weights)
    free, _ = naive.ridge(R, y, spread=np.full(4, 1e12), centre=np.zeros(4), weights=weights)
    pull = np.abs(expected - free).max()
    assert pull > 0.05  # the prior matters here
    np.testing.assert_allclose(alpha, expected, rtol=0.0, atol=0.04 * pull)


@BOTH
@pytest.mark.parametrize("c", [1.0, 1e-5, 1e-2])
def test_variance_is_the_papers_stability_factor(form, c):
    # flacco2012 eqs 39 and 41 with (P(0), c) are eq. 23 with measurement variance 1 / c, and with
    # P(0) replaced by c P(0).
    R, y = problem()
    P0 = 1e6 * np.eye(4)
    printed = naive.rls_as_printed(R, y, P0, np.zeros(4), c)
    solver = Solver(form, np.full(4, 1e6), variance=1.0 / c)
    scaled = Solver(form, np.full(4, c * 1e6))
    for k in range(len(y)):
        row, value = R[k : k + 1], y[k : k + 1]
        # The outer products of the printed form round differently: P(0) = 1e6 times an ulp.
        np.testing.assert_allclose(solver.feed(row, value), printed[k], rtol=0.0, atol=1e-8)
        np.testing.assert_allclose(scaled.feed(row, value), printed[k], rtol=0.0, atol=1e-8)


def test_a_constant_stability_factor_is_a_variance_of_its_own():
    # flacco2012 fig. 22: constant a is R = (1 + rho - a rho) / a, row by row.
    R, y = problem(n=60)
    a = 0.3
    solver = Solver("ud", np.full(4, 10.0))
    P, alpha = 10.0 * np.eye(4), np.zeros(4)
    for F, value in zip(R, y, strict=True):
        rho = F @ P @ F
        solver.module.absorb(solver.state, F.tolist(), float(value), (1 + rho - a * rho) / a)
        gain = P @ F / (1.0 + rho)
        alpha = alpha + a * gain * (value - F @ alpha)
        P = P - a * np.outer(gain, F @ P)
    np.testing.assert_allclose(solver.state.alpha, alpha, rtol=1e-10)  # rounding
    np.testing.assert_allclose(solver.covariance(), P, rtol=0.0, atol=1e-12)


@BOTH
def test_units_of_the_columns_only_scale_the_coefficients(form):
    R, y = problem()
    unit = np.array([1e-3, 1.0, 1e3, 57.3])
    plainly = Solver(form, np.full(4, 1e3)).feed(R, y)
    scaled = Solver(form, 1e3 / unit**2).feed(R * unit, y)
    np.testing.assert_allclose(scaled * unit, plainly, rtol=1e-8)  # rounding of the covariance
