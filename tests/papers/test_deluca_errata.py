"""Where De Luca et al. 2007 as printed does not work: what is pinned nowhere else, by equation."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.full_state.observer import StateObserver
from rotatum.evaluation.loop import without_friction
from rotatum.models import Accelerometer, load_device
from rotatum.models.robot.accelerations import AccelerometerMap

T = 1e-3
POSE = np.array([0.4, 0.8, 0.9])


def mapped(*positions: tuple[float, float, float]) -> AccelerometerMap:
    robot = load_device("manutec-r3").build_robot()
    assert robot is not None
    sensors = [
        Accelerometer(name=f"a{i}", frame="body4", position=p) for i, p in enumerate(positions)
    ]
    return AccelerometerMap(robot, sensors)


def test_eq_11_needs_full_column_rank() -> None:
    """T_A is M x N with M >= N: more rows than columns cannot be of full row rank."""
    T_A = mapped((0.0, 0.1, 0.1), (0.2, 0.0, -0.1)).matrix(POSE)
    assert T_A.shape == (6, 3)
    assert np.linalg.matrix_rank(T_A) == 3
    inverse = np.linalg.pinv(T_A)
    np.testing.assert_allclose(inverse @ T_A, np.eye(3), atol=1e-12)
    assert np.abs(T_A @ inverse - np.eye(6)).max() > 0.1  # what full row rank would make 0
    # Rows of full rank that are fewer than the joints do not determine them.
    few = T_A[:2]
    assert np.linalg.matrix_rank(few) == 2
    assert np.abs(np.linalg.pinv(few) @ few - np.eye(3)).max() > 0.1


def test_eq_9_adds_gravity_pointing_up() -> None:
    at = mapped((0.0, 0.1, 0.1))
    shown = at.rest(POSE, np.zeros(3))
    robot = load_device("manutec-r3").build_robot()
    assert robot is not None
    # An arm at rest: what is shown is no acceleration but the force that bears the sensor.
    assert np.linalg.norm(shown) == pytest.approx(9.81, rel=1e-3)
    world = robot.pose("body4", POSE).rotation @ shown
    np.testing.assert_allclose(world, -np.asarray(robot.gravity_vector), atol=1e-12)


def test_eqs_3_and_5_measure_the_links_acceleration_not_its_velocity() -> None:
    """The dots the print lost: with y2 = q' in the last row nothing is observed."""
    device = without_friction(load_device("manutec-r3"))
    joint = device.joints[0]
    B = joint.motors[0].reflected_inertia
    assert B is not None
    K, D, M = joint.transmission.stiffness(0.0).item(), joint.transmission.damping, 169.0
    # A torsion of b sin(w t) asks for these: all by hand, the initial state far from rest.
    t, w, b = T * np.arange(300), 20.0, 1e-3
    torsion, rate = b * np.sin(w * t), b * w * np.cos(w * t)
    push = K * torsion + D * rate
    q = -(K * torsion + D * rate) / (M * w**2)
    ddq = push / M
    dq = -(K * rate - D * w**2 * torsion) / (M * w**2)
    tau = B.value * (ddq - w**2 * torsion) + push
    worst = {}
    for name, y2 in (("q''", ddq), ("q'", dq)):
        loop = StateObserver(device, period=T, accelerations="joints")
        none = np.zeros_like(t)
        found = loop.run(
            t,
            np.column_stack([q + torsion, none, none]),
            np.column_stack([tau, none, none]),
            np.zeros((len(t), 3)),
            np.column_stack([y2, none, none]),
            np.zeros((len(t), 0)),
        )
        worst[name] = np.abs(found["q_hat"][150:, 0] - q[150:]).max()
    # Straight lines between samples leave (w T)^2 / 12 of what moves; 150 samples are 30 time
    # constants of the poles.
    assert worst["q''"] < 2.0 * (w * T) ** 2 / 12.0 * np.abs(q).max()
    assert worst["q'"] > 0.1 * b
