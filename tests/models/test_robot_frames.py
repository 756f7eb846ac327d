"""Frames on links: positions, Jacobians and accelerations against each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from tests.models.robot_cases import ARMS, along, arm, close, rate, states

_EACH = pytest.mark.parametrize("name", ARMS)


def _spin(rotation: NDArray[np.float64], change: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angular velocity in the world out of a rotation matrix and its rate."""
    w = change @ rotation.T
    return np.array([w[2, 1] - w[1, 2], w[0, 2] - w[2, 0], w[1, 0] - w[0, 1]]) / 2


@_EACH
@settings(max_examples=15)
@given(st.data())
def test_motion_is_the_derivative_of_the_pose(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    state = data.draw(states(robot.size))
    q, dq, ddq, _ = state
    for frame in robot.frames:
        moved = robot.motion(frame, q, dq, ddq)
        pose = robot.pose(frame, q)
        close(pose.rotation @ pose.rotation.T, np.eye(3), 0.0, 1e-14)  # rounding
        told = rate(lambda t, f=frame: robot.pose(f, along(state, t)[0]).position)
        close(moved.velocity, told, 1.0)
        turned = rate(lambda t, f=frame: robot.pose(f, along(state, t)[0]).rotation)
        close(moved.angular_velocity, _spin(pose.rotation, turned), 1.0)
        told = rate(lambda t, f=frame: robot.motion(f, *along(state, t)).velocity)
        close(moved.acceleration, told, float(np.abs(told).max()))
        told = rate(lambda t, f=frame: robot.motion(f, *along(state, t)).angular_velocity)
        close(moved.angular_acceleration, told, float(np.abs(told).max()))
        both = np.concatenate([moved.velocity, moved.angular_velocity])
        close(robot.jacobian(frame, q) @ dq, both, 1.0, 1e-13)  # rounding


def test_closed_forms_hang_along_gravity_and_turn_towards_x() -> None:
    pendulum = Pendulum(1.0, 9.81, 0.5)
    flat = np.zeros(1)
    assert pendulum.frames == ("link", "tip")
    assert pendulum.pose("tip", flat).position.tolist() == [0.0, 0.0, -0.5]
    assert np.array_equal(pendulum.pose("tip", flat).rotation, np.eye(3))
    assert pendulum.gravity(np.array([np.pi / 2])) == pytest.approx(9.81)  # pulled back down
    up = pendulum.pose("tip", np.array([np.pi / 2]))
    assert up.position == pytest.approx([0.5, 0.0, 0.0], abs=1e-16)
    two = Planar((0.5, 0.3), (0.1, 0.1))
    bent = two.pose("tip", np.array([0.0, np.pi / 2]))
    assert bent.position == pytest.approx([0.3, 0.0, -0.5], abs=1e-16)
    elbow = two.pose("elbow", np.array([np.pi / 2, 1.0]))
    assert elbow.position == pytest.approx(two.pose("link2", np.array([np.pi / 2, 1.0])).position)
    assert two.gravity_vector.tolist() == [0.0, 0.0, -9.81]
    assert not two.pose("link1", np.ones(2)).position.any()


def test_the_r3_reaches_as_far_as_told() -> None:
    robot = arm("r3")
    # Of the wrist's centre from the first axis, forearm straightened by atan(0.155 / 0.6).
    q = np.array([0.0, np.pi / 2, np.arctan2(0.155, 0.600), 0.0, 0.0, 0.0])
    wrist = robot.pose("body5", q).position
    assert np.hypot(wrist[0], wrist[1]) == pytest.approx(1.570, abs=5e-4)  # four digits
    assert wrist[2] == pytest.approx(0.675, abs=1e-12)
    assert robot.pose("body2", q).position == pytest.approx([0.3, 0.0, 0.675])
    # q = 0: upright.
    assert robot.pose("flange", np.zeros(6)).position == pytest.approx([0.145, 0.0, 2.05])


def test_the_seven_axis_arm_is_as_long_as_told() -> None:
    robot = arm("seven-axis")
    shoulder = robot.pose("link2", np.zeros(7)).position
    flange = robot.pose("flange", np.zeros(7)).position
    assert flange - shoulder == pytest.approx([0.05, 0.0, 1.2])


@pytest.mark.parametrize(("name", "near"), [("planar", "tip"), ("seven-axis", "flange")])
def test_an_unknown_frame_suggests(name: str, near: str) -> None:
    robot = arm(name)
    q = np.zeros(robot.size)
    for call in (
        lambda: robot.pose(near + "s", q),
        lambda: robot.jacobian(near + "s", q),
        lambda: robot.motion(near + "s", q, q, q),
        lambda: robot.with_payload(near + "s", 1.0),
    ):
        with pytest.raises(DeviceError, match=f'no such frame, .*Did you mean "{near}"'):
            call()
