"""The exponential operator against scipy, a twin, and what a restart may not remember."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from rotatum.estimators.operators import EXPONENTIAL, Operator
from rotatum.kernels import cascade
from tests import naive
from tests.kernels.make import plain, record

T = 1e-3


class Cascade:
    """The kernel on c terms side by side."""

    def __init__(self, terms=1, *, cutoff=300.0, order=2, settle=0):
        pole = math.exp(-cutoff * T)
        self.params = plain(record(cascade.CascadeParams, pole=pole, order=order, settle=settle))
        self.state = plain(record(cascade.CascadeState, {"c": terms}))
        cascade.init(self.params, self.state)

    def push(self, x):
        """Values after each of (N, c) sets of terms."""
        found = []
        for row in np.atleast_2d(x).tolist():
            cascade.push(self.params, self.state, row)
            found.append(list(self.state.value))
        return np.array(found)


def noise(seed, n, terms=1):
    return np.random.default_rng(seed).standard_normal((n, terms))


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("cutoff", [3.0, 300.0, 3000.0])
def test_is_the_filter_of_scipy_from_its_steady_state(order, cutoff):
    a, x = math.exp(-cutoff * T), noise(200, 500)[:, 0]
    b, poles = (1.0 - a) ** order, np.poly([a] * order)
    start = signal.lfilter_zi([b], poles) * x[0]
    expected, _ = signal.lfilter([b], poles, x, zi=start)
    found = Cascade(order=order, cutoff=cutoff).push(x[:, None])[:, 0]
    # scipy multiplies the poles out: rounding of 1e-16 over (1 - a)^order = 3e-8 at 3 rad/s.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-15 / b + 1e-14)


@pytest.mark.parametrize("order", [2, 3])
def test_agrees_with_the_twin_pole_by_pole(order):
    x = noise(201, 300, 3)
    found = Cascade(3, order=order, cutoff=100.0).push(x)
    pole = math.exp(-100.0 * T)
    expected = np.stack([naive.poles(pole, column, order) for column in x.T], axis=1)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-14)  # rounding of order 1


@pytest.mark.parametrize("order", [2, 3])
def test_its_response_is_what_the_operator_says(order):
    impulse = np.zeros((400, 1))
    impulse[1] = 1.0  # not the first: what it starts from is a steady state
    found = Cascade(order=order, cutoff=200.0).push(impulse)[1:, 0]
    response = Operator(EXPONENTIAL, order, 200.0, T).response()
    n = min(len(found), len(response))
    np.testing.assert_allclose(found[:n], response[:n], rtol=0.0, atol=1e-15)  # rounding
    assert np.abs(found[n:]).max(initial=0.0) < 1e-9  # what it calls no longer of matter


@pytest.mark.parametrize("order", [2, 3])
def test_a_constant_stays_what_it_is_however_large(order):
    found = Cascade(order=order).push(np.full((50, 1), 1e6 / 3.0))
    assert set(found.ravel()) == {1e6 / 3.0}


def test_terms_side_by_side_do_not_see_each_other():
    x = noise(202, 100, 3) * [1.0, 1e9, 1e-9]
    together = Cascade(3, order=3).push(x)
    for i in range(3):
        assert together[:, i].tobytes() == Cascade(order=3).push(x[:, i : i + 1]).tobytes()


@pytest.mark.parametrize("order", [2, 3])
def test_a_restart_forgets_to_the_last_bit(order):
    x = noise(203, 80)
    one = Cascade(order=order, settle=10)
    one.push(x[:40])
    cascade.restart(one.params, one.state)
    assert (one.state.ready, one.state.settled) == (0, 0)
    assert one.push(x[40:]).tobytes() == Cascade(order=order).push(x[40:]).tobytes()


def test_settles_after_so_many_terms_and_every_one_is_a_row():
    one, seen = Cascade(settle=4), []
    for k in range(7):
        one.push(noise(204 + k, 1))
        seen.append((one.state.ready, one.state.settled))
    assert seen == [(1, 0)] * 4 + [(1, 1)] * 3


def test_without_new_terms_the_result_stands_and_is_no_row():
    one = Cascade(settle=0)
    before = one.push(noise(205, 5))[-1]
    cascade.idle(one.state)
    assert one.state.value == before.tolist()
    assert (one.state.ready, one.state.settled) == (0, 1)
