"""The samples of a whole arm: one judgement for all joints, and velocities of the middle sample."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.armfront import arm_stage
from rotatum.kernels import arm
from rotatum.kernels.status import (
    BRIDGED,
    GAP,
    JUMP,
    NOT_FINITE,
    REPEATED,
    RESTARTED,
)
from tests.kernels.driven import T, drive
from tests.kernels.make import Sines

JOINTS = 3


def run(q, *, time=None, theta=None, theta2=None, setpoint=None, period=T, missing=8, jump=0.0):
    """What becomes of every sample of an arm; q is (N, JOINTS)."""
    stage = arm_stage(JOINTS)
    P = stage.params.zeros(1)[0]
    P["guard"]["period"] = P["arm"]["period"] = period
    P["guard"]["missing"] = missing
    P["guard"]["jump"][: 2 * JOINTS] = jump
    none = np.zeros_like(q)
    given = {"theta": theta, "theta2": theta2, "setpoint": setpoint}
    time = period * np.arange(len(q)) if time is None else time
    channels = {name: none if x is None else x for name, x in given.items()}
    return drive(stage, P, time=time, q=q, **channels)


def motion(seed, t):
    rng = np.random.default_rng(seed)
    joints = [Sines(rng, 1.0, 3.0, 40.0) for _ in range(JOINTS)]
    return [np.stack([s(t, n) for s in joints], axis=1) for n in (0, 1, 5)], joints


# --- velocity -------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [0, 1, 2, 3, 4])
def test_the_velocity_of_a_quartic_is_exact_and_belongs_to_two_samples_ago(degree):
    t = T * np.arange(40)
    coefficients = np.random.default_rng(degree).standard_normal((JOINTS, degree + 1))
    q, dq = (
        np.stack([np.polynomial.Polynomial(c).deriv(n)(t) for c in coefficients], axis=1)
        for n in (0, 1)
    )
    out = run(q)
    assert out["known"][:, 0].tolist() == [0] * 4 + [1] * 36
    assert np.array_equal(out["q_past"][4:, 0], q[2:-2])
    # Rounding of angles of order 1: 18 of them over 12 T, half an ulp each.
    np.testing.assert_allclose(out["dq_past"][4:, 0], dq[2:-2], rtol=0.0, atol=2e-13 / T)


def test_a_quintic_errs_by_the_fourth_order():
    for period in (0.02, 0.01):
        t = period * np.arange(9)
        out = run(np.stack([t**5] * JOINTS, axis=1), period=period)
        # T^4 / 30 times the fifth derivative, 120, exactly; late by that much less.
        error = 5.0 * t[2:-2] ** 4 - out["dq_past"][4:, 0, 0]
        np.testing.assert_allclose(error, 4.0 * period**4, rtol=1e-6)


def test_the_error_of_any_motion_is_bounded():
    t = T * np.arange(500)
    (q, dq, _), joints = motion(420, t)
    out = run(q)
    off = np.abs(out["dq_past"][4:, 0] - dq[2:-2]).max(axis=0)
    for error, joint in zip(off, joints, strict=True):
        assert error < T**4 / 30.0 * joint.bound(5) + 2e-13 / T
        assert error > T**4 / 30.0 * joint.bound(5) / 100.0  # and the bound is no empty one


def test_every_channel_is_handed_on():
    rng = np.random.default_rng(421)
    q, theta, theta2, setpoint = rng.standard_normal((4, 20, JOINTS))
    out = run(q, theta=theta, theta2=theta2, setpoint=setpoint)
    assert out["steps"].tolist() == [1] * 20
    for name, given in {"q": q, "theta": theta, "theta2": theta2, "setpoint": setpoint}.items():
        assert np.array_equal(out[name][:, 0], given)
    assert np.array_equal(out["time"][:, 0], T * np.arange(20))
    assert out["fresh"].tolist() == [1] + [0] * 19


# --- missing and bad samples ----------------------------------------------------------------------


def unrolled(out):
    """Samples and velocities in a row, filled-in ones among them."""
    return [
        (one["time"][k], one["q"][k], one["known"][k], one["dq_past"][k])
        for one in out
        for k in range(one["steps"])
    ]


def test_missing_samples_are_straight_lines_that_the_difference_goes_through():
    t = T * np.arange(60)
    (q, _, _), _ = motion(422, t)
    gone = np.r_[20:24, 40:41]
    kept = np.setdiff1d(np.arange(60), gone)
    out = run(q[kept], time=t[kept])
    steps = out["steps"]
    assert steps[kept == 24] == 5
    assert steps[kept == 41] == 2
    assert steps.sum() == 60
    assert (out["status"][steps > 1] == BRIDGED).all()
    filled = q.copy()
    for first, last in ((19, 24), (39, 41)):
        for k in range(first + 1, last):
            part = (k - first) / (last - first)
            filled[k] = q[first] + part * (q[last] - q[first])
    whole = run(filled)
    for k, (time, angle, known, velocity) in enumerate(unrolled(out)):
        assert time == pytest.approx(t[k], abs=1e-12)
        # Lines drawn twice: rounding of angles of order 1, and of those over T.
        np.testing.assert_allclose(angle, filled[k], rtol=0.0, atol=1e-15)
        assert known == whole["known"][k, 0]
        if known:
            np.testing.assert_allclose(velocity, whole["dq_past"][k, 0], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("channel", ["q", "theta", "theta2", "setpoint"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e13])
def test_one_bad_number_of_one_joint_is_a_bad_sample_of_the_arm(channel, value):
    t = T * np.arange(40)
    (q, _, _), _ = motion(423, t)
    channels = {"theta": q.copy(), "theta2": q.copy(), "setpoint": q.copy()}
    (q if channel == "q" else channels[channel])[20, 1] = value
    out = run(q, **channels)
    assert out["steps"][19:22].tolist() == [1, 0, 2]
    assert out["status"][20] == NOT_FINITE
    assert out["status"][21] == BRIDGED
    for name in ("q", "theta", "theta2", "setpoint", "q_past", "dq_past"):
        taken = [one[name][k] for one in out for k in range(one["steps"])]
        assert np.isfinite(taken).all()


def test_a_time_stamp_that_comes_again_is_refused():
    t = T * np.arange(20)
    t[10] = t[9]
    out = run(np.zeros((20, JOINTS)), time=t)
    assert out["status"][10] == REPEATED
    assert out["steps"][9:12].tolist() == [1, 0, 2]


@pytest.mark.parametrize("reason", [GAP, JUMP])
def test_after_a_restart_velocities_are_unknown_until_five_samples_are_in(reason):
    t = T * np.arange(40)
    (q, _, _), _ = motion(424, t)
    if reason == GAP:
        t = t + np.where(np.arange(40) >= 20, 0.5, 0.0)
    else:
        q[20:, 2] += 7.0
    out = run(q, time=t, jump=1.0)
    assert out["fresh"].tolist() == [1] + [0] * 19 + [1] + [0] * 19
    assert out["status"][20] == reason | RESTARTED
    assert out["known"][:, 0].tolist() == [0] * 4 + [1] * 16 + [0] * 4 + [1] * 16
    # And from then on as if it had begun there.
    after = run(q[20:], time=t[20:], jump=1.0)
    assert out["dq_past"][24:, 0].tobytes() == after["dq_past"][4:, 0].tobytes()


def test_the_longest_bridge_fits():
    stage = arm_stage(JOINTS)
    room = stage.output.fields["time"].dims[0]
    t = T * np.arange(40)
    kept = np.r_[0:10, 18:40]  # eight gone, as many as are bridged
    out = run(np.zeros((32, JOINTS)), time=t[kept])
    assert out["steps"].max() == room == 9
    assert arm.SPAN == 5
