"""Logs with known truth: roles, truth columns, limits, and what is refused."""

import time
import tomllib

import numpy as np
import pytest

from rotatum.errors import DeviceError, RotatumError, SimulationError
from rotatum.models import ROLES
from rotatum.simulation import Sensors, demo_log, hold, plant_of, simulate_joint, sine
from rotatum.simulation.demo import DEVICE
from rotatum.simulation.plant.effects import Effects
from tests.simulation.joints import AWAS, B_LEVER, VSA, joint_of, series_joint

TABLES = tomllib.loads(DEVICE)
JOINT = series_joint()
IDEAL = Sensors(counts={})
PUSHES = {
    "series": (JOINT, {"tau": sine(20.0, 2.0)}),
    "antagonistic": (joint_of(VSA), {"tau1": sine(0.05, 1.0), "tau2": sine(0.05, 3.0)}),
    "serial": (joint_of(AWAS), {"tau": sine(15.0, 2.0), "setpoint": hold(0.09)}),
}


def _simulate(joint=JOINT, **changes):
    settings = {"seconds": 1.0, "period": 1e-3, "drives": {"tau": sine(20.0, 2.0)}, **changes}
    return simulate_joint(joint, **settings)


def _seen(joint=JOINT, **changes):
    return _simulate(joint, **changes).joints[joint.name]


def test_plant_has_the_constants_of_the_device_at_the_joint():
    plant = plant_of(JOINT)
    motor = plant.motors[0]
    assert motor.inertia == pytest.approx(4e-5 * 6400, rel=1e-15)
    assert motor.damping == pytest.approx(5e-5 * 6400, rel=1e-15)
    assert motor.coulomb == pytest.approx(0.8, rel=1e-15)
    assert (plant.link.inertia, plant.link.damping, plant.link.coulomb) == (0.8, 1.0, 0.1)
    assert (plant.gravity_torque, plant.springs) == (15.0, (("cubic", 2),))


def test_the_set_point_s_motor_and_law_are_at_the_joint_too():
    plant = plant_of(joint_of(AWAS))
    assert plant.setpoint_motor.inertia == pytest.approx(1.29e-7 * 529, rel=1e-15)
    assert plant.setpoint_motor.damping == pytest.approx(0.0141 * 529, rel=1e-15)
    assert (plant.offset, plant.slope) == (0.1, -B_LEVER)
    direct = plant_of(joint_of(AWAS, setpoint=None))
    assert (direct.offset, direct.slope, direct.setpoint_motor) == (0.0, 1.0, None)


@pytest.mark.parametrize(
    ("actuation", "roles", "held"),
    [
        ("series", ["q", "theta"], ["tau"]),
        ("antagonistic", ["q", "theta1", "theta2"], ["tau1", "tau2"]),
        ("serial", ["q", "theta", "setpoint"], ["tau"]),
    ],
)
def test_log_has_the_roles_of_its_actuation_and_truth(actuation, roles, held):
    joint, drives = PUSHES[actuation]
    log = _simulate(joint, drives=drives)
    truth = ["stiffness_true", "torque_true", "torque_measured"]
    if actuation == "antagonistic":
        truth += [f"{name}{m}_true" for m in (1, 2) for name in ("stiffness", "torque")]
        truth += ["torque_measured1", "torque_measured2"]
    motion = [f"{d}{role}_true" for d in ("", "d") for role in roles]
    logged = log.joints[joint.name]
    assert set(logged) == {*roles, *held, *truth, *motion}
    assert set(logged) - set(motion) <= set(ROLES[actuation])
    holds = log.holds[joint.name]
    assert holds == {r: "held" if r in held else "sampled" for r in logged}
    assert (log.samples, log.period, log.warnings) == (1000, 1e-3, ())
    np.testing.assert_allclose(np.diff(log.time), 1e-3, rtol=1e-9)


