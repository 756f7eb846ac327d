"""Thinning keeps what a reader would look for."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rotatum.report.thin import buckets, thin, thin_band, thin_runs


@given(st.integers(0, 99_999), st.integers(100, 4000))
def test_a_single_spike_survives(place: int, points: int) -> None:
    x = np.arange(100_000.0)
    y = np.zeros(100_000)
    y[place] = 7.0
    kept_x, kept_y = thin(x, y, points)
    assert len(kept_x) <= points
    assert kept_y.max() == 7.0
    assert kept_x[kept_y.argmax()] == place
    assert np.all(np.diff(kept_x) > 0)


def test_a_short_curve_is_left_alone() -> None:
    x, y = np.arange(10.0), np.arange(10.0)
    assert thin(x, y, 10)[1] is y


def test_a_gap_stays_a_gap() -> None:
    y = np.ones(10_000)
    y[2000:4000] = np.nan
    kept_x, kept_y = thin(np.arange(10_000.0), y, 1000)
    inside = (kept_x > 2010) & (kept_x < 3990)
    assert inside.any()
    assert np.isnan(kept_y[inside]).all()
    assert np.isfinite(kept_y[~((kept_x >= 2000) & (kept_x < 4000))]).all()


def test_a_band_holds_what_it_held() -> None:
    rng = np.random.default_rng(1)
    middle = rng.normal(size=50_000)
    x, low, high = thin_band(np.arange(50_000.0), middle - 1.0, middle + 1.0, 500)
    assert len(x) <= 500
    assert low.min() == middle.min() - 1.0
    assert high.max() == middle.max() + 1.0


def test_runs_are_edges_and_levels() -> None:
    edges, levels = thin_runs(np.arange(6.0), np.array([0, 0, 1, 1, 1, 3]))
    assert edges.tolist() == [0.0, 2.0, 5.0, 5.0 + 1e-9]
    assert levels.tolist() == [0.0, 1.0, 3.0]


def test_many_runs_show_the_most_frequent_level() -> None:
    flicker = np.tile([2, 2, 3], 4000)
    edges, levels = thin_runs(np.arange(12_000.0), flicker, 100)
    assert len(levels) <= 100
    assert set(levels.tolist()) == {2.0}
    assert edges[0] == 0.0


@given(st.integers(1, 5000), st.integers(1, 5000))
def test_buckets_cover_everything_once(count: int, number: int) -> None:
    edges = buckets(count, number)
    assert len(edges) == min(count, number)
    assert edges[0][0] == 0
    assert edges[-1][1] == count
    assert all(a[1] == b[0] and a[0] < a[1] for a, b in pairwise(edges))
