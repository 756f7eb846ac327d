"""Relative rms error and correlation time, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.evaluation.statics.scores import relative_rms_percent
from rotatum.evaluation.statics.spread import correlation
from tests.evaluation.torque_sweeps import TICK


def test_correlation_time_of_a_filter() -> None:
    """White noise has 1; a first-order filter of pole p has (1 + p) / (1 - p)."""
    white = np.random.default_rng(3).standard_normal(40000)
    filtered = np.empty_like(white)
    last = 0.0
    for k, each in enumerate(white):
        last = 0.8 * last + each
        filtered[k] = last
    # Of 40000 samples; the sum over lags is a tenth noise.
    assert correlation(white) == pytest.approx(1.0, abs=0.1)
    assert correlation(filtered) == pytest.approx(9.0, rel=0.15)


@given(
    st.lists(st.floats(0.1, 10.0), min_size=1, max_size=20),
    st.floats(-0.5, 0.5),
    st.floats(0.01, 100.0),
)
def test_relative_error_has_no_unit(torque: list[float], share: float, unit: float) -> None:
    measured = np.array(torque)
    c = relative_rms_percent(measured, (1.0 + share) * measured)
    assert c == pytest.approx(100.0 * abs(share), abs=1e-9)
    again = relative_rms_percent(unit * measured, unit * (1.0 + share) * measured)
    assert again == pytest.approx(c, abs=1e-9)


def test_the_floor_leaves_out_what_has_no_relative_error() -> None:
    assert np.isnan(relative_rms_percent([0.0, TICK], [1.0, 1.0], floor=0.01))
    assert np.isfinite(relative_rms_percent([0.0, 1.0], [1.0, 1.0]))
