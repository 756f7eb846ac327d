"""Block sums against a naive recomputation, and what they say about coloured sums."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from rotatum.kernels import blocks
from tests import naive
from tests.kernels.make import plain, record

LEVELS = 9


def run(terms, *, v, shortest=4, fade=None, cuts=()):
    """Feed terms one by one; ``cuts`` are places where adjacency is lost."""
    n, t = terms.shape
    s = v * (v + 1) // 2 + t - v
    params = plain(record(blocks.BlockParams, {"L": LEVELS}, shortest=shortest))
    params.fade = params.fade_single = [1.0] * LEVELS
    if fade is not None:
        params.fade, params.fade_single = fade
    state = plain(record(blocks.BlockState, {"L": LEVELS, "t": t, "v": v, "s": s}))
    state.square, state.carry = np.zeros((LEVELS, s)), np.zeros((LEVELS, t))
    for k in range(n):
        if k in cuts:
            blocks.clear(state)
        for i in range(t):
            state.part[i] += float(terms[k, i])
        if blocks.count(params, state):
            blocks.close(params, state)
    return params, state


def triangle(square, v):
    """Undo the packing: the symmetric matrix of the first v terms."""
    full = np.zeros((v, v))
    full[np.triu_indices(v)] = square[: v * (v + 1) // 2]
    return full + np.triu(full, 1).T


def test_every_level_is_the_sum_over_blocks_of_its_length():
    terms = np.random.default_rng(40).standard_normal((1000, 5))
    fades = [0.9**k for k in range(LEVELS)], [0.8**k for k in range(LEVELS)]
    _, state = run(terms, v=3, fade=fades)
    for k in range(LEVELS):
        square, count = naive.block_squares(terms, 4 * 2**k, fades[0][k])
        single, singles = naive.block_squares(terms, 4 * 2**k, fades[1][k])
        # Rounding of sums of up to 1000 numbers of order 1, squared.
        np.testing.assert_allclose(triangle(state.square[k], 3), square[:3, :3], atol=1e-9)
        np.testing.assert_allclose(state.square[k][6:], np.diag(single)[3:], atol=1e-9)
        assert state.blocks[k] == pytest.approx(count, rel=1e-12)
        assert state.blocks_single[k] == pytest.approx(singles, rel=1e-12)
    assert state.closed == 250


def test_blocks_do_not_reach_across_a_cut():
    terms = np.random.default_rng(41).standard_normal((203, 1))
    _, state = run(terms, v=1, cuts=(98,))
    # 24 blocks of 4 and a rest of 2 that is dropped, then 26 of 4 and a rest of 1.
    assert state.closed == 50
    for k, counts in ((1, 12 + 13), (2, 6 + 6), (3, 3 + 3)):
        first, n1 = naive.block_squares(terms[:98], 4 * 2**k, 1.0)
        second, n2 = naive.block_squares(terms[98:], 4 * 2**k, 1.0)
        assert n1 + n2 == counts == state.blocks[k]
        assert state.square[k, 0] == pytest.approx((first + second)[0, 0], rel=1e-12)


def test_variance_along_a_direction_is_that_of_the_matrix():
    terms = np.random.default_rng(42).standard_normal((400, 4))
    _, state = run(terms, v=4)
    direction = [1.0, -2.0, 0.5, 3.0]
    for k in range(4):
        expected = direction @ triangle(state.square[k], 4) @ direction
        assert blocks.variance_along(state, k, 0, direction) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("at", [0, 1, 2, 3])
def test_a_direction_may_begin_anywhere(at):
    # Two transmissions share a vector: the first one's scores at 0, the second one's behind them.
    terms = np.random.default_rng(45).standard_normal((400, 6))
    _, state = run(terms, v=5)
    direction = [1.5, -0.5]
    for k in range(4):
        part = triangle(state.square[k], 5)[at : at + 2, at : at + 2]
        expected = np.array(direction) @ part @ direction
        assert blocks.variance_along(state, k, at, direction) == pytest.approx(expected, rel=1e-12)
    largest = max(
        blocks.variance_along(state, k, at, direction) * blocks.correction(state.blocks[k])
        for k in range(LEVELS)
        if state.blocks[k] >= blocks.ENOUGH
    )
    assert blocks.worst(state, at, direction) == largest


@pytest.mark.parametrize("a", [0.0, 0.5, 0.9])
def test_long_run_variance_of_coloured_noise(a):
    # The sum of n terms of an AR(1) varies with n / (1 - a)^2, not with n times their variance.
    n = 16_384
    x = naive.autoregressive(np.random.default_rng(43), n, a)[:, None]
    _, state = run(x, v=1)
    found = blocks.worst(state, 0, [1.0]) / n
    true = 1.0 / (1.0 - a) ** 2
    short = float((x * x).mean())
    # The largest of several chi-square means: the longest trusted level, 1024 terms, has 16
    # blocks (std 35 %) and its correction 1.2; below the truth by less than 20 %, since the
    # blocks of 256 (64 of them, std 18 %) are already as good as independent.
    assert 0.8 * true < found < 2.5 * true
    if a > 0.0:
        assert short < 0.8 * 0.8 * true  # and the naive one is off by more than that


def test_too_few_blocks_are_not_believed():
    x = np.ones((27, 2))
    _, state = run(x, v=1)
    assert state.blocks[0] == 6  # below ENOUGH
    assert blocks.worst(state, 0, [1.0]) == 0.0
    assert blocks.worst_term(state, 1) == 0.0
    _, state = run(np.ones((32, 2)), v=1)
    assert blocks.worst(state, 0, [1.0]) == pytest.approx(8 * 16.0 * blocks.correction(8.0))
    assert blocks.worst_term(state, 1) == 8 * 16.0


@pytest.mark.parametrize("v", [1, 2, 3])
def test_single_terms_are_found_behind_the_triangle(v):
    terms = np.random.default_rng(44).standard_normal((32, v + 2))
    _, state = run(terms, v=v)
    for i in (v, v + 1):
        expected, _ = naive.block_squares(terms[:, i : i + 1], 4, 1.0)
        assert blocks.worst_term(state, i) == pytest.approx(expected[0, 0], rel=1e-12)


@pytest.mark.parametrize("n", [8, 12, 30, 100, 1000])
def test_correction_is_student_for_normal(n):
    exact = (stats.t.ppf(0.975, n - 1) / stats.norm.ppf(0.975)) ** 2 * n / (n - 1)
    # The documented accuracy is 2 % of t, so 4 % of its square.
    assert blocks.correction(float(n)) == pytest.approx(exact, rel=0.04)
