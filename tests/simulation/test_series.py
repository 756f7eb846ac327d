"""Logs with known truth: roles, truth columns, limits, and what is refused."""

import time
import tomllib

import numpy as np
import pytest

from rotatum.errors import DeviceError, RotatumError
from rotatum.models import device_from_tables
from rotatum.simulation import Sensors, demo_log, plant_of, simulate_series, sine
from rotatum.simulation.demo import DEVICE

TABLES = tomllib.loads(DEVICE)
JOINT = device_from_tables(TABLES, "test").joints[0]


def _simulate(joint=JOINT, **changes):
    settings = {"seconds": 1.0, "period": 1e-3, "torque": sine(20.0, 2.0), **changes}
    return simulate_series(joint, **settings)


def _joint(**changes):
    """The demo's joint with keys of its tables changed, or a table taken away (None)."""
    tables = {**TABLES, **changes}
    return device_from_tables({k: v for k, v in tables.items() if v is not None}, "test").joints[0]


def test_plant_has_the_constants_of_the_device_at_the_joint():
    plant = plant_of(JOINT)
    assert plant.motor_inertia == pytest.approx(4e-5 * 6400, rel=1e-15)
    assert plant.motor_damping == pytest.approx(5e-5 * 6400, rel=1e-15)
    assert plant.motor_coulomb == pytest.approx(0.8, rel=1e-15)
    assert plant[:4] == (0.8, 1.0, 0.1, 15.0)
    assert (plant.stiffness, plant.cubic, plant.spring_damping) == (200.0, 1500.0, 0.0)


def test_a_linear_law_has_no_cubic_constant():
    joint = _joint(transmission={"law": "linear", "stiffness": 150.0, "damping": 0.2})
    assert plant_of(joint)[7:10] == (150.0, 0.0, 0.2)
    assert np.all(_simulate(joint).joints["demo-elbow"]["stiffness_true"] == 150.0)


def test_log_has_the_roles_of_a_series_joint_and_truth():
    log = _simulate()
    roles = {"q", "theta", "tau", "torque_measured", "stiffness_true", "torque_true"}
    assert set(log.joints["demo-elbow"]) == roles
    assert log.holds["demo-elbow"] == {r: "held" if r == "tau" else "sampled" for r in roles}
    assert (log.samples, log.period, log.warnings) == (1000, 1e-3, ())
    np.testing.assert_allclose(np.diff(log.time), 1e-3, rtol=1e-9)


def test_truth_belongs_to_the_true_motion():
    seen = _simulate(sensors=Sensors(counts={})).joints["demo-elbow"]
    phi = seen["q"] - seen["theta"]
    # rounding
    np.testing.assert_allclose(seen["stiffness_true"], 200.0 + 4500.0 * phi**2, rtol=1e-13)
    np.testing.assert_allclose(seen["torque_true"], 200.0 * phi + 1500.0 * phi**3, atol=1e-12)
    faulty = Sensors(deflection_zero=0.05, delay={"q": 5e-3}, noise={"theta": 1e-2})
    for role in ("stiffness_true", "torque_true"):
        blurred = _simulate(sensors=faulty).joints["demo-elbow"][role]
        np.testing.assert_array_equal(blurred, seen[role])


def test_the_device_s_encoders_count_unless_the_sensors_say_otherwise():
    ideal = _simulate(sensors=Sensors(counts={})).joints["demo-elbow"]
    for sensors, q, theta in ((None, 32768, 65536), (Sensors(counts={"q": 512}), 512, None)):
        seen = _simulate(sensors=sensors).joints["demo-elbow"]
        for role, counts in (("q", q), ("theta", theta)):
            error = np.max(np.abs(seen[role] - ideal[role]))
            step = 2 * np.pi / counts if counts else 0.0
            # a second of motion meets the middle between two counts to a tenth
            assert 0.9 * step / 2 <= error <= step / 2 * (1 + 1e-9)


def test_motion_obeys_the_motor_s_balance():
    """B theta'' + D theta' + friction - tau_e = tau, integrated over the log: no sign is wrong."""
    joint = _joint(motor={"inertia": 4e-5, "damping": 5e-5, "gear_ratio": -80.0})
    seen = _simulate(joint, sensors=Sensors(counts={})).joints["demo-elbow"]
    inertia, damping, period = 0.256, 0.32, 1e-3
    velocity = np.gradient(seen["theta"], period, edge_order=2)
    spring = np.cumsum(seen["torque_measured"][1:] + seen["torque_measured"][:-1]) * period / 2
    impulse = np.cumsum(seen["tau"][:-1]) * period
    momentum = inertia * velocity[1:] + damping * seen["theta"][1:]
    # differences over 1 ms miss h/2 of each step of the held torque: 20 N m x 2 pi 2 Hz x (1 ms)^2
    np.testing.assert_allclose(momentum[5:-5], (spring + impulse)[5:-5], atol=1e-3)