@pytest.mark.parametrize("actuation", PUSHES)
def test_truth_belongs_to_the_true_motion(actuation):
    joint, drives = PUSHES[actuation]
    seen = _seen(joint, drives=drives, sensors=IDEAL)
    motors = [role for role in seen if role in ("theta", "theta1", "theta2")]
    s = joint.setpoint.value(seen["setpoint"]) if joint.setpoint else 0.0
    total = {"torque": 0.0, "stiffness": 0.0}
    for m, (role, spring) in enumerate(zip(motors, joint.transmissions, strict=True), start=1):
        for name in total:
            formula = getattr(spring, name)(seen["q"] - seen[role], s)
            total[name] += formula
            if len(motors) > 1:
                # the same text at the same numbers
                np.testing.assert_array_equal(seen[f"{name}{m}_true"], formula)
    for name, sum_of_both in total.items():
        # the arm comes back from its motor's angle with that one's rounding
        np.testing.assert_allclose(seen[f"{name}_true"], sum_of_both, rtol=1e-13)
    assert np.ptp(seen["torque_true"]) > 0.0
    faulty = Sensors(deflection_zero=0.05, delay={"q": 5e-3}, noise={motors[0]: 1e-2})
    blurred = _seen(joint, drives=drives, sensors=faulty)
    for role in (r for r in seen if r.endswith("_true")):
        np.testing.assert_array_equal(blurred[role], seen[role])


def test_torque_sensors_feel_the_damping_and_add_up():
    springs = {"law": "cubic", "stiffness": 0.2, "cubic": 1.0, "damping": 1e-3}
    joint = joint_of(VSA, transmission=springs)
    seen = _seen(joint, drives=PUSHES["antagonistic"][1], sensors=IDEAL)
    total = seen["torque_measured1"] + seen["torque_measured2"]
    np.testing.assert_allclose(seen["torque_measured"], total, rtol=1e-14)
    for m in (1, 2):
        rate = np.gradient(seen["q"] - seen[f"theta{m}"], 1e-3, edge_order=2)
        felt = seen[f"torque_measured{m}"] - seen[f"torque{m}_true"]
        # differences over 1 ms: T^2/6 of the third derivative, 3e-3 rad/s beside 1 rad/s
        np.testing.assert_allclose(felt, 1e-3 * rate, atol=1e-5)


def test_the_device_s_encoders_count_unless_the_sensors_say_otherwise():
    ideal = _seen(sensors=IDEAL)
    for sensors, q, theta in ((None, 32768, 65536), (Sensors(counts={"q": 512}), 512, None)):
        seen = _seen(sensors=sensors)
        for role, counts in (("q", q), ("theta", theta)):
            error = np.max(np.abs(seen[role] - ideal[role]))
            step = 2 * np.pi / counts if counts else 0.0
            # a second of motion meets the middle between two counts to a tenth
            assert 0.9 * step / 2 <= error <= step / 2 * (1 + 1e-9)


def test_the_set_point_s_encoder_shows_its_motor_s_angle_in_counts():
    def swept(t):
        return 0.1 - 0.02 * np.sin(t) ** 2

    joint, drives = joint_of(AWAS), {"tau": sine(15.0, 2.0), "setpoint": swept}
    log = _simulate(joint, drives=drives)
    seen, count = log.joints["awas"]["setpoint"], 2 * np.pi / 1024
    np.testing.assert_allclose(seen / count, np.round(seen / count), atol=1e-9)
    angle = (0.1 - swept(log.time)) / B_LEVER
    # half a count, and rounding of 36 rad
    np.testing.assert_allclose(seen, angle, atol=count / 2 * (1 + 1e-9))
    by_angle = {"tau": sine(15.0, 2.0), "setpoint_angle": lambda t: (0.1 - swept(t)) / B_LEVER}
    for role, x in _seen(joint, drives=by_angle).items():
        np.testing.assert_array_equal(x, log.joints["awas"][role])


def test_a_delayed_set_point_is_read_on_its_line():
    angle = {"tau": hold(1.0), "setpoint_angle": lambda t: 40.0 * t}
    sensors = Sensors(counts={}, delay={"setpoint": 2.5e-3, "torque_measured": 1e-3})
    seen = _seen(joint_of(AWAS), drives=angle, sensors=sensors)
    expected = 40.0 * (np.arange(1000) * 1e-3 - 2.5e-3)
    # rounding of 40 rad
    np.testing.assert_allclose(seen["setpoint"][3:], expected[3:], atol=1e-13)
    np.testing.assert_array_equal(seen["setpoint"][:3], 0.0)
    # the elastic torque comes with its set-point: a whole delay shifts it
    np.testing.assert_allclose(seen["torque_measured"][1:], seen["torque_true"][:-1], rtol=1e-12)


