"""Shrinking high orders, against nested models computed in batch."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.kernels import blocks, shrink
from tests import naive
from tests.kernels.make import plain, record
from tests.kernels.test_solvers import Solver


class Problem(NamedTuple):
    """Rows taken by the solver, sums of scores, and what the batch says of both."""

    params: SimpleNamespace
    state: SimpleNamespace
    solver: SimpleNamespace
    sums: SimpleNamespace
    scores: np.ndarray  # of this transmission, one row per block of level 0
    models: np.ndarray  # (p, p): solutions of the nested models
    covariances: np.ndarray  # (p, p, p)

    @property
    def zeta(self) -> np.ndarray:
        return self.models.diagonal()

    @property
    def d(self) -> np.ndarray:
        return np.array([P[m, m] for m, P in enumerate(self.covariances)])


def problem(seed, *, p=4, first=2, n=60, at=0, noise=0.3):
    """A solver that took ``n`` rows, and sums over 32 blocks of scores, ours from ``at`` on."""
    rng = np.random.default_rng(seed)
    spread = 10.0 ** rng.uniform(0.0, 3.0, p)
    centre = rng.standard_normal(p)
    R = rng.standard_normal((n, p)) @ (np.eye(p) + 0.3 * rng.standard_normal((p, p)))
    y = R @ (rng.standard_normal(p) / np.arange(1.0, p + 1.0)) + noise * rng.standard_normal(n)
    solver = Solver("ud", spread, centre=centre)
    solver.feed(R, y)
    scores = rng.standard_normal((32, at + p)) * rng.uniform(0.1, 10.0)
    params = plain(record(shrink.ShrinkParams, first=first))
    state = plain(record(shrink.ShrinkState, {"p": p}))
    shrink.init(params, state)
    models, covariances = naive.nested(R, y, spread=spread, centre=centre)
    mine = scores[:, at:]
    return Problem(params, state, solver.state, packed(scores), mine, models, covariances)


def packed(scores):
    """Block sums of scores whose level 0 has a block each, as the kernels keep them."""
    levels = [naive.block_squares(scores, 2**k, 1.0) for k in range(5)]
    upper = np.triu_indices(scores.shape[1])
    return SimpleNamespace(
        direction=[0.0] * scores.shape[1],
        square=np.array([square[upper] for square, _ in levels]),
        blocks=[count for _, count in levels],
    )


def sandwich(scores, direction):
    """Variance of the sum of scores along a direction: the worst level with enough blocks."""
    largest = 0.0
    for k in range(5):
        square, count = naive.block_squares(scores, 2**k, 1.0)
        if count >= blocks.ENOUGH:
            value = direction @ square @ direction * blocks.correction(count)
            largest = max(largest, value)
    return largest


def expected_weights(case, variance):
    """The rule of the module's docstring, from batch quantities: weights and what they lose."""
    p, first = len(case.zeta), case.params.first
    weight, lost2 = np.ones(p), np.zeros(p)
    line2, threshold = (shrink.LARGEST * case.zeta[first - 1]) ** 2, shrink.FIRST
    for m in range(first, p):
        # A unit of each score moves the last coefficient of model m by a column of its covariance.
        V = max(variance * case.d[m], sandwich(case.scores, case.covariances[m][:, m]))
        z2 = case.zeta[m] ** 2
        believed = 1.0 / (1.0 + (threshold * V / z2) ** 3)
        after = believed * shrink.NEXT + (1.0 - believed) * shrink.STEEPER * threshold
        threshold = min(shrink.STEEPEST, after)
        weight[m] = believed * line2 / (line2 + V)
        lost2[m] = (1.0 - weight[m]) ** 2 * max(0.0, z2 - V)
    return weight, lost2


SIZES = st.integers(2, 6).flatmap(lambda p: st.tuples(st.just(p), st.integers(1, p - 1)))


