"""Single arms against numbers and models made apart from them."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from numpy.typing import NDArray
from scipy.linalg import eigh

from rotatum.models import load_device
from rotatum.models.robot.interface import Robot
from rotatum.models.robot.packaged import read_urdf
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from rotatum.models.robot.urdf import UrdfRobot
from tests.models.robot_cases import ARMS, INERTIA, arm, planar_2r, states

Array = NDArray[np.float64]


def _everything(robot: Robot, state: Array) -> list[Array]:
    q, dq, ddq, dddq = state
    return [
        robot.mass(q), robot.coriolis(q, dq), robot.gravity(q), robot.bias(q, dq),
        robot.coriolis_transposed(q, dq), robot.mass_rate(q, dq), robot.gravity_rate(q, dq),
        robot.coriolis_rate(q, dq, ddq), robot.inverse_dynamics(q, dq, ddq),
        robot.inverse_dynamics_rate(q, dq, ddq, dddq), robot.accelerate(q, dq, ddq),
        np.array(robot.kinetic_energy(q, dq)), np.array(robot.potential_energy(q)),
        *(part for f in robot.frames for part in robot.motion(f, q, dq, ddq)),
        *(part for f in robot.frames for part in robot.pose(f, q)),
        *(robot.jacobian(f, q) for f in robot.frames),
    ]  # fmt: skip


def _alike(one: Robot, other: Robot, state: Array, tolerance: float) -> None:
    for a, b in zip(_everything(one, state), _everything(other, state), strict=True):
        np.testing.assert_allclose(a, b, rtol=tolerance, atol=tolerance)


@settings(max_examples=50)
@given(states(2))
def test_the_closed_form_is_the_urdf_file(state: Array) -> None:
    from_file = UrdfRobot(read_urdf("planar-2r"))
    from_file.frames = planar_2r().frames  # the file's has the base, too
    # The same sums in another order; 1e-12 leaves room for the condition of M, below 100, and
    # accelerations of up to 100 rad/s^2.
    _alike(planar_2r(), from_file, state, 1e-12)


def _lagrange() -> Any:
    """Torques and their rates of two thin rods with a point at the elbow, out of T - V.

    Integrates over the rods, so that no moment of inertia is put in.
    """
    t, x = sp.symbols("t x")
    turns = [sp.Function(f"q{i}")(t) for i in (1, 2)]
    mass, length, motor, field = 0.1, 0.5, 0.345, 9.81

    def place(angle: Any, reach: Any) -> Any:
        return reach * sp.Matrix([sp.sin(angle), -sp.cos(angle)])

    def lagrangian(point: Any, heavy: float) -> Any:
        speed = point.diff(t)
        return heavy * (speed.dot(speed) / 2 - field * point[1])

    elbow = place(turns[0], length)
    second = elbow + place(turns[0] + turns[1], x)
    along = lagrangian(place(turns[0], x), mass / length) + lagrangian(second, mass / length)
    whole = sp.integrate(sp.expand(along), (x, 0, length)) + lagrangian(elbow, motor)
    torques = [whole.diff(q.diff(t)).diff(t) - whole.diff(q) for q in turns]
    both = [*torques, *(torque.diff(t) for torque in torques)]
    symbols = sp.symbols("q:2 v:2 a:2 j:2")
    values = [q.diff(t, n) if n else q for n in range(4) for q in turns]
    pairs = list(zip(values, symbols, strict=True))[::-1]  # the highest derivative first
    return sp.lambdify(symbols, [torque.subs(pairs) for torque in both])


def test_planar_is_what_lagrange_says() -> None:
    lagrange = _lagrange()
    robot = planar_2r()
    for state in np.random.default_rng(1).uniform(-2.0, 2.0, (20, 4, 2)):
        told = lagrange(*state.ravel())
        # Terms of up to 50 N m/s; rounding.
        assert robot.inverse_dynamics(*state[:3]) == pytest.approx(told[:2], abs=1e-12)
        assert robot.inverse_dynamics_rate(*state) == pytest.approx(told[2:], abs=1e-12)


def test_planar_gravity_of_the_paper_is_beyond_its_motors() -> None:
    # Stretched out flat: 0.345 9.81 0.5 + 0.1 9.81 0.25 + 0.1 9.81 0.75 N m.
    flat = np.array([np.pi / 2, 0.0])
    assert planar_2r().gravity(flat)[0] == pytest.approx(2.673, abs=5e-4)


def test_a_point_on_the_arm_pulls_by_its_jacobian() -> None:
    # A body's share of M is J^T diag(m, I) J at its centre, its share of gravity -J^T m g.
    rng = np.random.default_rng(2)
    for name in ("planar", "seven-axis", "r3-elastic"):
        robot = arm(name)
        frame = robot.frames[-1]
        place, mass = np.array([0.12, 0.05 if name != "planar" else 0.0, -0.07]), 0.8
        loaded = robot.with_payload(frame, mass, tuple(place), INERTIA)
        for _ in range(5):
            q = rng.uniform(-3.0, 3.0, robot.size)
            rotation = robot.pose(frame, q).rotation
            arm_to = rotation @ place
            linear, angular = np.split(robot.jacobian(frame, q), 2)
            linear = linear + np.cross(angular, arm_to, axisa=0, axisb=0, axisc=0)
            about = rotation @ np.array(INERTIA) @ rotation.T
            share = mass * linear.T @ linear + angular.T @ about @ angular
            np.testing.assert_allclose(
                loaded.mass(q), robot.mass(q) + share, rtol=1e-12, atol=1e-12
            )
            pull = robot.gravity(q) - mass * linear.T @ robot.gravity_vector
            np.testing.assert_allclose(loaded.gravity(q), pull, rtol=1e-12, atol=1e-11)


def test_two_payloads_add_up() -> None:
    robot = arm("seven-axis")
    both = robot.with_payload("flange", 1.0, (0.0, 0.0, 0.1)).with_payload(
        "flange", 3.0, (0.0, 0.0, 0.3)
    )
    # Centre (0.1 + 3 0.3) / 4; about it 1 0.15^2 + 3 0.05^2 = 0.03 kg m^2.
    about = np.diag([0.03, 0.03, 0.0])
    one = robot.with_payload("flange", 4.0, (0.0, 0.0, 0.25), about.tolist())
    state = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 7))
    _alike(both, one, state, 1e-11)


def test_the_r3_has_the_figures_worked_out_apart() -> None:
    device = load_device("manutec-r3")
    loaded, stretched = device.build_robot(), np.array([0.0, np.pi / 2, 0.0])
    assert loaded is not None
    # Three or four digits are told.
    assert np.diag(loaded.mass(stretched)) == pytest.approx([169.0, 100.3, 25.4], rel=3e-3)
    assert loaded.gravity(stretched) == pytest.approx([0.0, -883.0, -286.0], abs=0.5)
    stiffness = np.diag([float(j.transmission.stiffness(0.0)) for j in device.joints])
    unloaded = UrdfRobot(read_urdf("manutec-r3"), ("axis1", "axis2", "axis3"))
    for robot, told in ((loaded, [50.9, 53.0, 221.0]), (unloaded, [64.7, 69.2, 247.0])):
        modes = np.sqrt(eigh(stiffness, robot.mass(stretched), eigvals_only=True))
        assert modes == pytest.approx(told, rel=3e-3)
    # Bent by a right angle.
    bent = unloaded.mass(np.array([0.0, 0.0, np.pi / 2]))
    assert np.diag(bent)[1:] == pytest.approx([48.7, 11.1], rel=5e-3)
    assert np.allclose(device.robot.coupling_matrix[1, 2], 60 * 1.3e-3, rtol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_arms_go_to_other_processes(name: str) -> None:
    robot = arm(name)
    again = pickle.loads(pickle.dumps(robot))
    assert (again.names, again.frames) == (robot.names, robot.frames)
    state = np.random.default_rng(4).uniform(-1.0, 1.0, (4, robot.size))
    _alike(robot, again, state, 0.0)


def test_locked_joints_stand_where_they_are_locked() -> None:
    text = read_urdf("manutec-r3")
    wrist = {"axis4": 0.4, "axis5": -0.7, "axis6": 1.1}
    whole = arm("r3").with_payload("flange", 15.0, (0.1, 0.1, 0.25))
    q = np.array([0.3, 1.2, -0.4, *wrist.values()])
    locked = UrdfRobot(text, ("axis1", "axis2", "axis3"), wrist)
    locked = locked.with_payload("flange", 15.0, (0.1, 0.1, 0.25))
    np.testing.assert_allclose(locked.mass(q[:3]), whole.mass(q)[:3, :3], rtol=1e-12)
    np.testing.assert_allclose(locked.gravity(q[:3]), whole.gravity(q)[:3], rtol=1e-12, atol=1e-11)
    place = locked.pose("flange", q[:3]).position
    np.testing.assert_allclose(place, whole.pose("flange", q).position, rtol=1e-12)
    # Not named: locked at 0.
    straight = UrdfRobot(text, ("axis1", "axis2", "axis3"))
    q[3:] = 0.0
    np.testing.assert_allclose(straight.mass(q[:3]), arm("r3").mass(q)[:3, :3], rtol=1e-12)


def test_a_pendulum_of_a_rod() -> None:
    # m l^2 / 3 and m g l / 2; swings at sqrt(G / M).
    pendulum = Pendulum(0.1 * 0.25 / 3, 0.1 * 9.81 * 0.25, 0.5)
    still = np.zeros(1)
    assert pendulum.accelerate(np.array([0.1]), still, still) == pytest.approx(
        [-1.5 * 9.81 / 0.5 * np.sin(0.1)], rel=1e-14
    )
    # A point at the tip.
    loaded = pendulum.with_payload("tip", 2.0)
    assert loaded.mass(still) == pytest.approx(0.1 * 0.25 / 3 + 2.0 * 0.25)
    side = np.array([np.pi / 2])
    assert loaded.gravity(side) == pytest.approx(0.1 * 9.81 * 0.25 + 2.0 * 9.81 * 0.5)


def test_planar_links_with_a_centre_and_an_inertia() -> None:
    # trumic2022's: a point at the end of each link.
    points = Planar((0.09, 0.09), (0.26, 0.26), centres=(0.09, 0.09), inertias=(0.0, 0.0))
    still = np.zeros(2)
    i = 0.26 * 0.09**2
    told = [[i + i * 4, 2 * i], [2 * i, i]]
    np.testing.assert_allclose(points.mass(still), told, rtol=1e-14)
