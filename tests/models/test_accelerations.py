"""T and W of accelerometers on links: against the simulator's readings and high differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rotatum.errors import DeviceError
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.models.robot.accelerations import AccelerometerMap, GyroscopeMap
from rotatum.models.rotations import rotation_about, rotation_of, rpy_of, vector_of
from rotatum.simulation.sensing.inertial import Links, angular_rate, specific_force
from tests.models.robot_cases import STEP, along, arm, states

# Two on one frame with another between, one axis, two axes out of order, three axes.
PLACES = (
    ((0.0, 0.1, 0.1), (0.1, -0.7, 2.3), ("z",)),
    ((0.3, -0.2, 0.05), (0.0, 0.0, 0.0), ("y", "x")),
    ((-0.1, 0.0, 0.2), (3.0, 0.4, -1.2), ("x", "y", "z")),
)
FRAMES = {
    "pendulum": ("tip", "link", "tip"),
    "planar": ("link2", "link1", "link2"),
    "r3-elastic": ("body4", "body2", "body4"),
}
ARMS = pytest.mark.parametrize("name", FRAMES)


def _mounted(name, kind=Accelerometer):
    return tuple(
        kind(name=f"s{i}", frame=frame, position=place, rpy=rpy, axes=axes)
        for i, (frame, (place, rpy, axes)) in enumerate(zip(FRAMES[name], PLACES, strict=True))
    )


def _shown(name, sensors, measure, links):
    """What the simulator shows, sensor by sensor, of the axes measured."""
    at = [["xyz".index(axis) for axis in sensor.axes] for sensor in sensors]
    whole = [measure(arm(name), sensor, links)[0] for sensor in sensors]
    return np.concatenate([x[chosen] for x, chosen in zip(whole, at, strict=True)])


@ARMS
@given(data=st.data())
@settings(max_examples=15)
def test_it_shows_what_the_simulator_shows(name, data):
    sensors = _mounted(name)
    q, dq, ddq, _ = data.draw(states(arm(name).size))
    found = AccelerometerMap(arm(name), sensors)
    expected = _shown(name, sensors, specific_force, Links(q[None], dq[None], ddq[None]))
    # rounding of some 50 m/s^2
    np.testing.assert_allclose(found.readings(q, dq, ddq), expected, atol=1e-12)
    matrix, rest = found.both(q, dq)
    np.testing.assert_allclose(matrix @ ddq + rest, expected, atol=1e-12)
    np.testing.assert_array_equal(matrix, found.matrix(q))
    np.testing.assert_array_equal(rest, found.rest(q, dq))
    rates = GyroscopeMap(arm(name), _mounted(name, Gyroscope))
    expected = _shown(name, sensors, angular_rate, Links(q[None], dq[None], ddq[None]))
    np.testing.assert_allclose(rates.matrix(q) @ dq, expected, atol=1e-13)
    assert found.columns == ("s0.az", "s1.ay", "s1.ax", "s2.ax", "s2.ay", "s2.az")
    assert rates.columns == ("s0.gz", "s1.gy", "s1.gx", "s2.gx", "s2.gy", "s2.gz")


@ARMS
@given(data=st.data())
@settings(max_examples=10)
def test_it_is_the_second_derivative_of_where_the_sensor_is(name, data):
    robot, sensor = arm(name), _mounted(name)[2]
    state = data.draw(states(robot.size))

    def place(t):
        pose = robot.pose(sensor.frame, along(state, t)[0])
        return pose.position + pose.rotation @ np.array(sensor.position)

    # Second derivative of order six: [2, -27, 270, -490, 270, -27, 2] / 180.
    h = 5.0 * STEP
    weights = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0 / h**2
    second = weights @ np.array([place(k * h) for k in range(-3, 4)])
    turn = robot.pose(sensor.frame, state[0]).rotation @ rotation_of(sensor.rpy)
    expected = turn.T @ (second - robot.gravity_vector)
    found = AccelerometerMap(robot, [sensor]).readings(*state[:3])
    # Rounding of 2 m, 1e-15 / h^2 = 4e-11, some ten times; h^6 / 560 of an eighth derivative: the
    # sensor is 1.5 m away, the angles add up to 6 rad/s, rad/s^2 and rad/s^3, and with them
    # 6^8 + 28 6^6 6 + 210 6^4 6^2 + ... is some 3e7: 1e-9.
    np.testing.assert_allclose(found, expected, atol=1e-8)


def test_a_frame_the_arm_does_not_have_is_named():
    sensor = Accelerometer(name="imu", frame="link9")
    with pytest.raises(DeviceError, match=r"sensor imu.*link9.*link2"):
        AccelerometerMap(arm("planar"), [sensor])


@given(st.tuples(*[st.floats(-3.1, 3.1)] * 3))
def test_rotations_there_and_back(angles):
    turn = rotation_of(angles)
    np.testing.assert_allclose(turn, Rotation.from_euler("xyz", angles).as_matrix(), atol=1e-15)
    # at a pitch of pi/2 the angles are lost to 1e-8, and the turn is not
    np.testing.assert_allclose(rotation_of(rpy_of(turn)), turn, atol=1e-9)
    short = 0.5 * np.array(angles)
    np.testing.assert_allclose(vector_of(rotation_about(short)), short, atol=1e-12)


def test_upright_the_yaw_has_it_all():
    for pitch in (np.pi / 2, -np.pi / 2):
        turn = rotation_of((0.3, pitch, 1.1))
        roll, found, _ = rpy_of(turn)
        assert (roll, found) == (0.0, pytest.approx(pitch))
        np.testing.assert_allclose(rotation_of(rpy_of(turn)), turn, atol=1e-15)
