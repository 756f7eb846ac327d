"""The step of an observer against matrices written out in numpy."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.observers.decoupled import exact_observer
from rotatum.estimators.observers.finite import finite_observer
from rotatum.estimators.observers.jerk import jerk_observer
from rotatum.estimators.observers.stage import (
    observer_params,
    observer_stage,
    unknown_input_stage,
)
from rotatum.estimators.observers.triple import printed_observer, triple_integrator
from rotatum.kernels.status import NOT_FINITE, RESTARTED, SETTLING
from rotatum.runtime.bank import Bank
from tests.estimators.observed import redundant, simulate


def bank(recursion, inputs):
    stage = observer_stage(recursion, inputs)
    return Bank(stage, observer_params(stage, recursion), compile=False)


def samples(b, y):
    u = b.stage.input.zeros(len(y), 1)
    u["y"][:, 0] = np.reshape(y, (len(y), -1))
    return u


RECURSIONS = {
    "placed": (lambda: exact_observer(redundant(), 1, [0.1, 0.2, 0.3, 0.4]).recursion, 2),
    "finite": (lambda: finite_observer(redundant(), 3, 1.0), 2),
    "jerk": (lambda: jerk_observer(5e-3, bandwidth=100.0, lag=4).recursion, 1),
    "deadbeat jerk": (lambda: jerk_observer(5e-3, bandwidth=None).recursion, 1),
}


@pytest.mark.parametrize("name", RECURSIONS)
def test_the_step_is_the_recursion(name):
    make, inputs = RECURSIONS[name]
    recursion = make()
    y = np.random.default_rng(1).standard_normal((60, recursion.channels))
    b = bank(recursion, inputs)
    out = b.run(samples(b, y))[:, 0]
    wanted = recursion.run(y)
    found = np.hstack([out["x"], out["u"]])[recursion.window - 1 :]
    size = np.abs(wanted).max(axis=0)
    np.testing.assert_allclose(found / size, wanted / size, rtol=0.0, atol=1e-12)  # rounding
    assert out["valid"].tolist() == [0] * (recursion.window - 1) + [1] * len(wanted)


def test_it_finds_state_and_input_of_the_delayed_instant():
    given, L = redundant(), 2
    u = 10.0 * np.random.default_rng(3).standard_normal((80, 2))
    x, y = simulate(given, u, x0=1.0)
    b = bank(exact_observer(given, L).recursion, 2)
    out = b.run(samples(b, y))[:, 0]
    good = np.flatnonzero(out["settled"])
    assert good[0] <= L + given.sizes[0]
    np.testing.assert_allclose(out["x"][good], x[good - L], atol=1e-10 * np.abs(x).max())
    np.testing.assert_allclose(out["u"][good], u[good - L], atol=1e-10 * np.abs(x).max())


def test_fresh_starts_anew_and_a_bad_sample_changes_nothing():
    recursion = printed_observer(5e-3).recursion
    y = np.random.default_rng(4).standard_normal(40)
    b = bank(recursion, 1)
    u = samples(b, y)
    u["fresh"][20] = 1
    out = b.run(u)[:, 0]
    assert out["status"][20] == RESTARTED | SETTLING
    assert out["valid"][20:24].tolist() == [0, 0, 0, 1]
    b.reset()
    again = b.run(u[20:])[:, 0]
    assert out["u"][23:].tolist() == again["u"][3:].tolist()
    # Until then the estimate of before is held.
    assert out["u"][20:23, 0].tolist() == [out["u"][19, 0]] * 3

    holes = np.insert(u, 10, u[10], axis=0)
    for bad in (np.nan, np.inf, 1e13):
        holes["y"][10] = bad
        b.reset()
        held = b.run(holes)[:, 0]
        assert held["status"][10] == NOT_FINITE
        assert held["valid"][10] == 0
        assert held["u"][10, 0] == held["u"][9, 0]
        assert np.delete(held["u"][:, 0], 10).tolist() == out["u"][:, 0].tolist()


def test_settled_waits_for_the_poles():
    given = triple_integrator(5e-3)
    recursion = exact_observer(given, 3, [0.5, 0.55, 0.6]).recursion
    b = bank(recursion, 1)
    y = 1.0 + 0.3 * np.arange(80.0)  # starts in motion; the observer, at rest
    out = b.run(samples(b, y))[:, 0]
    settled = int(np.flatnonzero(out["settled"])[0])
    # 0.6^27 = 1e-6, plus what unequal units of the states add.
    assert 3 + 20 <= settled <= 3 + 40
    error = np.abs(out["x"][:, 1] - 0.3 / 5e-3)
    assert error[3] == pytest.approx(0.3 / 5e-3)
    assert error[settled] < 1e-5 * error[3]
    assert error[settled - 10] > 1e-5 * error[3]


@pytest.mark.parametrize("sizes", [(3, 1, 1, 2), (4, 1, 1, 3)])
def test_a_design_of_another_size_is_refused(sizes):
    with pytest.raises(MethodError, match="does not fit the stage"):
        observer_params(unknown_input_stage(*sizes), printed_observer(5e-3).recursion)


def test_room_for_a_longer_window_changes_nothing():
    recursion = exact_observer(triple_integrator(5e-3), 3, [0.5, 0.55, 0.6]).recursion
    tight = bank(recursion, 1)
    stage = unknown_input_stage(3, 1, 1, 3, window=9)
    wide = Bank(stage, observer_params(stage, recursion), compile=False)
    y = np.random.default_rng(61).standard_normal(60)
    u = samples(tight, y)
    u["fresh"][30] = 1
    one, other = tight.run(u), wide.run(u)
    for field in ("x", "u", "valid", "settled", "status"):
        np.testing.assert_array_equal(one[field], other[field])
