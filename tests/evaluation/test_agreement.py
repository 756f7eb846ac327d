"""Scores of a comparison against numbers written out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.evaluation.agreement import Curve, disagreement, score, start_of


def curve(
    values: list[float], std: float = 1.0, every: int = 1, truth: float | None = None
) -> Curve:
    stiffness = np.array(values)
    known = None if truth is None else np.full(len(values), truth)
    time = 0.1 * every * np.arange(len(values))
    return Curve(time, stiffness, np.full(len(values), std), known, every)


def test_all_are_scored_from_when_the_last_has_converged() -> None:
    assert start_of([2.0, None, 7.5], 20.0) == 7.5
    assert start_of([None, None], 20.0) == 10.0, "the last half where none converges"


def test_truth_is_scored_from_the_start_on() -> None:
    found = score(curve([0.0, 99.0, 101.0, 104.0], truth=100.0), start=0.1)
    assert found is not None
    assert found["mse"] == pytest.approx((1.0 + 1.0 + 16.0) / 3.0)
    assert found["msrep_percent"] == pytest.approx(100.0 * (1e-4 + 1e-4 + 16e-4) / 3.0)
    # 1.96 std holds errors of 1, not of 4
    assert found["coverage_percent"] == pytest.approx(200.0 / 3.0)
    assert score(curve([1.0, 2.0]), start=0.0) is None, "no truth, no score"


def test_two_methods_differ_by_the_rms_of_their_ratio() -> None:
    found = disagreement(curve([103.0, 102.0, 96.0]), curve([100.0, 100.0, 100.0]), start=0.05)
    assert found is not None
    assert found["rms_percent"] == pytest.approx(np.sqrt((2.0**2 + 4.0**2) / 2.0))
    # together 1.96 sqrt(2) = 2.77: a difference of 2 is within, one of 4 is not
    assert found["within_percent"] == pytest.approx(50.0)


def test_samples_that_rest_on_the_prior_are_not_compared() -> None:
    nothing = curve([np.nan, np.nan])
    assert disagreement(nothing, curve([1.0, 1.0]), start=0.0) is None
    found = disagreement(curve([np.nan, 110.0]), curve([100.0, 100.0]), start=0.0)
    assert found is not None
    assert found["rms_percent"] == pytest.approx(10.0)


def test_a_thinned_curve_is_compared_at_the_same_samples() -> None:
    full, half = curve([1.0, 50.0, 2.0, 50.0]), curve([1.0, 2.0], every=2)
    found = disagreement(full, half, start=0.0)
    assert found is not None
    assert found["rms_percent"] == 0.0
    other = disagreement(half, full, start=0.0)
    assert other == found
