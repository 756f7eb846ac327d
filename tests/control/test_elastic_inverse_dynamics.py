"""Inverse dynamics of elastic joints: closed forms, the equations themselves, the simulator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotatum.control import ElasticArm, RestToRest, desired_motion, inverse_dynamics
from rotatum.control.spring_inverse import deflections_for, inverted
from rotatum.errors import DeviceError, RotatumError
from rotatum.evaluation.loop import at_rest, without_friction
from rotatum.models.device import device_from_tables, load_device
from rotatum.models.transmission import Transmission
from rotatum.simulation import simulate
from tests.control.loops import PERIOD, planar_arm


def held(time, tau):
    """Drive that gives each torque from its instant on."""
    return lambda at: tau[np.rint((at - time[0]) / (time[1] - time[0])).astype(int)]


TIME = 5e-4 * np.arange(2001)
B, M, K, G = 0.2, 0.8, 150.0, 3.0
SWING = RestToRest(np.array([0.2]), np.array([1.0]), 0.1, 0.6)
R3 = without_friction(load_device("manutec-r3"))


def pendulum(**spring):
    joint = {
        "name": "arm",
        "motor": {"inertia": B},
        "link": {"inertia": M, "gravity_torque": G},
        "transmission": {"law": "linear", "stiffness": K, **spring},
    }
    return ElasticArm.of(device_from_tables(joint, "pendulum.toml"))


def test_a_pendulum_without_damping_is_the_closed_form():
    found = inverse_dynamics(pendulum(), SWING, TIME)
    q, dq, ddq, dddq, d4q = SWING.derivatives(TIME, 4)[:, :, 0]
    load = M * ddq + G * np.sin(q)
    rate = M * dddq + G * np.cos(q) * dq
    bend = M * d4q + G * (np.cos(q) * ddq - np.sin(q) * dq**2)
    ddtheta = ddq + bend / K
    # a spline of degree 7 through steps of 0.5 ms; theta itself is exact
    np.testing.assert_allclose(found.theta[:, 0], q + load / K, atol=1e-13)
    np.testing.assert_allclose(found.dtheta[:, 0], dq + rate / K, atol=1e-9)
    np.testing.assert_allclose(found.tau[:, 0], B * ddtheta + load, atol=1e-6 * np.max(ddtheta))
    assert found.roughness < 1e-8


@pytest.mark.parametrize("damping", [0.02, 0.2, 30.0])
def test_spring_damping_is_the_stable_solution_of_its_equation(damping):
    # time constants of 1.3e-4 s, 1.3e-3 s and 0.2 s against steps of 5e-4 s
    load = 5.0 + 4.0 * np.sin(9.0 * TIME) ** 3
    spring = Transmission(law="linear", stiffness=K, damping=damping)
    found = deflections_for(spring, load, 5e-4)

    def slope(t, x):
        push, more = 5.0 + 4.0 * np.sin(9.0 * t) ** 3, 108.0 * np.sin(9.0 * t) ** 2
        return [(push - K * x[0]) / damping, (more * np.cos(9.0 * t) - K * x[1]) / damping]

    twin = solve_ivp(slope, (0.0, 1.0), [5.0 / K, 0.0], "LSODA", TIME, rtol=1e-11, atol=1e-13)
    # what the reference's tolerances allow; the torque's third derivative jumps nowhere
    np.testing.assert_allclose(found.phi, twin.y[0], atol=1e-9)
    np.testing.assert_allclose(found.dphi, twin.y[1], atol=1e-7)


def test_a_law_that_is_not_linear_is_inverted_with_and_without_damping():
    load = 3.0 * np.sin(5.0 * TIME) ** 4
    hard = Transmission(law="cubic", stiffness=40.0, cubic=900.0)
    found = deflections_for(hard, load, 5e-4)
    np.testing.assert_allclose(hard.torque(found.phi), load, atol=1e-12)
    rate = 60.0 * np.sin(5.0 * TIME) ** 3 * np.cos(5.0 * TIME)
    np.testing.assert_allclose(hard.stiffness(found.phi) * found.dphi, rate, atol=1e-7)
    damped = deflections_for(hard.model_copy(update={"damping": 0.4}), load[:401], 5e-4)
    # the equation, and the derivatives against differences of 0.5 ms: h^2/6 of phi''' and phi''''
    still = hard.torque(damped.phi) + 0.4 * damped.dphi
    np.testing.assert_allclose(still, load[:401], atol=1e-9)
    for lower, higher in ((damped.phi, damped.dphi), (damped.dphi, damped.ddphi)):
        slope = np.gradient(lower, 5e-4)[1:-1]
        np.testing.assert_allclose(slope, higher[1:-1], atol=1e-4 * np.max(np.abs(higher)))


def test_a_linear_law_by_either_way():
    load = 3.0 * np.sin(5.0 * TIME[:401]) ** 4
    linear = Transmission(law="linear", stiffness=40.0, damping=0.4)
    same = Transmission(law="odd_polynomial", coefficients=[40.0], damping=0.4)
    for one, other in zip(
        deflections_for(linear, load, 5e-4), deflections_for(same, load, 5e-4), strict=True
    ):
        # the implicit way's tolerance, over 400 steps
        np.testing.assert_allclose(one, other, atol=1e-8 * np.max(np.abs(one)))


def test_the_motion_satisfies_both_rows_of_the_equations_with_coupling_and_damping():
    arm = ElasticArm.of(planar_arm())
    motion = RestToRest(np.array([0.3, -0.4]), np.array([1.2, 0.5]), 0.05, 0.5)
    x = inverse_dynamics(arm, motion, TIME)
    elastic = 400.0 * (x.theta - x.q) + 0.8 * (x.dtheta - x.dq)
    rigid = [arm.robot.inverse_dynamics(*row) for row in zip(x.q, x.dq, x.ddq, strict=True)]
    # deluca2007 eq. 2, both rows; phi' comes out of its own equation, not of phi
    links = np.array(rigid) + x.ddtheta @ arm.coupling.T - elastic
    motors = x.ddq @ arm.coupling + 0.05 * x.ddtheta + elastic - x.tau
    for miss in (links, motors):
        np.testing.assert_allclose(miss, 0.0, atol=1e-8 * np.max(np.abs(x.tau)))
    for lower, higher in ((x.theta, x.dtheta), (x.dtheta, x.ddtheta)):
        slope = np.gradient(lower, TIME, axis=0)[1:-1]
        # differences over 0.5 ms
        np.testing.assert_allclose(slope, higher[1:-1], atol=1e-3 * np.max(np.abs(higher)))


@pytest.mark.parametrize(
    ("device", "start", "way", "seconds"),
    [(planar_arm(), [0.3, -0.4], [0.9, 0.9], 0.5), (R3, [0.3, 0.5, 0.4], [0.2, -0.15, 0.2], 0.5)],
    ids=["planar", "r3"],
)
def test_fed_open_loop_to_the_simulator_the_links_follow(device, start, way, seconds):
    arm = ElasticArm.of(device)
    motion = RestToRest(np.array(start), np.array(start) + way, 0.05, seconds)
    x = desired_motion(arm, motion, PERIOD, seconds + 0.15)
    drives = {name: {"tau": held(x.time, x.tau[:, i])} for i, name in enumerate(arm.names)}
    log = simulate(
        device, seconds=seconds + 0.15, period=PERIOD, drives=drives, start=at_rest(x, arm.names)
    )
    for i, name in enumerate(arm.names):
        q, torsion = log.joints[name]["q_true"], np.max(np.abs(x.theta - x.q)[:, i])
        # torques held over 1 ms leave T^2/24 of their second derivative; nothing holds the arm
        assert np.max(np.abs(q - x.q[:, i])) < 1e-2 * torsion


def test_friction_of_the_motors_is_fed_forward():
    rubbing = load_device("manutec-r3")
    motion = RestToRest(np.zeros(3), np.full(3, 0.1), 0.05, 0.4)
    smooth = inverse_dynamics(ElasticArm.of(R3), motion, TIME)
    rough = inverse_dynamics(ElasticArm.of(rubbing), motion, TIME)
    arm = ElasticArm.of(rubbing)
    more = arm.viscous * rough.dtheta + arm.coulomb * np.tanh(rough.dtheta / 5e-3)
    np.testing.assert_allclose(rough.tau, smooth.tau + more, atol=1e-9)
    without = inverse_dynamics(arm, motion, TIME, friction=False)
    np.testing.assert_array_equal(without.tau, smooth.tau)


def test_what_has_no_inverse_is_refused():
    with pytest.raises(DeviceError, match="one motor and one spring"):
        ElasticArm.of(load_device("vsa-ii"))
    with pytest.raises(RotatumError, match="another number of links"):
        inverse_dynamics(pendulum(), RestToRest(np.zeros(2), np.ones(2), 0.0, 1.0), TIME)
    with pytest.raises(RotatumError, match="evenly spaced"):
        inverse_dynamics(pendulum(), SWING, TIME**2)
    with pytest.raises(RotatumError, match="more instants"):
        inverse_dynamics(pendulum(), SWING, TIME[:5])
    soft = Transmission(law="cubic", stiffness=40.0, cubic=-900.0)
    with pytest.raises(RotatumError, match="no deflection"):
        inverted(soft, np.array([100.0]))
