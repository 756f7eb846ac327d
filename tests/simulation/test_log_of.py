"""One log of many joints: what is in it, when its rows are, and whose faults they have."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from rotatum.errors import RotatumError, SimulationError
from rotatum.evaluation import estimate
from rotatum.logs import read_log, write_table
from rotatum.models import device_from_tables
from rotatum.models.robot.pendulum import Pendulum
from rotatum.simulation import Sensors, multisine, plant_of, simulate_joint, sine
from rotatum.simulation.demo import DEVICE
from rotatum.simulation.drivers.drives import sample_drives
from rotatum.simulation.motion import Motion, Truth
from rotatum.simulation.plant.effects import Effects, StiffnessDrift
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.sensing.inertial import InertialFaults
from rotatum.simulation.sensing.log import log_of
from rotatum.simulation.sensing.trajectory import trajectory
from tests.simulation.joints import AWAS, VSA

PERIOD = 1e-3
SECONDS = 1.5
DRIVES = {
    "demo": {"tau": multisine(rms=6.0, low=0.5, high=10.0, count=10, seed=0)},
    "vsa": {"tau1": sine(0.3, 2.0), "tau2": sine(0.2, 3.0)},
    "awas": {"tau": sine(20.0, 1.0), "setpoint": lambda t: 0.08 + 0.01 * np.sin(3.0 * t)},
}
TEXTS = {"demo": DEVICE, "vsa": VSA, "awas": AWAS}
FAULTY = Sensors(
    noise={"q": 1e-4, "torque_measured": 0.1},
    delay={"q": 3.5e-4},
    deflection_zero=0.01,
    stale=4,
    nans=3,
    repeats=5,
    dropouts=2,
    dropout_rows=3,
)


def _device(*names):
    tables = [tomllib.loads(TEXTS[name]) | {"name": f"{name}{n}"} for n, name in enumerate(names)]
    return device_from_tables({"name": "arm", "joint": tables}, "test")


def _motion(device, period=PERIOD, **changes):
    """Move each joint on its own, as a pendulum."""
    time = np.arange(round(SECONDS / period)) * period
    joints, truth, acceleration = {}, {}, {}
    for joint in device.joints:
        plant = plant_of(joint)
        drives = next(d for name, d in DRIVES.items() if joint.name.startswith(name))
        inputs = sample_drives(joint, plant, time, drives)
        at = run_plant(plant, inputs).at
        joints[joint.name] = trajectory(plant, inputs, at)
        truth[joint.name] = Truth(tuple(at["stiffness"].T), tuple(at["torque"].T))
        acceleration[joint.name] = np.gradient(at["dq"], time)
    return Motion(time, joints, truth, acceleration, **changes)


PAIR = _device("demo", "demo")
MOTION = _motion(PAIR)
IDEAL = log_of(MOTION, PAIR)


@pytest.mark.parametrize("sensors", [None, FAULTY])
@pytest.mark.parametrize("name", TEXTS)
def test_the_first_joint_is_logged_as_one_joint_alone_is(name, sensors):
    device = _device(name)
    joint = device.joints[0]
    options = {"sensors": sensors, "seed": 5, "external": None}
    alone = simulate_joint(joint, seconds=SECONDS, period=PERIOD, drives=DRIVES[name], **options)
    log = log_of(_motion(device), device, sensors={joint.name: sensors or Sensors()}, seed=5)
    np.testing.assert_array_equal(log.time, alone.time)
    for role, x in alone.joints[joint.name].items():
        np.testing.assert_array_equal(log.joints[joint.name][role], x)
        assert log.holds[joint.name][role] == alone.holds[joint.name][role]
    assert log.clock == alone.clock
    assert log.warnings == alone.warnings


def test_truth_of_laws_and_motion_is_written_along():
    device = _device("vsa", "awas")
    motion = _motion(device)
    log = log_of(motion, device)
    one, two = (log.joints[joint.name] for joint in device.joints)
    moved = motion.joints["vsa0"]
    np.testing.assert_array_equal(one["theta2_true"], moved.position["theta2"])
    np.testing.assert_array_equal(one["dtheta2_true"], moved.velocity["theta2"])
    np.testing.assert_array_equal(one["stiffness2_true"], motion.truth["vsa0"].stiffness[1])
    np.testing.assert_array_equal(one["torque_true"], sum(motion.truth["vsa0"].torque))
    np.testing.assert_array_equal(two["setpoint_true"], motion.joints["awas1"].position["setpoint"])
    assert "setpoint_true" not in one
    # half a count of the encoder beside the reading, and rounding
    assert np.max(np.abs(one["q"] - one["q_true"])) <= np.pi / 4059 + 1e-12


def test_joints_have_faults_of_their_own():
    noise = dict.fromkeys(("q", "theta", "torque_measured"), 1.0)
    sensors = {"demo0": Sensors(noise=noise, counts={}), "demo1": Sensors(noise=noise, counts={})}
    log = log_of(MOTION, PAIR, sensors=sensors, seed=2)
    ideal = log_of(MOTION, PAIR, sensors=dict.fromkeys(sensors, Sensors(counts={})))
    drawn = [log.joints[j][r] - ideal.joints[j][r] for j in log.joints for r in noise]
    # four standard deviations of a correlation of 1500 pairs
    assert np.max(np.abs(np.corrcoef(drawn) - np.eye(6))) < 4.0 / np.sqrt(1500)
    only = log_of(MOTION, PAIR, sensors={"demo1": sensors["demo1"]}, seed=2)
    for role, x in log.joints["demo1"].items():
        np.testing.assert_array_equal(only.joints["demo1"][role], x)
    np.testing.assert_array_equal(only.joints["demo0"]["q"], IDEAL.joints["demo0"]["q"])


def test_rows_are_the_whole_logs():
    rows = Sensors(repeats=7, dropouts=3, dropout_rows=4, clock_rate=0.01)
    log = log_of(MOTION, PAIR, sensors={"demo1": rows}, seed=3)
    assert log.samples == 1500 + 7 - 12
    at = np.rint(log.time / (1.01 * PERIOD)).astype(int)
    np.testing.assert_allclose(log.time, 1.01 * MOTION.time[at], rtol=1e-15)
    assert np.count_nonzero(np.diff(at) == 0) == 7
    for name, channels in log.joints.items():
        for role, x in channels.items():
            np.testing.assert_array_equal(x, IDEAL.joints[name][role][at])
    assert log.period == 1.01 * PERIOD
    with pytest.raises(RotatumError, match="demo0 and demo1 differ in clock_rate"):
        log_of(MOTION, PAIR, sensors={"demo0": Sensors(), "demo1": rows})


def test_truth_belongs_to_the_instants_the_clock_shows():
    jitter = {name: Sensors(jitter=2e-4, counts={}) for name in IDEAL.joints}
    log = log_of(MOTION, PAIR, sensors=jitter)
    channels = log.joints["demo1"]
    inside = (log.time >= 0.0) & (log.time <= MOTION.time[-1])
    assert np.std(log.time - MOTION.time) > 1e-4
    # read at one and the same instants
    np.testing.assert_array_equal(channels["q_true"][inside], channels["q"][inside])
    expected = np.interp(log.time, MOTION.time, MOTION.truth["demo1"].stiffness[0])
    np.testing.assert_allclose(channels["stiffness_true"], expected, rtol=1e-14)
    hidden = {name: Sensors(jitter=2e-4, counts={}, stamped=False) for name in IDEAL.joints}
    other = log_of(MOTION, PAIR, sensors=hidden)
    np.testing.assert_array_equal(other.time, MOTION.time)
    np.testing.assert_array_equal(other.joints["demo1"]["q"], channels["q"])
    np.testing.assert_array_equal(other.joints["demo1"]["q_true"], IDEAL.joints["demo1"]["q_true"])


@pytest.mark.parametrize(
    ("control", "every", "commands", "external"),
    [
        (1, 1, "held", "held"),
        (5, 1, "held", "held"),
        (5, 5, "held", "sampled"),
        (6, 3, "held", "sampled"),
        (5, 10, "sampled", "sampled"),
        (5, 2, "sampled", "sampled"),
        (1, 4, "sampled", "sampled"),
    ],
)
def test_torques_are_held_only_where_they_last_until_the_next_row(
    control, every, commands, external
):
    log = log_of(MOTION, PAIR, control=control, every=every, external=frozenset({"demo0"}))
    assert log.holds["demo0"]["tau"] == commands
    assert log.holds["demo0"]["tau_ext"] == external
    assert log.holds["demo0"]["q"] == "sampled"
    assert "tau_ext" not in log.joints["demo1"]
    np.testing.assert_array_equal(log.time, MOTION.time[::every])
    for role, x in IDEAL.joints["demo1"].items():
        np.testing.assert_array_equal(log.joints["demo1"][role], x[::every])
    assert log.period == every * PERIOD


def test_a_torque_sensor_feels_play_hysteresis_and_drift():
    joint = _device("demo").joints[0]
    effects = Effects(backlash=5e-3, hysteresis_torque=1.5, drift=StiffnessDrift(rate=-0.2))
    spring = joint.transmissions[0].model_copy(update={"damping": 0.05})
    plant = replace(plant_of(joint, effects=effects), transmissions=(spring,))
    inputs = sample_drives(joint, plant, MOTION.time, DRIVES["demo"])
    at = run_plant(plant, inputs).at
    moved = trajectory(plant, inputs, at)
    # rounding of 50 N m
    np.testing.assert_allclose(moved.transmitted[0], at["transmitted"][:, 0], atol=1e-12)
    late = moved.before(2 * PERIOD).transmitted[0]
    np.testing.assert_allclose(late[2:], at["transmitted"][:-2, 0], atol=1e-12)
    beyond = moved.elastic[0] - at["torque"][:, 0]
    assert np.max(np.abs(beyond)) > 1.0  # there is something to feel


ARM = """\
name = "arm"
[robot]
model = "pendulum"
lengths = [0.5]
masses = [1.0]
[[accelerometer]]
name = "imu"
frame = "tip"
[[gyroscope]]
name = "imu"
frame = "tip"
axes = ["y"]
[[accelerometer]]
name = "other"
frame = "link"
"""


def test_inertial_sensors_are_in_the_log_with_its_rows():
    tables = tomllib.loads(ARM) | {"joint": [tomllib.loads(DEVICE)]}
    device = device_from_tables(tables, "test")
    motion = _motion(_device("demo"), robot=Pendulum(0.8, 15.0, 0.5))
    (name,) = (joint.name for joint in device.joints)
    motion = Motion(
        motion.time,
        {name: motion.joints["demo0"]},
        {name: motion.truth["demo0"]},
        {name: motion.acceleration["demo0"]},
        robot=motion.robot,
    )
    sensors = {name: Sensors(dropouts=3, jitter=1e-4)}
    faults = {"other": InertialFaults(bias=(1.0, 0.0, 0.0))}
    log = log_of(motion, device, sensors=sensors, inertial=faults)
    columns = log.columns()
    assert set(columns) >= {"imu.ax", "imu.ay", "imu.az", "imu.gy", "other.ax", f"{name}.q_true"}
    assert {x.size for x in columns.values()} == {1497}
    # of the same instants as the truth
    np.testing.assert_allclose(columns["imu.gy"], -columns[f"{name}.dq_true"], atol=1e-14)
    rest = log_of(motion, device).inertial["other"]
    q = motion.joints[name].position["q"]
    np.testing.assert_allclose(rest["ax"], 9.81 * np.sin(q), atol=1e-13)


def test_what_is_written_along_troubles_no_reader(tmp_path):
    device = _device("demo")
    log = log_of(_motion(device), device)
    path = tmp_path / "log.npz"
    write_table(path, log.columns())
    again = read_log(path, device)
    assert set(again.joints["demo0"]) == {
        *("q", "theta", "tau", "torque_measured", "stiffness_true", "torque_true")
    }
    for role, x in again.joints["demo0"].items():
        np.testing.assert_array_equal(x, log.joints["demo0"][role])
    here, there = (estimate(x, device).joints["demo0"] for x in (log, again))
    # the reader finds the period from the clock, right to rounding
    np.testing.assert_allclose(here.coefficients, there.coefficients, rtol=1e-12)


def test_a_motion_that_stopped_says_so():
    stopped = SimulationError("the joint ran away", where="demo0, t = 1.5 s")
    motion = Motion(
        MOTION.time, MOTION.joints, MOTION.truth, MOTION.acceleration, None, ("odd.",), stopped
    )
    log = log_of(motion, PAIR)
    assert log.warnings[0] == "odd."
    assert "stopped after 1.499 s" in log.warnings[1]
    assert "ran away" in log.warnings[1]


def test_what_cannot_be_is_refused_by_name():
    with pytest.raises(RotatumError, match="Did you mean 'demo1'"):
        log_of(MOTION, PAIR, sensors={"demo2": Sensors()}, external=frozenset())
    with pytest.raises(RotatumError, match="external"):
        log_of(MOTION, PAIR, external=frozenset({"nobody"}))
    with pytest.raises(RotatumError, match="theta1"):
        log_of(MOTION, PAIR, sensors={"demo1": Sensors(gain={"theta1": 2.0})})
    with pytest.raises(RotatumError, match="at least two samples"):
        log_of(MOTION, PAIR, every=1500)
    with pytest.raises(RotatumError, match="whole number"):
        log_of(MOTION, PAIR, every=0)
    with pytest.raises(RotatumError, match="do not fit"):
        log_of(MOTION, PAIR, sensors={"demo0": Sensors(stale=2000)})
