"""The scores against the formulas written out, and piece by piece against all at once."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.evaluation import TruthScore, coverage_percent, mse, msrep_percent


@pytest.fixture
def estimate():
    rng = np.random.default_rng(7)
    truth = 200.0 + 50.0 * rng.random(500)
    std = 1.0 + rng.random(500)
    return truth + std * rng.standard_normal(500), std, truth


def test_scores_equal_the_formulas(estimate):
    sigma, std, truth = estimate
    n = len(sigma)
    squares = sum((t - s) ** 2 for s, t in zip(sigma, truth, strict=True))
    relative = sum(((t - s) / t) ** 2 for s, t in zip(sigma, truth, strict=True))
    inside = sum(abs(t - s) <= 1.96 * d for s, d, t in zip(sigma, std, truth, strict=True))
    # 1e-12: the two sums add the same 500 terms in another order
    assert mse(sigma, truth) == pytest.approx(squares / n, rel=1e-12)
    assert msrep_percent(sigma, truth) == pytest.approx(100 * relative / n, rel=1e-12)
    assert coverage_percent(sigma, std, truth) == pytest.approx(100.0 * inside / n, rel=1e-15)


def test_one_per_cent_off_is_msrep_of_a_hundredth():
    assert msrep_percent([101.0, 99.0], [100.0, 100.0]) == pytest.approx(0.01, rel=1e-12)


def test_gaussian_errors_are_covered_at_the_level_of_z():
    rng = np.random.default_rng(0)
    error = rng.standard_normal(40_000)
    # three standard deviations of a share of 40,000 draws: 0.33 % at 95 %, 0.70 % at 68.3 %
    assert coverage_percent(error, 1.0, 0.0) == pytest.approx(95.0, abs=0.33)
    assert coverage_percent(error, 1.0, 0.0, z=1.0) == pytest.approx(68.27, abs=0.70)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("column", ["sigma", "truth"])
def test_samples_without_a_number_do_not_count(estimate, column, bad):
    sigma, std, truth = estimate
    expected = _scores(sigma[10:], std[10:], truth[10:])
    columns = {"sigma": sigma.copy(), "truth": truth.copy()}
    columns[column][:10] = bad
    assert _scores(columns["sigma"], std, columns["truth"]) == pytest.approx(expected, rel=1e-12)


def test_a_missing_std_leaves_only_the_coverage():
    std = np.array([math.nan, 1.0, math.inf])
    sigma, truth = np.array([1.0, 1.0, 9.0]), np.array([2.0, 4.0, 2.0])
    # the second is three deviations off, the third admits to know nothing
    assert coverage_percent(sigma, std, truth) == 50.0
    assert mse(sigma, truth) == pytest.approx((1 + 9 + 49) / 3, rel=1e-15)


def test_a_truth_of_zero_has_no_relative_error():
    assert msrep_percent([1.0, 1.1], [0.0, 1.0]) == pytest.approx(1.0, rel=1e-12)
    assert math.isnan(msrep_percent([1.0], [0.0]))


def test_nothing_to_score_is_nan():
    assert all(math.isnan(value) for value in TruthScore().result().values())
    assert math.isnan(mse([], []))


def test_lengths_that_differ_are_refused():
    with pytest.raises(ValueError, match="shape"):
        mse([1.0, 2.0, 3.0], [1.0, 2.0])


@given(st.lists(st.integers(0, 500), max_size=6), st.floats(0.5, 3.0))
def test_pieces_add_up_to_the_whole(cuts, z):
    rng = np.random.default_rng(3)
    truth = rng.normal(100.0, 5.0, 500)
    sigma, std = truth + rng.standard_normal(500), rng.random(500)
    sigma[::17], std[::23] = np.nan, np.nan
    whole, pieces = TruthScore(z), TruthScore(z)
    whole.update(sigma, std, truth)
    edges = [0, *sorted(cuts), 500]
    for a, b in itertools.pairwise(edges):
        pieces.update(sigma[a:b], std[a:b], truth[a:b])
    # 1e-12: the same terms, added in other groups
    assert pieces.result() == pytest.approx(whole.result(), rel=1e-12)


def test_memory_does_not_grow_with_the_log():
    score = TruthScore()
    score.update(np.ones(1000), np.ones(1000), np.ones(1000))
    assert not any(isinstance(value, np.ndarray) for value in vars(score).values())


def _scores(sigma, std, truth):
    return (mse(sigma, truth), msrep_percent(sigma, truth), coverage_percent(sigma, std, truth))
