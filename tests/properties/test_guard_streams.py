"""Any stream of floats whatever: the guard never raises, never hands on what is not finite."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rotatum.kernels import guard
from rotatum.kernels.status import REJECTED
from tests.kernels.make import record

T = 1e-3
WILD = st.floats(allow_nan=True, allow_infinity=True, width=64)
CLOCK = st.one_of(st.integers(-20, 40).map(lambda k: k * T), st.floats(-1.0, 1.0), WILD)
STREAM = st.lists(st.tuples(CLOCK, WILD, WILD), max_size=40)
LIMITS = st.sampled_from([0.0, 1e-3, 1.0, 2.0 * math.pi, 1e6])


def watch(jump=0.0, wrap=0.0, limit=0.0):
    settings = {"jump": jump, "wrap": wrap, "limit": limit}
    params = record(guard.GuardParams, {"c": 2}, period=T, missing=8, **settings)
    state = record(guard.GuardState, {"c": 2})
    guard.init(params, state)
    return params, state


def feed(params, state, time, *now):
    """Everything a sample leads to: the samples handed on."""
    state.now[:] = now
    handed = []
    with np.errstate(all="ignore"):
        steps = guard.plan(params, state, time)
        for k in range(steps):
            guard.fill(params, state, time, k, steps)
            handed.append((float(state.mix_time), *state.mix.tolist()))
        if steps:
            guard.finish(params, state, time)
    return handed


@given(STREAM, LIMITS, LIMITS, LIMITS)
def test_every_sample_is_accepted_or_refused_for_one_reason(stream, jump, wrap, limit):
    params, state = watch(jump, wrap, limit)
    for sample in stream:
        handed = feed(params, state, *map(np.float64, sample))
        refused = int(state.status) & REJECTED
        assert bool(handed) != bool(refused)
        assert refused & (refused - 1) == 0
        assert len(handed) <= params.missing + 1
    refused = state.not_finite + state.repeated + state.backwards + state.saturated
    assert state.accepted + refused == len(stream)


@given(STREAM, LIMITS, LIMITS)
def test_what_is_handed_on_and_remembered_is_finite(stream, jump, wrap):
    params, state = watch(jump, wrap)
    for sample in stream:
        handed = feed(params, state, *map(np.float64, sample))
        assert np.isfinite(handed).all()
        assert np.isfinite(state.last).all()
        assert np.isfinite(state.time)


@given(STREAM)
def test_a_good_stream_afterwards_is_taken_up_again(stream):
    params, state = watch(jump=0.5)
    for sample in stream:
        feed(params, state, *map(np.float64, sample))
    # Wherever the clock was left: PATIENCE samples from before it, and a new one is believed.
    taken = [bool(feed(params, state, k * T, 0.0, 0.0)) for k in range(60)]
    assert all(taken[40:])


@given(st.lists(st.floats(-0.49, 0.49), min_size=1, max_size=60), st.floats(0.1, 100.0))
def test_unwrapping_undoes_wrapping(moves, turn):
    params, state = watch(wrap=turn)
    true = np.cumsum(moves) * turn
    start = None
    for k, angle in enumerate(true):
        (handed,) = feed(params, state, k * T, math.fmod(angle, turn), 0.0)
        start = handed[1] - angle if start is None else start
        # Rounding of up to 60 turns.
        assert math.isclose(handed[1] - angle, start, abs_tol=1e-12 * turn * 60)