def test_motion_obeys_the_motor_s_balance():
    """B theta'' + D theta' + friction - tau_e = tau, integrated over the log: no sign is wrong."""
    joint = series_joint(motor={"inertia": 4e-5, "damping": 5e-5, "gear_ratio": -80.0})
    seen = _seen(joint, sensors=IDEAL)
    inertia, damping, period = 0.256, 0.32, 1e-3
    velocity = np.gradient(seen["theta"], period, edge_order=2)
    spring = np.cumsum(seen["torque_measured"][1:] + seen["torque_measured"][:-1]) * period / 2
    impulse = np.cumsum(seen["tau"][:-1]) * period
    momentum = inertia * velocity[1:] + damping * seen["theta"][1:]
    # differences over 1 ms miss h/2 of each step of the held torque: 20 N m x 2 pi 2 Hz x (1 ms)^2
    np.testing.assert_allclose(momentum[5:-5], (spring + impulse)[5:-5], atol=1e-3)


def test_external_torque_moves_the_link_and_is_logged():
    pushed = _simulate(drives={"tau": hold(0.0)}, external=hold(4.0))
    seen = pushed.joints["demo-elbow"]
    np.testing.assert_array_equal(seen["tau_ext"], 4.0)
    assert pushed.holds["demo-elbow"]["tau_ext"] == "held"
    assert seen["q"][-1] > 0.1
    # the spring passes it on to the resting motor: it stretches in the direction of the push
    assert seen["torque_true"].max() > 0.5


def test_torque_is_limited_as_the_motor_s():
    for gear_ratio in (80.0, -80.0):
        motor = {**TABLES["motor"], "gear_ratio": gear_ratio, "torque_limit": 0.125}
        tau = _seen(series_joint(motor=motor))["tau"]
        assert (tau.min(), tau.max()) == (-10.0, 10.0)  # 0.125 N m times 80


def test_a_joint_starts_where_it_is_told():
    start = {"q": 0.3, "dq": -0.2, "theta": 0.25}
    seen = _seen(start=start, sensors=IDEAL)
    assert (seen["q"][0], seen["theta"][0]) == (0.3, 0.25)
    assert seen["q"][1] == pytest.approx(0.3 - 0.2e-3, abs=2e-5)  # 20 rad/s^2 over 1 ms: 1e-5


def test_a_motion_that_stops_leaves_its_log_in_the_error():
    limited = {"law": "cubic", "stiffness": 200.0, "cubic": 1500.0, "limit": 0.05}
    with pytest.raises(SimulationError, match="leaves its range") as caught:
        _simulate(series_joint(transmission=limited))
    log, whole = caught.value.log, _simulate()
    rows = log.time.size
    assert caught.value.where == f"demo-elbow, t = {1e-3 * rows:.6g} s"
    np.testing.assert_array_equal(log.time, whole.time[:rows])
    for role, x in log.joints["demo-elbow"].items():
        np.testing.assert_array_equal(x, whole.joints["demo-elbow"][role][:rows])


def test_nothing_simulated_leaves_no_log():
    limited = {"law": "cubic", "stiffness": 200.0, "cubic": 1500.0, "limit": 0.05}
    with pytest.raises(SimulationError, match=r"t = 0 s.*got 0\.06") as caught:
        _simulate(series_joint(transmission=limited), start={"q": 0.06})
    assert caught.value.log is None


def test_effects_and_smoothing_reach_the_plant_and_not_the_law():
    effects = Effects(hysteresis_torque=1.0, backlash=1e-3, motor_stiction=1.5)
    plain, changed = _seen(sensors=IDEAL), _seen(sensors=IDEAL, effects=effects, smoothing=0.02)
    assert np.max(np.abs(plain["q"] - changed["q"])) > 1e-3
    phi = changed["q"] - changed["theta"]
    stretch = phi - np.clip(phi, -5e-4, 5e-4)
    law = 200.0 * stretch + 1500.0 * stretch**3
    np.testing.assert_allclose(changed["torque_true"], law, atol=1e-11)  # rounding of 10 N m
    softer = _seen(sensors=IDEAL, smoothing=0.02)
    assert 1e-6 < np.max(np.abs(plain["q"] - softer["q"])) < 1e-2


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
    for joint, drives in PUSHES.values():
        noisy = {role: 0.01 for role in (*drives, "torque_measured") if role != "setpoint"}
        sensors = Sensors(noise=noisy, dropouts=2, nans=3)
        logs = [_simulate(joint, drives=drives, sensors=sensors, seed=s) for s in (5, 5, 6)]
        for role, x in logs[0].joints[joint.name].items():
            np.testing.assert_array_equal(x, logs[1].joints[joint.name][role])
        assert not np.array_equal(logs[0].time, logs[2].time)


