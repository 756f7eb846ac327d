"""Sensors in the loop against the log of the same run; accelerations against the equations."""

from dataclasses import replace

import numpy as np
import pytest

from rotatum.errors import RotatumError
from rotatum.models.device import load_device
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.simulation import InertialFaults, Seen, Sensors, plant_of, simulate
from rotatum.simulation.drivers.arm_control import ArmControl
from rotatum.simulation.drivers.drives import sample_drives
from rotatum.simulation.plant.lockstep import run_joints
from rotatum.simulation.sensing.live import LiveSensors
from tests.simulation.joints import series_joint

PERIOD = 1e-3
ROWS = 60
DEVICE = replace(
    load_device("manutec-r3"),
    accelerometers=(
        Accelerometer(name="tool", frame="flange", position=(0.1, 0.0, 0.2), axes=("x", "z")),
        Accelerometer(name="arm", frame="body2"),
    ),
    gyroscopes=(Gyroscope(name="spin", frame="body3", axes=("y",)),),
)
NAMES = tuple(joint.name for joint in DEVICE.joints)
FAULTS = {
    "axis1": Sensors(
        noise={"theta": 1e-5, "q": 2e-5}, counts={"theta": 1e6, "q": 1e5}, delay={"theta": 2e-3}
    ),
    "axis3": Sensors(
        gain={"tau": 1.1}, offset={"theta": 0.3}, eccentricity={"q": 1e-3}, deflection_zero=0.01,
        wrap={"theta": 0.2}, saturation={"tau": 30.0},
    ),
}  # fmt: skip
INERTIAL = {
    "tool": InertialFaults(noise=0.1, bias=(0.2, 0.0, -0.1), delay=3e-3),
    "arm": InertialFaults(misalignment=(0.02, 0.0, 0.01), resolution=0.01, saturation=12.0),
    "spin": InertialFaults(noise=0.01),
}


def run():
    """Return the log, what was read in its loop, and the true motion seen there."""
    sensors = LiveSensors(DEVICE, FAULTS, INERTIAL, seed=5, period=PERIOD)
    read, truth = [], []

    def controller(seen: Seen):
        read.append(sensors.read(seen))
        assert sensors.read(seen) is read[-1]
        truth.append((seen.q.copy(), seen.dq.copy(), seen.ddq.copy()))
        return np.array([300.0, -200.0, 100.0]) * np.sin(40.0 * seen.time) + 20.0

    log = simulate(
        DEVICE,
        seconds=ROWS * PERIOD,
        period=PERIOD,
        drives=ArmControl(controller, DEVICE.joints).drives(),
        sensors=FAULTS,
        inertial=INERTIAL,
        seed=5,
    )
    return log, read, truth


LOG, READ, TRUTH = run()


@pytest.mark.parametrize("role", ["q", "theta"])
def test_encoders_show_what_the_log_of_the_run_has(role):
    for place, name in enumerate(NAMES):
        live = [readings.joints[role][place] for readings in READ]
        np.testing.assert_array_equal(live, LOG.joints[name][role])


def test_torques_are_those_that_acted_until_now():
    for place, name in enumerate(NAMES):
        live = [readings.tau[place] for readings in READ]
        np.testing.assert_array_equal(live[1:], LOG.joints[name]["tau"][:-1])
        assert live[0] == 0.0


def test_inertial_sensors_show_what_the_log_has_up_to_the_torques_that_act_from_now_on():
    columns = [LOG.inertial["tool"][axis] for axis in ("ax", "az")]
    columns += [LOG.inertial["arm"][axis] for axis in ("ax", "ay", "az")]
    # past the first instant, three samples late: this arm falls from it, and just before it stood
    live, logged = np.array([readings.acc for readings in READ])[4:], np.column_stack(columns)[4:]
    # S of the elbow's rotor makes its torques felt at once: 0.078/4.7 of a step of at most 40 N m,
    # over 11 kg m^2, a metre away; rounded to 0.01 on top
    np.testing.assert_allclose(live, logged, atol=0.1)
    # but for those, over most samples and where torques change least, the same
    assert np.median(np.abs(live - logged)) < 2e-3
    spin = [readings.gyro[0] for readings in READ]
    np.testing.assert_array_equal(spin, LOG.inertial["spin"]["gy"])


