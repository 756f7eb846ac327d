"""The whole estimator on any stream of floats: it never raises, and good samples bring it back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotatum.estimators import Estimator
from rotatum.kernels.status import REJECTED
from rotatum.models import device_from_tables
from rotatum.runtime.bank import Bank
from rotatum.testing.compare import finite

T = 1e-3
WILD = st.floats(allow_nan=True, allow_infinity=True, width=64)
# What a broken sensor or a wrong unit may send.
LARGE = st.floats(-1e9, 1e9) | st.just(math.nan) | st.just(math.inf)
CLOCK = st.one_of(st.integers(-20, 60).map(lambda k: k * T), st.floats(-1.0, 1.0), WILD)


def stream(values):
    return st.lists(st.tuples(CLOCK, values, values, values), max_size=60)


@pytest.fixture(scope="module")
def bank():
    tables = {
        "name": "one",
        "motor": {"inertia": 0.3},
        "transmission": {"zero": 0.0},
        "estimator": {"method": "weak", "cutoff": 300.0, "fit": ["offset"]},
    }
    prepared = Estimator(device_from_tables(tables, "test"), period=T).prepared[0]
    return Bank(prepared.stage, prepared.params)


def feed(bank, samples):
    u = bank.stage.input.zeros(len(samples), 1)
    u["enable"] = 1
    for k, (time, q, theta, tau) in enumerate(samples):
        u[k, 0]["time"], u[k, 0]["q"], u[k, 0]["theta"], u[k, 0]["tau"] = time, q, theta, tau
    return bank.run(u)[:, 0]


def good(start, n=3000):
    """A joint of 150 N m/rad, moving."""
    t = np.arange(n) * T
    theta, phi = 0.3 * np.sin(9.0 * t), 0.02 * np.sin(14.0 * t + 0.3)
    tau = -0.3 * 0.3 * 81.0 * np.sin(9.0 * t) - 150.0 * phi
    return np.stack([start + t, theta + phi, theta, tau], axis=1).tolist()


@settings(max_examples=200)
@given(stream(WILD | LARGE))
def test_anything_goes_in_and_the_state_stays_finite(bank, samples):
    bank.reset()
    out = feed(bank, samples)
    counts = bank.state["guard"][0]
    refused = sum(counts[n] for n in ("not_finite", "repeated", "backwards", "saturated"))
    assert counts["accepted"] + refused == len(samples)
    assert (out["status"] & REJECTED != 0).sum() == refused
    assert finite(bank.state["inner"], bank.stage.state.fields["inner"].kind).all()
    for name in bank.stage.output.fields:
        assert name == "time" or np.isfinite(out[name]).all()
    assert (out["verdict"] == 0).all()  # 60 samples are no ground to claim anything


@settings(max_examples=25)
@given(stream(st.floats(-1.0, 1.0) | st.just(math.nan) | st.just(math.inf)))
def test_good_samples_afterwards_are_learnt_from(bank, samples):
    bank.reset()
    feed(bank, samples)
    known = bank.state["guard"]["time"][0] if bank.state["guard"]["started"][0] else 0.0
    out = feed(bank, good(min(known, 1e6) + 1.0 if known > -1e6 else 0.0))
    assert out["status"][-1] & REJECTED == 0
    # Whatever was learnt from up to 60 samples of order 1 is in the estimate; it may be off, but
    # then by no more than the interval owns up to, or the verdict does not call it informative.
    honest = abs(out["stiffness"][-1] - 150.0) < 5.0 * out["stiffness_std"][-1] + 7.5
    assert honest or out["verdict"][-1] != 2
