"""The observer's stage: constants from a device, and what its guard does to lost samples."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.full_state.drivetrain import drivetrain_of
from rotatum.estimators.full_state.poles import Pair
from rotatum.estimators.full_state.stage import design_of, luenberger_params, luenberger_stage
from rotatum.kernels.status import BRIDGED, GAP, NOT_FINITE, RESTARTED, SETTLING
from rotatum.models import load_device
from rotatum.models.channel import Channel
from rotatum.runtime import Bank

T = 1e-3


@pytest.fixture(scope="module")
def axis():
    return load_device("manutec-r3").joints[0]


def test_constants_are_the_joint_s_reflected_to_it(axis):
    found = drivetrain_of(axis)
    expected = (1.3e-3 * 105.0**2, 474075.0, 55.125, 0.0008125 * 105.0**2, 0.4 * 105.0)
    np.testing.assert_allclose(found, expected, rtol=1e-14)  # a few products
    assert drivetrain_of(axis, 1e5).stiffness == 1e5


def test_torque_is_sampled_unless_the_device_says_otherwise(axis):
    assert not design_of(axis, T).held
    assert design_of(axis, T, held=True).held
    commanded = axis.model_copy(update={"channels": {"tau": Channel(hold="held")}})
    assert design_of(commanded, T).held
    assert not design_of(commanded, T, held=False).held


def test_a_joint_with_two_transmissions_is_refused():
    with pytest.raises(MethodError, match=r"vsa-ii.*one motor and one transmission.*antagonistic"):
        design_of(load_device("vsa-ii").joints[0], T)


def test_a_set_point_is_taken_from_the_middle_of_its_range_or_asked_for():
    """Of the lever arm, 60 to 120 mm: ``2 k r^2`` (flacco2012 eq. 50)."""
    joint = load_device("awas").joints[0]
    # the same products in another order
    assert drivetrain_of(joint).stiffness == pytest.approx(2.0 * 14220.0 * 0.09**2, rel=1e-14)
    basis = joint.basis.model_copy(update={"setpoint_range": None})
    with pytest.raises(MethodError, match=r"awas: the observer needs a stiffness.*setpoint_range"):
        drivetrain_of(joint.model_copy(update={"basis": basis}))


def test_a_joint_without_motor_is_refused():
    joint = load_device("series-demo").joints[0].model_copy(update={"motors": ()})
    with pytest.raises(MethodError, match="motor's inertia"):
        drivetrain_of(joint)


def test_poles_too_fast_are_refused_before_anything_runs(axis):
    with pytest.raises(MethodError, match="too fast"):
        design_of(axis, T, (Pair(4000.0, 0.8), Pair()))


def test_params_that_do_not_fit_are_refused(axis):
    stage, design = luenberger_stage(), design_of(axis, T)
    with pytest.raises(MethodError, match="every joint"):
        luenberger_params(stage, [axis], [design, design])
    with pytest.raises(MethodError, match="change"):
        luenberger_params(stage, [axis], [design], change=-0.1)


def swinging(stage, n=70):
    """A straight line in every channel: what the guard fills in is then what was lost."""
    t = T * np.arange(n)
    u = stage.input.zeros(n, 1)
    u["time"][:, 0], u["theta"][:, 0] = t, 0.3 + 2.0 * t
    u["acceleration"][:, 0], u["torque"][:, 0] = 1.0 - 5.0 * t, 30.0 + 100.0 * t
    u["seen"] = 1
    return u


def observed(axis, u):
    stage = luenberger_stage()
    params = luenberger_params(stage, [axis], [design_of(axis, T)])
    return Bank(stage, params, compile=False).run(u)[:, 0]


def test_a_few_lost_samples_are_bridged_and_leave_no_trace(axis):
    u = swinging(luenberger_stage())
    clean = observed(axis, u)
    u["theta"][40:44] = np.nan
    found = observed(axis, u)
    assert set(found["status"][40:44]) == {NOT_FINITE | SETTLING}
    np.testing.assert_array_equal(found["q_hat"][40:44], np.repeat(found["q_hat"][39], 4))
    assert found["status"][44] & BRIDGED
    for name in ("theta_hat", "q_hat", "dtheta_hat", "dq_hat"):
        # The line through the ends instead of the samples on it: rounding, times 1 / T at most.
        np.testing.assert_allclose(found[name][44:], clean[name][44:], rtol=0.0, atol=1e-10)


def test_a_gap_starts_again_at_rest(axis):
    u = swinging(luenberger_stage())
    u["time"][40:] += 1.0
    found = observed(axis, u)
    assert found["status"][40] == GAP | RESTARTED | SETTLING
    assert (found["dtheta_hat"][40], found["dq_hat"][40]) == (0.0, 0.0)
    assert found["theta_hat"][40] == u["theta"][40, 0]
    assert np.all(np.isfinite(found["dq_hat"]))
