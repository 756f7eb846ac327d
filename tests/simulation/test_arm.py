"""Arms with elastic joints: energy, an integration of its own, couplings, mixes, ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotatum.models.robot.planar import Planar
from rotatum.simulation import Body, Plant
from rotatum.simulation.plant.effects import Effects
from tests.simulation.arms import (
    PERIOD,
    column,
    make,
    of_catalogue,
    quiet,
    run,
    without_losses,
)
from tests.simulation.plants import spring

TWO_R = Planar((0.5, 0.4), (2.0, 1.0), motor_masses=(0.5,))


def two_joints(law: str = "cubic", **constants: float) -> list[Plant]:
    given = constants or {"stiffness": 300.0, "cubic": 900.0}
    return [
        Plant(
            name=name,
            actuation="series",
            link=Body(1.0, damping),
            motors=(Body(inertia, 0.4),),
            transmissions=(spring(law, damping=0.3, **given),),
        )
        for name, inertia, damping in (("shoulder", 0.2, 0.1), ("elbow", 0.1, 0.05))
    ]


@pytest.mark.parametrize("name", ["planar-vsa-ii", "seven-axis", "manutec-r3"])
def test_energy_stays(name):
    """Free motion without friction, 10 s, at the steps the arm chooses by itself."""
    robot, plants, coupling = of_catalogue(name)
    plants = without_losses(plants)
    rng = np.random.default_rng(1)
    pose = rng.uniform(-0.4, 0.4, robot.size)
    start = [
        {"q": q} | {role: q + 0.004 for role in plant.motor_roles}
        for q, plant in zip(pose, plants, strict=True)
    ]
    arm = make(robot, plants, start, coupling)
    course = run(arm, quiet(plants, 10_001))
    assert course.stopped is None
    course = course._replace(at=tuple(at[::20] for at in course.at))
    energy = arm.energy(course.at)
    # what swings: kinetic and elastic energy, whose sum is what gravity gave and takes
    q, dq = column(course, "q"), column(course, "dq")
    swings = energy - [robot.potential_energy(at) for at in q]
    assert np.ptp(energy) <= 1e-6 * np.max(np.abs(swings))
    assert np.max(np.abs(dq)) > 1e-3


def test_against_an_integration_of_its_own():
    """Radau's cousin in scipy, tight, on the equations written out again."""
    plants = two_joints()
    arm = make(TWO_R, plants, [{"q": 0.7, "theta": 0.65}, {"q": -0.4, "dtheta": 2.0}])
    inputs = quiet(plants, 1001)
    inputs[1].tau[:, 0] = 3.0
    inputs[0].tau_ext[:] = -1.5
    course = run(arm, inputs)

    def f(t, y):
        q, theta, dq, dtheta = y.reshape(4, 2)
        phi, dphi = q - theta, dq - dtheta
        pull = 300.0 * phi + 900.0 * phi**3 + 0.3 * dphi
        net = np.array([-1.5, 0.0]) - pull - np.array([0.1, 0.05]) * dq
        ddq = np.linalg.solve(TWO_R.mass(q), net - TWO_R.bias(q, dq))
        ddtheta = (np.array([0.0, 3.0]) + pull - 0.4 * dtheta) / np.array([0.2, 0.1])
        return np.concatenate((dq, dtheta, ddq, ddtheta))

    start = np.array([0.7, -0.4, 0.65, 0.0, 0.0, 0.0, 0.0, 2.0])
    t = PERIOD * np.arange(1001)
    ours = np.column_stack((column(course, "q"), np.column_stack([a["theta"] for a in course.at])))
    # the motor's side of y is (q, theta, q', theta')
    reference = solve_ivp(f, (0.0, 1.0), start, "DOP853", t, rtol=1e-12, atol=1e-13).y[:4].T
    # steps are let pass at an estimated 1e-8 rad at most, truly a hundredth of it
    np.testing.assert_allclose(ours, reference, rtol=0.0, atol=2e-9)
    assert np.ptp(reference, axis=0).min() > 0.05


def test_coupling_of_motors_and_links():
    """At every sample [[M, S], [S^T, B]] (q'', theta'') is what the torques say."""
    robot, plants, coupling = of_catalogue("manutec-r3")
    assert np.any(coupling)
    S = 5.0 * coupling
    start = [{"q": 0.2, "theta": 0.203}, {"q": 0.5, "theta": 0.49}, {"q": -0.3, "dtheta": 0.4}]
    arm = make(robot, without_losses(plants), start, S)
    inputs = quiet(plants, 1001)
    course = run(arm, inputs)
    theta = np.column_stack([at["theta"][:, 0] for at in course.at])
    dtheta = np.column_stack([at["dtheta"][:, 0] for at in course.at])
    q, dq, ddq = (column(course, name) for name in ("q", "dq", "ddq"))
    B = np.array([plant.motors[0].inertia for plant in plants])
    K = np.array([474075.0, 352800.0, 208800.0])
    # d/dt of the motors' equation's momentum, differenced to sixth order: h^6 w^7 / 140 of it
    p = dq @ S + B * dtheta
    weights = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / (60.0 * PERIOD)
    rate = sum(w * p[i : p.shape[0] - 6 + i] for i, w in enumerate(weights))
    torque = K * (q - theta)
    np.testing.assert_allclose(rate, torque[3:-3], rtol=0.0, atol=2e-3 * np.abs(torque).max())
    k = 400
    left = robot.mass(q[k]) @ ddq[k] + robot.bias(q[k], dq[k]) + torque[k]
    # what is left of the links' equation is S theta''
    right = -S @ ((torque[k] - ddq[k] @ S) / B)
    np.testing.assert_allclose(left, right, rtol=0.0, atol=1e-9 * np.abs(torque).max())


