"""A stiffness that changes under the observer: what is proved to be stable, and what is not."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.drivetrain import Drivetrain
from rotatum.estimators.full_state.poles import DEFAULT, discretise
from rotatum.estimators.full_state.rescheduling import largest_relative_rate, rescaling
from tests.kernels.observing import Observer, to_w

T = 1e-3
RELAXATION = 1e-3  # s, more than any joint of the r3 arm has
JOINT = Drivetrain(inertia=14.33, stiffness=474e3, damping=100.0)


@lru_cache
def schedule():
    return largest_relative_rate(T, relaxation=RELAXATION)


def test_the_bound_of_the_default_poles():
    # A third of the poles' frequency: the stiffness may change by 8 % from sample to sample.
    assert 0.25 * 250.0 < schedule().rate < 0.4 * 250.0
    assert np.all(np.linalg.eigvalsh(schedule().lyapunov) > 0.0)


def test_at_nine_tenths_of_the_bound_the_error_of_the_kernel_falls_at_every_sample():
    plan, rng = schedule(), np.random.default_rng(420)
    n, design = 400, Design(JOINT, T)
    signs = np.where(np.arange(n) % 40 < 20, 1.0, -1.0)  # up and down by a factor 4
    signs[200:] = rng.choice([-1.0, 1.0], 200)  # and at random
    stiffness = JOINT.stiffness * np.exp(0.9 * plan.rate * T * np.cumsum(signs))
    assert (JOINT.damping / stiffness).max() < RELAXATION
    assert stiffness.max() / stiffness.min() > 3.0
    # Two observers that differ by an error: what drives them cancels.
    one, other = Observer(design), Observer(design)
    for observer in (one, other):
        observer.push(theta=0.2, stiffness=float(stiffness[0]))
    other.put(one_state(one) + np.array([1e-4, -1e-3, 0.3, -0.5]))
    values = []
    for k in range(1, 150):
        given = {"theta": 0.2 + 0.1 * math.sin(0.02 * k), "stiffness": float(stiffness[k])}
        error = other.push(**given) - one.push(**given)
        values.append(float(plan.value(to_w(design, float(stiffness[k])) @ error)))
    assert np.all(np.diff(values) < 0.0)
    assert values[-1] < 1e-6 * values[0]


def one_state(observer):
    return np.array([getattr(observer.out, f"{x}_hat") for x in ("theta", "q", "dtheta", "dq")])


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("relaxation", [0.0, 0.3 * RELAXATION, RELAXATION])
def test_v_falls_for_every_error_and_every_ratio_within(sign, relaxation):
    plan = schedule()
    scale = plan.unit ** np.arange(4)
    for part in (0.0, 0.5, 1.0):
        ratio = math.exp(sign * part * plan.rate * T)
        S = discretise(DEFAULT, T).transition @ rescaling(ratio, relaxation)
        S = S * scale / scale[:, None]
        P = plan.lyapunov
        left = P - S.T @ P @ S
        assert np.linalg.eigvalsh(left)[0] > -1e-9 * np.linalg.eigvalsh(P)[-1]  # 0 at the bound


def test_far_beyond_the_bound_a_stiffness_that_swings_can_undo_it():
    E = discretise(DEFAULT, T).transition

    def growth(rate, half):
        up, down = (E @ rescaling(math.exp(s * rate * T)) for s in (1.0, -1.0))
        cycle = np.linalg.matrix_power(up, half) @ np.linalg.matrix_power(down, half)
        return np.abs(np.linalg.eigvals(cycle)).max()

    # Up and down by exp(+-0.4) a sample, 40 ms each way: five times the bound.
    assert 4.0 * schedule().rate < 400.0 < 6.0 * schedule().rate
    assert growth(400.0, 40) > 1.0
    assert all(growth(0.9 * schedule().rate, half) < 1.0 for half in (5, 20, 40, 80))


def test_a_relaxation_below_zero_is_refused():
    with pytest.raises(MethodError, match="relaxation"):
        largest_relative_rate(T, relaxation=-1.0)