@given(st.integers(0, 2**32 - 1), SIZES, st.integers(0, 6), st.floats(1e-6, 10.0))
def test_weights_and_coefficients_are_those_of_the_nested_models(seed, sizes, at, variance):
    p, first = sizes
    case = problem(seed, p=p, first=first, at=at)
    shrink.weigh(case.params, case.state, case.solver, variance, case.sums, at)
    weight, lost2 = expected_weights(case, variance)
    # The batch inverts matrices of condition up to some 1e6: ten digits are left of sixteen.
    size = np.abs(case.models).max()
    np.testing.assert_allclose(case.state.zeta[first:], case.zeta[first:], atol=1e-9 * size)
    np.testing.assert_allclose(case.state.weight, weight, atol=1e-7)
    np.testing.assert_allclose(case.state.lost2, lost2, atol=1e-7 * size**2)
    np.testing.assert_allclose(
        case.state.alpha, naive.weighted(weight, case.models), atol=1e-7 * size
    )


@given(st.integers(0, 2**32 - 1), SIZES)
def test_diagonal_of_the_factor_is_the_variance_of_the_nested_coefficient(seed, sizes):
    case = problem(seed, p=sizes[0], first=sizes[1])
    np.testing.assert_allclose(case.solver.d, case.d, rtol=1e-8)  # of an inverse, as above
    for m, P in enumerate(case.covariances):
        column = np.array(case.solver.U)[: m + 1, m] * case.solver.d[m]
        np.testing.assert_allclose(column, P[: m + 1, m], rtol=0.0, atol=1e-8 * np.abs(P).max())


@given(st.integers(0, 2**32 - 1), SIZES, st.data())
def test_spread_and_multiply_are_dense_algebra(seed, sizes, data):
    p, first = sizes
    case = problem(seed, p=p, first=first)
    weight = np.ones(p)
    weight[first:] = data.draw(
        st.lists(st.floats(0.0, 1.0), min_size=p - first, max_size=p - first)
    )
    case.state.weight[:] = weight.tolist()
    lost2 = np.random.default_rng(seed).uniform(0.0, 2.0, p)
    case.state.lost2[:] = lost2.tolist()
    c = np.random.default_rng([seed, 1]).standard_normal(p)
    P = naive.weighted(weight, case.covariances)
    scale = np.abs(case.covariances).max() * (c @ c)
    found = shrink.spread(case.state, case.solver, c.tolist(), 0)
    assert found == pytest.approx(c @ P @ c, rel=1e-8, abs=1e-10 * scale)
    # What is lost of zeta_m is lost along the column of U that carries it.
    columns = [case.covariances[m][:, m] / case.d[m] for m in range(p)]
    bias2 = sum(lost2[m] * (c @ columns[m]) ** 2 for m in range(p))
    assert case.state.bias2 == pytest.approx(bias2, rel=1e-7)
    out = [0.0] * p
    case.state.bias2 = 0.0
    shrink.multiply(case.state, case.solver, c.tolist(), out)
    assert case.state.bias2 == pytest.approx(bias2, rel=1e-7)
    np.testing.assert_allclose(out, P @ c, rtol=0.0, atol=1e-10 * scale)


def test_full_weight_is_least_squares():
    case = problem(1, p=5, first=1)
    case.state.weight[:] = [1.0] * 5
    shrink.apply(case.state, case.solver)
    size = np.abs(case.models).max()
    np.testing.assert_allclose(case.state.alpha, case.solver.alpha, rtol=0.0, atol=1e-14 * size)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_no_weight_from_a_column_on_is_the_batch_solution_without_it(m):
    case = problem(2, p=5, first=2)
    case.state.weight[:] = [1.0] * m + [0.0] * (5 - m)
    shrink.apply(case.state, case.solver)
    size = np.abs(case.models).max()
    np.testing.assert_allclose(case.state.alpha, case.models[m - 1], atol=1e-10 * size)
    assert np.abs(np.array(case.solver.alpha)[:m] - case.models[m - 1][:m]).max() > 1e-3  # not cut