def test_accelerations_are_those_of_the_equations_just_before_the_torques():
    robot, coupling = DEVICE.build_robot(), DEVICE.robot.coupling_matrix
    plants = [plant_of(joint) for joint in DEVICE.joints]
    B = np.diag([plant.motors[0].inertia for plant in plants])
    for k in range(1, ROWS):
        q, dq, ddq = TRUTH[k]
        columns = [LOG.joints[name] for name in NAMES]
        tau = np.array([c["tau"][k - 1] for c in columns]) / [1.0, 1.0, 1.1]
        if abs(columns[2]["tau"][k - 1]) == 30.0:
            continue  # the log's reading of this torque is at its limit
        theta, dtheta = (
            np.array([c[r][k] for c in columns]) for r in ("theta_true", "dtheta_true")
        )
        pull = np.array(
            [
                p.transmissions[0].torque(a - b).item() + p.transmissions[0].damping * (da - db)
                for p, a, b, da, db in zip(plants, q, theta, dq, dtheta, strict=True)
            ]
        )
        rub = np.array(
            [
                p.motors[0].damping * v + p.motors[0].coulomb * np.tanh(v / p.smoothing)
                for p, v in zip(plants, dtheta, strict=True)
            ]
        )
        whole = np.block([[robot.mass(q), coupling], [coupling.T, B]])
        push = np.concatenate([-robot.bias(q, dq) - pull, tau + pull - rub])
        # the log keeps the state to rounding
        np.testing.assert_allclose(ddq, np.linalg.solve(whole, push)[:3], rtol=1e-9, atol=1e-9)
    assert not np.any(TRUTH[0][2])


def test_joints_without_an_arm_tell_their_accelerations_too():
    joint = series_joint(motor={"inertia": 0.3}, link={"inertia": 0.5})
    plant, time, seen_at = plant_of(joint), PERIOD * np.arange(80), []

    class Watch:
        def torque(self, seen: Seen) -> float:
            seen_at.append((seen.ddq.item(), seen.tau[joint.name].item()))
            return 3.0 * np.cos(30.0 * seen.time)

    inputs = sample_drives(joint, plant, time, {"tau": Watch()})
    (course,) = run_joints([plant], [inputs], start={}, added={})
    ddq, tau = np.array(seen_at).T
    # of a link no torque acts on directly it is the same just after; Runge-Kutta's last part
    np.testing.assert_allclose(ddq[1:], course.at["ddq"][1:], atol=1e-5 * np.max(np.abs(ddq)))
    np.testing.assert_array_equal(tau[1:], inputs.tau[:-1, 0])


@pytest.mark.parametrize(
    ("sensors", "inertial", "where"),
    [
        ({"axis1": Sensors(delay={"theta": 1.5e-3})}, {}, "axis1, sensors.delay.theta"),
        ({"axis2": Sensors(stale=3)}, {}, "axis2, sensors.stale"),
        ({"axis2": Sensors(jitter=1e-4)}, {}, "axis2, sensors.jitter"),
        ({"axis": Sensors()}, {}, "sensors"),
        ({}, {"tool": InertialFaults(delay=4e-4)}, "inertial.tool.delay"),
        ({}, {"hand": InertialFaults()}, "inertial"),
    ],
)
def test_what_a_loop_cannot_have_is_refused(sensors, inertial, where):
    with pytest.raises(RotatumError) as caught:
        LiveSensors(DEVICE, sensors, inertial, period=PERIOD)
    assert caught.value.where == where


def test_a_controller_gives_one_torque_for_each_motor():
    drives = ArmControl(lambda seen: np.zeros(2), DEVICE.joints).drives()
    with pytest.raises(RotatumError, match="one torque for each motor"):
        simulate(DEVICE, seconds=0.01, period=PERIOD, drives=drives)