def test_one_joint_arm_is_the_plant_of_one_joint():
    """Two independent integrators on the same joint: the compiled one and the arm's."""
    from rotatum.models.robot.pendulum import Pendulum
    from rotatum.simulation.plant.run import run_plant

    effects = Effects(load_friction=0.05, hysteresis_torque=1.0, backlash=2e-3)
    alone = Plant(
        name="elbow",
        actuation="series",
        link=Body(0.8, 0.3, 0.1),
        motors=(Body(0.256, 0.35, 0.8),),
        transmissions=(spring("cubic", stiffness=200.0, cubic=600.0, damping=0.05),),
        gravity_torque=15.0,
        effects=effects,
    )
    inputs = quiet([alone], 2001)
    inputs[0].tau[:, 0] = 8.0 * np.sin(2.0 * np.pi * inputs[0].time)
    one = run_plant(alone, inputs[0], substeps=100).at
    bare = replace(alone, link=Body(1.0, 0.3, 0.1), gravity_torque=0.0)
    arm = make(Pendulum(0.8, 15.0), [bare], [{}])
    other = run(arm, inputs).at[0]
    # each goes through the kinks of play, |phi'| and friction in its own steps, to some
    # 1e-5 s of where they are; the hysteresis of 1 N m builds up over 0.01 rad
    for name, atol in (("q", 1e-6), ("theta", 1e-6), ("hysteresis", 2e-5)):
        np.testing.assert_allclose(other[name], one[name], rtol=0.0, atol=atol)
    assert np.ptp(one["q"]) > 0.5


def test_mixed_joints():
    """Series, antagonistic and serial joints in one arm keep energy and find their own laws."""
    from rotatum.models.robot.packaged import read_urdf
    from rotatum.models.robot.urdf import UrdfRobot

    locked = {f"joint{j}": 0.2 for j in range(4, 8)}
    robot = UrdfRobot(read_urdf("seven-axis"), ("joint1", "joint2", "joint3"), locked)
    pair = spring("sinh", k=2.0, a=6.0)
    plants = [
        Plant("joint1", "series", Body(1.0), (Body(0.6),), (spring("linear", stiffness=4e3),)),
        Plant("joint2", "antagonistic", Body(1.0), (Body(0.4), Body(0.5)), (pair, pair)),
        Plant(
            "joint3",
            "serial",
            Body(1.0),
            (Body(0.3),),
            (spring("lever", spring=14220.0),),
            offset=0.1,
        ),
    ]
    start = [{"q": 0.1, "theta": 0.08}, {"theta1": -0.3, "theta2": 0.3}, {"dq": 0.05}]
    arm = make(robot, plants, start)
    course = run(arm, quiet(plants, 2001))
    energy = arm.energy(course.at)
    swings = energy - [robot.potential_energy(at) for at in column(course, "q")]
    assert np.ptp(energy) <= 1e-6 * np.max(np.abs(swings))
    at = course.at[1]
    total = sum(pair.torque(at["deflection"][:, m]) for m in range(2))
    np.testing.assert_allclose(at["torque_total"], total, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(course.at[2]["setpoint"], 0.1, rtol=1e-15)


def test_it_stops_where_a_spring_leaves_its_range():
    limited = [
        replace(p, transmissions=(spring("fourbar", spring=2.5, ratio=1.5),)) for p in two_joints()
    ]
    arm = make(TWO_R, limited, [{}, {}])
    inputs = quiet(limited, 4001)
    inputs[1].tau[:, 0] = 40.0
    course = run(arm, inputs)
    assert course.stopped is not None
    assert "elbow, t = " in str(course.stopped)
    assert "leaves its range" in str(course.stopped)
    low, high = limited[1].transmissions[0].limits()
    assert 10 < course.at[1].size < 4001
    assert course.at[0].size == course.at[1].size
    assert np.all((course.at[1]["deflection"] > low) & (course.at[1]["deflection"] < high))


def test_work_and_energy_balance():
    """Energy gained is the work of motors and outside, less what friction and dampers take."""
    plants = two_joints()
    arm = make(TWO_R, plants, [{"q": 0.3, "theta": 0.3}, {"q": 0.1, "theta": 0.1}])
    inputs = quiet(plants, 4001, 2.5e-4)
    time = inputs[0].time
    inputs[0].tau[:, 0] = np.repeat(20.0 * np.sin(7.0 * time[::40]), 40)[: time.size]
    inputs[1].tau_ext[:] = 2.0
    course = run(arm, inputs)
    energy = arm.energy(course.at)
    works = np.zeros(time.size - 1)
    for plant, row, at in zip(plants, inputs, course.at, strict=True):
        dtheta, dq = at["dtheta"][:, 0], at["dq"]
        # held torques' work is exact; losses by the trapezium, to h^2 / 12 of power''
        works += row.tau[:-1, 0] * np.diff(at["theta"][:, 0]) + row.tau_ext[:-1] * np.diff(at["q"])
        loss = 0.4 * dtheta**2 + plant.link.damping * dq**2 + 0.3 * (dq - dtheta) ** 2
        works -= 0.5 * 2.5e-4 * (loss[1:] + loss[:-1])
    gained = np.concatenate(([0.0], np.cumsum(works)))
    np.testing.assert_allclose(energy - energy[0], gained, rtol=0.0, atol=2e-6 * np.ptp(energy))
