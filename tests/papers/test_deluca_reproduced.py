"""De Luca et al. 2007 reproduced: the full state observed, and control on it, with its sensors."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from rotatum.control import ElasticArm, RestToRest, desired_motion, full_state_feedback
from rotatum.estimators.full_state import friction
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.evaluation.loop import closed_loop, without_friction
from rotatum.evaluation.papers.deluca2007.arms import BIAS, PERIOD, arm, calibrated, joint_counts
from rotatum.evaluation.papers.deluca2007.observer import (
    CALIBRATED,
    MOTIONS,
    SEEN,
    SOFT,
    TURNING,
    UNTOLD,
    Job,
    motion,
    starts,
    tracks,
)
from rotatum.evaluation.papers.deluca2007.singular import WAYS, crossing
from rotatum.evaluation.papers.deluca2007.tracking import OBSERVED, TRUE, Tracking, tracked
from rotatum.evaluation.papers.deluca2007.tracking import SOFT as SOFTER
from rotatum.simulation import Readings, Sensors

ABOVE, IN_LINE = WAYS
STRETCHED = np.array([0.0, 0.5 * np.pi, 0.0])


@lru_cache(maxsize=2)
def observed(acted: bool) -> float:
    """Largest error of axis 1's link in closed loop on ideal sensors [rad].

    acted: the observer takes a torque for the interval it acted over, else for the one after.
    """
    device = without_friction(arm("kr15-like"))
    known = ElasticArm.of(device)
    way = RestToRest(STRETCHED, STRETCHED + np.array([0.02, 0.0, 0.0]), 0.02, 0.25)
    desired = desired_motion(known, way, PERIOD, 0.3)
    observer = StateObserver(
        device, period=PERIOD, holds=dict.fromkeys(known.names, True), gyro=0.0
    )

    def late(readings: Readings) -> np.ndarray:
        found = observer.update(theta=readings.theta, tau=readings.tau, readings=readings.acc)
        return np.array([found.theta, found.q, found.dtheta, found.dq])

    run = closed_loop(
        device,
        desired,
        full_state_feedback(known, STRETCHED),
        observer=observer if acted else None,
        estimate=None if acted else late,
        sensors={name: Sensors(counts={}) for name in known.names},
    )
    return float(np.abs(run.estimate[:, 1, 0] - run.log.joints["axis1"]["q_true"]).max())


def test_in_the_loop_the_observer_takes_the_torque_that_acted() -> None:
    # Ideal sensors: what is left are straight lines between samples, of second order in 1 ms.
    assert observed(acted=True) < 1e-6
    # Torques up to 60 N m from one sample to the next, on 164 kN m/rad, a sample late.
    assert observed(acted=False) > 100.0 * observed(acted=True)


def test_show_2_on_the_short_motion() -> None:
    device, log = motion(Job("manutec-r3", "short"))
    joints = MOTIONS["short"]
    (own,) = tracks(device, log, joints, only=(SEEN,))[SEEN].values()
    # With the bias of 0.2 m/s^2 in: two to five times what is left.
    assert own.error <= 1e-4
    assert own.torsion <= 0.1
    assert own.velocity <= 0.02
    assert own.rigid >= 5.0 * own.error


def test_a_start_from_rest_is_exact_but_for_what_is_untold() -> None:
    errors = starts("manutec-r3")
    rigid, found = errors["payload known"]
    assert found < 1e-10  # Newton's last step
    assert rigid > 2e-3  # 900 N m on 350 kN m/rad
    rigid, found = errors[UNTOLD]
    # 15 of some 130 kg, but at the end of the arm
    assert 0.1 * rigid < found < 0.5 * rigid


def test_six_poses_tell_the_bias() -> None:
    own = calibrated(arm("kr15-like"))
    # Means of 1000 samples of 0.1 m/s^2, and an angle of 1e-4 rad times gravity: 3.3e-3 each.
    np.testing.assert_allclose(own.bias, BIAS, atol=5.0 * 3.3e-3)
    assert np.abs(own.bias - BIAS).max() < 5.0 * own.std[:3].max()


def test_encoders_are_the_motors_behind_their_gears() -> None:
    assert joint_counts(arm("kr15-like")) == {
        "axis1": 105 * 2**20,
        "axis2": 210 * 2**20,
        "axis3": 60 * 2**20,
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", ["manutec-r3", "kr15-like"])
def test_show_2_on_all_motions(name: str) -> None:
    for key, joints in MOTIONS.items():
        device, log = motion(Job(name, key))
        found = tracks(device, log, joints)
        own = found[SEEN]["axis1"]
        assert own.error <= 1e-4
        assert own.torsion <= 0.1
        assert own.velocity <= 0.02
        for joint in joints:
            own = found[SEEN][joint]
            assert own.rigid >= 5.0 * own.error
            # Untold payload is in the start alone, 0.5 s ago: forgotten to rounding.
            assert found[UNTOLD][joint].error == pytest.approx(own.error, rel=1e-6)
            assert found[CALIBRATED][joint].error < own.error
        assert found[CALIBRATED]["axis1"].velocity <= 0.02
        if len(joints) == 1:
            assert found[TURNING]["axis1"].velocity < 0.5 * found[SEEN]["axis1"].velocity
            # The torsion is the torque over the stiffness: 1/0.9 of itself, 11 % too large.
            assert found[SOFT]["axis1"].torsion == pytest.approx(0.11, abs=0.01)


@pytest.mark.parametrize("way", [pytest.param(ABOVE, marks=pytest.mark.slow), IN_LINE])
def test_show_3_singular_poses_crossed(way: str) -> None:
    own = crossing(way)
    parts = own.parts()
    before = own.largest(parts["before"])
    assert own.jump() < 0.1 * before  # and twice it is allowed
    assert own.largest(parts["at"]) <= 2.0 * before
    assert own.largest(parts["after"]) <= 2.0 * before
    # Crossed, not skirted: the accelerations along one direction are lost there, and it is said.
    assert own.share.min() < 0.2
    assert own.flagged[own.share < 0.5].all()
    assert not own.flagged[own.share > 0.999].any()


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [0.9, 1.1])
@pytest.mark.parametrize("key", ["short", "long"])
def test_show_4_where_the_mode_is_at_the_bandwidth(key: str, stiffness: float) -> None:
    own = tracked(Tracking("kr15-like", key, stiffness))
    assert own.factor(OBSERVED) >= 3.0
    assert own.gain_of_truth <= 0.2
    assert own.factor(SOFTER) >= 3.0
    # What friction bears at rest, 42 N m at most, is not fed back as torsion: the motors come to
    # rest, but for the noise of the accelerometer and what motors alone do too.
    assert own.restless[OBSERVED] < 0.1 * 42.0
    smooth = tracked(Tracking("kr15-like", key, stiffness, friction=False, laws=(TRUE, OBSERVED)))
    assert smooth.factor(OBSERVED) >= 3.0
    # Without friction the observer is as good as the truth: noise and bias do hardly anything.
    assert abs(smooth.gain_of_truth) <= 0.05


@pytest.mark.slow
def test_with_friction_half_as_steep_the_motors_do_not_rest(monkeypatch) -> None:
    monkeypatch.setattr(friction, "_DAMPING", 0.25)
    own = tracked(Tracking("kr15-like", "short", laws=(OBSERVED,)))
    assert 20.0 < own.restless[OBSERVED] < 42.0  # 30 N m, of what friction bears


@pytest.mark.slow
def test_show_4_where_it_does_not_pay() -> None:
    slow = tracked(Tracking("manutec-r3", "short", laws=(OBSERVED,)))
    assert slow.factor(OBSERVED) < 1.0  # the mode is at 53 rad/s
    fast = tracked(Tracking("manutec-r3", "short", bandwidth=50.0, laws=(OBSERVED,)))
    assert fast.factor(OBSERVED) >= 3.0