def test_two_channels_of_a_joint_have_noise_of_their_own():
    sensors = Sensors(counts={}, noise=dict.fromkeys(("theta1", "theta2", "tau1", "tau2"), 1.0))
    joint, drives = PUSHES["antagonistic"]
    noisy, ideal = (_seen(joint, drives=drives, sensors=s) for s in (sensors, IDEAL))
    noise = [noisy[role] - ideal[role] for role in sensors.noise]
    correlation = np.corrcoef(noise) - np.eye(4)
    # four standard deviations of a correlation of 1000 independent pairs
    assert np.max(np.abs(correlation)) < 4 / np.sqrt(1000)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"motor": None}, r"motor\.inertia"),
        ({"motor": {"gear_ratio": 80.0}}, r"motor\.inertia"),
        ({"link": None}, r"link\.inertia"),
        ({"link": {"damping": 1.0}}, r"link\.inertia"),
        ({"transmission": {}}, r"transmission\.law"),
    ],
)
def test_joints_without_a_plant_are_refused_saying_what_is_missing(changes, match):
    with pytest.raises(DeviceError, match=match):
        _simulate(series_joint(**changes))


@pytest.mark.parametrize(
    "changes",
    [
        {"period": 0.0},
        {"period": -1e-3},
        {"seconds": 1e-3},
        {"seconds": float("nan")},
        {"seconds": float("inf")},
        {"drives": {"tau": lambda t: t[:-1]}},
        {"drives": {"tau": lambda t: np.full_like(t, np.nan)}},
        {"substeps": 0},
    ],
)
def test_impossible_simulations_are_refused(changes):
    with pytest.raises(RotatumError):
        _simulate(**changes)


@pytest.mark.parametrize(
    ("actuation", "drives", "match"),
    [
        ("series", {"tua": hold(0.0)}, r"demo-elbow, drives: .*'tua'; .*Did you mean 'tau'"),
        ("series", {}, "tau is missing"),
        ("series", {"tau": hold(0.0), "setpoint": hold(0.1)}, "series actuation has no such drive"),
        ("antagonistic", {"tau1": hold(0.0)}, "tau2 is missing"),
        ("antagonistic", {"tau": hold(0.0)}, "tau1, tau2"),
        ("serial", {"tau": hold(0.0)}, "exactly one way: setpoint, setpoint_angle, tau_setpoint"),
        (
            "serial",
            {"tau": hold(0.0), "setpoint": hold(0.1), "tau_setpoint": hold(0.0)},
            "exactly one way",
        ),
    ],
)
def test_unknown_and_missing_drives_are_refused_by_name(actuation, drives, match):
    with pytest.raises(RotatumError, match=match):
        _simulate(PUSHES[actuation][0], drives=drives)


def test_a_set_point_without_a_motor_takes_no_torque():
    joint = joint_of(AWAS, setpoint={"law": "lever", "r0": 0.1, "b": 4e-4})
    with pytest.raises(RotatumError, match=r"awas\.setpoint\.motor"):
        _simulate(joint, drives={"tau": hold(0.0), "tau_setpoint": hold(0.0)})


def test_sensors_of_channels_the_joint_lacks_are_refused():
    for sensors in (Sensors(noise={"theta1": 1e-3}), Sensors(counts={"setpoint": 512})):
        with pytest.raises(RotatumError, match="no such channel"):
            _simulate(sensors=sensors)


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


@pytest.mark.parametrize("actuation", PUSHES)
def test_twenty_seconds_take_less_than_half_a_second(actuation):
    joint, drives = PUSHES[actuation]
    taken = []
    for _ in range(3):  # the first may compile
        started = time.process_time()
        _simulate(joint, drives=drives, seconds=20.0)
        taken.append(time.process_time() - started)
    # measured 0.08 s, 0.16 s and 0.08 s on two cores at 2.5 GHz
    assert min(taken) < 0.5
