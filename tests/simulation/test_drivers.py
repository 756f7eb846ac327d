"""Drives by role, sampled: held over control periods, limited, told apart, refused."""

import math

import numpy as np
import pytest

from rotatum.errors import RotatumError
from rotatum.simulation import Ramps, hold, plant_of, sine
from rotatum.simulation.drivers.commands import position_drives
from rotatum.simulation.drivers.control import Gains, PositionControl
from rotatum.simulation.drivers.drives import sample_drives
from rotatum.simulation.drivers.feedback import Seen
from tests.simulation.joints import AWAS, VSA, joint_of, series_joint

TIME = 1e-3 * np.arange(50)


def inputs_of(joint, drives, **settings):
    return sample_drives(joint, plant_of(joint), TIME, drives, **settings)


def seen_of(joint, time, *theta):
    theta, link = np.array(theta), np.zeros(1)
    still = {joint.name: np.zeros_like(theta)}
    return Seen(time, link, link, {joint.name: theta}, still, link, still)


def test_torques_are_those_of_the_control_instants_and_held():
    push, swell = sine(3.0, 10.0), sine(1.0, 4.0)
    inputs = inputs_of(joint_of(VSA), {"tau1": push, "tau2": swell}, external=swell, control=4)
    for k in range(TIME.size):
        tick = TIME[4 * (k // 4)]
        np.testing.assert_array_equal(inputs.tau[k], [push(tick), swell(tick)])
    # what pushes from outside knows nothing of the controller
    np.testing.assert_array_equal(inputs.tau_ext, swell(TIME))
    assert inputs.control == 4
    assert not inputs.feedback


def test_a_set_point_s_torque_is_held_and_its_angle_is_not():
    joint = joint_of(AWAS)
    plant = plant_of(joint)
    swing, path = sine(3.0, 10.0), Ramps((0.0, 0.04), (0.1, 0.08))
    driven = inputs_of(joint, {"tau": swing, "tau_setpoint": swing}, control=5)
    assert driven.angle is None
    np.testing.assert_array_equal(driven.tau_setpoint, np.repeat(swing(TIME[::5]), 5))
    led = inputs_of(joint, {"tau": swing, "setpoint": path}, control=5)
    np.testing.assert_allclose(plant.setpoint(led.angle), path(TIME), rtol=1e-14)
    np.testing.assert_array_equal(led.tau_setpoint, 0.0)
    straight = inputs_of(joint, {"tau": swing, "setpoint_angle": path}, control=5)
    np.testing.assert_array_equal(straight.angle, path(TIME))


def test_one_motor_by_feedback_the_other_open_loop():
    joint = joint_of(VSA)
    law = PositionControl(joint.name, sine(0.2, 5.0), Gains(2.0, 0.05), motor=1)
    inputs = inputs_of(joint, {"tau1": hold(0.01), "tau2": law}, control=2)
    np.testing.assert_array_equal(inputs.tau, [[0.01, 0.0]] * TIME.size)
    assert list(inputs.feedback) == [1]
    for t in TIME[::2]:
        expected = 2.0 * (0.2 * math.sin(10 * math.pi * t) - 0.03)
        expected += 0.05 * 0.2 * 10 * math.pi * math.cos(10 * math.pi * t)
        found = inputs.feedback[1].torque(seen_of(joint, t, 0.0, 0.03))
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_open_loop_and_feedback_have_the_same_limit():
    motor = {"inertia": 4e-5, "gear_ratio": 80.0, "torque_limit": 0.1}
    joint = series_joint(motor=motor)
    open_loop = inputs_of(joint, {"tau": sine(20.0, 30.0)})
    np.testing.assert_array_equal(open_loop.tau[:, 0], np.clip(sine(20.0, 30.0)(TIME), -8.0, 8.0))
    fed_back = inputs_of(joint, position_drives(joint, hold(9.0), bandwidth=50.0))
    assert fed_back.feedback[0].torque(seen_of(joint, 0.0, 0.0)) == 8.0
    assert fed_back.feedback[0].torque(seen_of(joint, 0.0, 20.0)) == -8.0


def test_other_feedback_is_asked_as_it_is():
    class Push:
        def torque(self, seen):
            return seen.time - float(seen.theta["demo-elbow"][0])

    joint = series_joint()
    inputs = inputs_of(joint, {"tau": Push()})
    assert inputs.feedback[0].torque(seen_of(joint, 0.75, 0.5)) == 0.25


def test_gains_too_high_for_the_control_period_are_refused_with_the_period_they_need():
    joint = series_joint(motor={"inertia": 1e-4, "gear_ratio": 10.0})  # B = 0.01
    drives = position_drives(joint, hold(0.0), bandwidth=200.0)
    # Kd T < 2 B: T < 1 / w = 5 ms
    inputs_of(joint, drives, control=4)
    with pytest.raises(RotatumError, match=r"demo-elbow, tau: .* got 0.005.* below 0.005 s"):
        inputs_of(joint, drives, control=5)


@pytest.mark.parametrize(
    ("text", "drives", "says"),
    [
        (VSA, {"tau1": hold(0.0)}, "tau2 is missing"),
        (VSA, {"tau1": hold(0.0), "tua2": hold(0.0)}, "got 'tua2'.*Did you mean 'tau2'"),
        (AWAS, {"tau": hold(0.0)}, "exactly one way"),
        (AWAS, {"tau": hold(0.0), "setpoint": hold(0.1), "setpoint_angle": hold(0.0)}, "one way"),
        (
            AWAS,
            {"tau": hold(0.0), "setpoint": PositionControl("awas", hold(0.0), Gains(1.0, 1.0))},
            "awas, drives: only a motor's torque can be fed back.*got 'setpoint'",
        ),
        (AWAS, {"tau": np.log, "setpoint": hold(0.1)}, "tau: a drive must be one finite number"),
        (
            AWAS,
            {"tau": lambda time: time[:2], "setpoint": hold(0.1)},
            r"tau: a drive must be one finite number.*got \(2,\)",
        ),
    ],
)
def test_drives_the_joint_cannot_have_are_refused(text, drives, says):
    with np.errstate(divide="ignore"), pytest.raises(RotatumError, match=says):
        inputs_of(joint_of(text), drives)


def test_a_control_period_is_at_least_one_instant():
    with pytest.raises(RotatumError, match="control: one instant or more"):
        inputs_of(series_joint(), {"tau": hold(0.0)}, control=0)