def test_external_torque_moves_the_link_and_is_logged():
    pushed = _simulate(torque=sine(0.0, 1.0), external=lambda t: np.full_like(t, 4.0))
    seen = pushed.joints["demo-elbow"]
    np.testing.assert_array_equal(seen["tau_ext"], 4.0)
    assert pushed.holds["demo-elbow"]["tau_ext"] == "held"
    assert seen["q"][-1] > 0.1
    # the spring passes it on to the resting motor: it stretches in the direction of the push
    assert seen["torque_true"].max() > 0.5


def test_torque_is_limited_as_the_motor_s():
    for gear_ratio in (80.0, -80.0):
        motor = {**TABLES["motor"], "gear_ratio": gear_ratio, "torque_limit": 0.125}
        tau = _simulate(_joint(motor=motor)).joints["demo-elbow"]["tau"]
        assert (tau.min(), tau.max()) == (-10.0, 10.0)  # 0.125 N m times 80


def test_lost_and_doubled_rows_concern_truth_and_clock_too():
    ideal = _simulate()
    log = _simulate(sensors=Sensors(dropouts=3, dropout_rows=4, repeats=2), seed=1)
    assert log.samples == 1000 - 12 + 2 - _both(log)
    at = np.searchsorted(ideal.time, log.time)
    for role, x in log.joints["demo-elbow"].items():
        np.testing.assert_array_equal(x, ideal.joints["demo-elbow"][role][at])
    assert log.clock.missing == 12
    assert log.clock.repeated == 2 - _both(log)
    assert log.warnings == tuple(log.clock.describe())
    assert len(log.warnings) == 2


def _both(log):
    """Rows drawn for doubling that fell into a gap."""
    return 2 - int(np.count_nonzero(np.diff(log.time) == 0.0))


def test_same_seed_same_log_bit_for_bit():
    sensors = Sensors(noise={"tau": 0.1}, dropouts=2, nans=3)
    first, second, other = (_simulate(sensors=sensors, seed=s) for s in (5, 5, 6))
    for role, x in first.joints["demo-elbow"].items():
        np.testing.assert_array_equal(x, second.joints["demo-elbow"][role])
    assert not np.array_equal(first.time, other.time)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"motor": None}, "motor.inertia"),
        ({"motor": {"gear_ratio": 80.0}}, "motor.inertia"),
        ({"link": None}, "link.inertia"),
        ({"link": {"damping": 1.0}}, "link.inertia"),
        ({"transmission": {}}, "transmission.law"),
        ({"actuation": "serial"}, "only series joints"),
    ],
)
def test_joints_without_a_plant_are_refused_saying_what_is_missing(changes, match):
    with pytest.raises(DeviceError, match=match):
        _simulate(_joint(**changes))


@pytest.mark.parametrize(
    "changes",
    [
        {"period": 0.0},
        {"period": -1e-3},
        {"seconds": 1e-3},
        {"seconds": float("nan")},
        {"seconds": float("inf")},
        {"torque": lambda t: t[:-1]},
        {"torque": lambda t: np.full_like(t, np.nan)},
        {"substeps": 0},
    ],
)
def test_impossible_simulations_are_refused(changes):
    with pytest.raises(RotatumError):
        _simulate(**changes)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_demo_excites_its_spring_and_stays_in_its_declared_range(seed):
    device, log = demo_log(seed)
    seen = log.joints[device.joints[0].name]
    assert (log.samples, log.period) == (20_000, 1e-3)
    phi = seen["q"] - seen["theta"]
    half = device.joints[0].basis.deflection_range
    assert 0.7 * half < np.max(np.abs(phi)) < 1.1 * half
    assert np.max(seen["stiffness_true"]) > 1.3 * np.min(seen["stiffness_true"])
    assert np.max(np.abs(seen["q"])) < 1.3  # an elbow does not turn over
    scatter = np.std(seen["torque_measured"] - seen["torque_true"])
    # noise is 1.5 % of the motor torque's rms, which is near the spring's
    assert 0.005 < scatter / np.std(seen["torque_true"]) < 0.02


def test_demo_log_takes_seconds():
    started = time.process_time()
    demo_log(0)
    # 1.3 s measured; four times that leaves room for a slow machine
    assert time.process_time() - started < 5.0