def test_before_the_first_evaluation_high_orders_are_left_out():
    case = problem(3, p=5, first=3)
    shrink.apply(case.state, case.solver)
    assert case.state.weight == [1.0, 1.0, 1.0, 0.0, 0.0]
    np.testing.assert_allclose(case.state.alpha, case.models[2], atol=1e-10)  # of order 1


def apart(alpha):
    """Columns that do not know of each other, each coefficient of variance 1: zeta is alpha."""
    p = len(alpha)
    solver = SimpleNamespace(alpha=list(alpha), U=np.eye(p), d=[1.0] * p)
    state = plain(record(shrink.ShrinkState, {"p": p}))
    scores = np.random.default_rng(7).standard_normal((32, p))
    scores /= [np.sqrt(sandwich(scores, unit)) for unit in np.eye(p)]
    return state, solver, packed(scores)


@pytest.mark.parametrize(("ratio", "kept"), [(1.0, 0.5), (100.0, 1.0), (0.01, 0.0)])
def test_a_coefficient_at_its_threshold_is_half_believed(ratio, kept):
    line = 30.0
    state, solver, sums = apart([line, np.sqrt(ratio * shrink.FIRST)])
    shrink.weigh(SimpleNamespace(first=1), state, solver, 0.0, sums, 0)
    line2 = (shrink.LARGEST * line) ** 2
    # A hundredth and a hundred cubed are what 1 and 0 are short of.
    assert state.weight[1] == pytest.approx(kept * line2 / (line2 + 1.0), abs=1.1e-6)


@pytest.mark.parametrize("before", [1e4, 1e-4])
def test_an_order_after_those_left_out_has_to_be_surer(before):
    limit, last = shrink.FIRST, 0.0
    for m in range(1, 6):
        state, solver, sums = apart([1e6] + [before] * (m - 1) + [np.sqrt(limit)] + [0.0] * 3)
        shrink.weigh(SimpleNamespace(first=1), state, solver, 0.0, sums, 0)
        # 1e-8 of belief in those before, times the thresholds' ratio of some 10, cubed.
        assert state.weight[m] == pytest.approx(0.5, rel=1e-6)
        assert limit >= last
        last = limit
        # All before are there: the same for every order. None is: ever more, up to a bound.
        steeper = min(shrink.STEEPEST, shrink.STEEPER * limit)
        limit = shrink.NEXT if before > 1.0 else steeper
    assert limit == (shrink.NEXT if before > 1.0 else shrink.STEEPEST)


def test_an_order_much_larger_than_the_line_is_not_expected():
    # A line that is not known from 0, and a second order that is known no better.
    state, solver, sums = apart([0.1, 50.0])
    shrink.weigh(SimpleNamespace(first=1), state, solver, 0.0, sums, 0)
    assert state.weight[1] < (shrink.LARGEST * 0.1) ** 2
    state, solver, sums = apart([50.0, 50.0])
    shrink.weigh(SimpleNamespace(first=1), state, solver, 0.0, sums, 0)
    assert state.weight[1] > 0.999


def test_residuals_vary_no_less_than_the_rows_noise():
    # Scores of variance 1; rows whose noise says 4 are believed instead, those of 1/4 are not.
    for variance, V in ((4.0, 4.0), (0.25, 1.0)):
        state, solver, sums = apart([1e6, np.sqrt(V * shrink.FIRST)])
        shrink.weigh(SimpleNamespace(first=1), state, solver, variance, sums, 0)
        assert state.weight[1] == pytest.approx(0.5, rel=1e-6)


def test_nothing_known_and_nothing_unknown():
    case = problem(5, p=3, first=2)
    square = case.sums.square.copy()
    case.sums.square[:] = 0.0
    shrink.weigh(case.params, case.state, case.solver, 0.0, case.sums, 0)
    assert case.state.weight[2] == 1.0  # no noise: least squares
    assert case.state.lost2[2] == 0.0
    case.sums.square[:] = square
    case.solver.alpha[2] = 0.0  # zeta of the last column
    shrink.weigh(case.params, case.state, case.solver, 0.0, case.sums, 0)
    assert case.state.weight[2] == 0.0
    assert case.state.lost2[2] == 0.0
