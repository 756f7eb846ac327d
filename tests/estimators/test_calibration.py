"""Bias, misalignment and delay of accelerometers: from rest, from motion, and honest deviations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import toeplitz

from rotatum import load_device
from rotatum.errors import RotatumError
from rotatum.estimators.full_state.calibration import calibrate_static
from rotatum.estimators.full_state.calibration_motion import calibrate_motion, delay_between
from rotatum.estimators.full_state.regression import PRIOR, fit_readings, fitted_mask
from rotatum.estimators.full_state.rest import links_at_rest
from rotatum.estimators.full_state.spells import poses_at_rest, rest_spells
from rotatum.models.inertial import Accelerometer
from rotatum.models.robot.accelerations import AccelerometerMap
from rotatum.models.rotations import rotation_about
from rotatum.simulation import load_scenario
from tests import naive

DEVICE = load_device("manutec-r3")
R3 = DEVICE.build_robot()
IMU = Accelerometer(name="imu", frame="body4", position=(0.0, 0.1, 0.1), rpy=(0.1, 0.2, 0.3))
MAP = AccelerometerMap(R3, [IMU])
BIAS, TURN, DELAY = np.array([0.2, -0.15, 0.1]), np.array([0.02, -0.015, 0.01]), 2.5e-3
TRUE = np.concatenate([BIAS, TURN, np.zeros(3), [DELAY]])
POSES = np.random.default_rng(0).uniform(-1.0, 1.0, (6, 3))
PERIOD = 2e-3
TIME = PERIOD * np.arange(700)
STILL = np.zeros(3)


def _at_rest(q):
    return np.array([MAP.rest(x, STILL) for x in q]) @ rotation_about(TURN) + BIAS


def _course(t):
    """Angles, rates and accelerations of sines, (K, 3) each."""
    size, rate = np.array([0.3, 0.25, 0.3]), np.array([4.0, 5.0, 6.5])
    phase = np.multiply.outer(t, rate) + np.array([0.0, 0.5, 1.0])
    turning = size * rate * np.cos(phase), -size * rate**2 * np.sin(phase)
    return np.array([0.0, 0.8, 0.8]) + size * np.sin(phase), *turning


Q = _course(TIME)[0]
MOVED = np.array([MAP.readings(*x) for x in zip(*_course(TIME - DELAY), strict=True)])
SHOWN = MOVED @ rotation_about(TURN) + BIAS


def test_static_poses_tell_bias_and_misalignment():
    found = calibrate_static(R3, IMU, POSES, _at_rest(POSES), 1e-6, angle_std=0.0)
    # nothing but the prior is wrong: 1e-6 m/s^2 against 1
    np.testing.assert_allclose(found.values, TRUE * (np.arange(10) < 6), atol=1e-9)
    assert found.determined == (
        "bias x", "bias y", "bias z", "misalignment x", "misalignment y", "misalignment z",
    )  # fmt: skip
    # Applied, the readings are those of the sensor as it sits.
    other = POSES + 0.3
    expected = np.array([AccelerometerMap(R3, [found.mounted()]).rest(x, STILL) for x in other])
    np.testing.assert_allclose(found.correct(_at_rest(other)), expected, atol=1e-8)
    assert "bias x          +0.200000 +- " in found.text()
    assert "not told, or not fitted: scale x" in found.text()


def test_the_deviations_from_rest_are_those_of_repeated_logs():
    z = []
    for seed in range(60):
        noise = 0.01 * np.random.default_rng(seed).standard_normal((6, 3))
        found = calibrate_static(R3, IMU, POSES, _at_rest(POSES) + noise, 0.01, angle_std=0.0)
        z.append((found.values - TRUE)[:6] / found.std[:6])
    # four deviations of a deviation of 60, 0.37; it is 5 % wider where chance leaves more over
    np.testing.assert_allclose(np.std(z, axis=0), 0.95, atol=0.37)
    assert np.abs(np.mean(z, axis=0)).max() < 4.0 / np.sqrt(60)


def test_what_the_poses_do_not_tell_stays_at_the_prior():
    one = calibrate_static(R3, IMU, POSES[:1], _at_rest(POSES[:1]), 0.001)
    assert one.determined == ()
    # upright axis: turning it shows the same gravity again
    turned = POSES[:1] + np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    same = calibrate_static(R3, IMU, turned, _at_rest(turned), 0.001)
    assert same.determined == ()
    np.testing.assert_allclose(same.values, one.values, atol=1e-3)
    # the readings are explained all the same, by the likeliest mix
    assert one.residual < 1e-3
    assert np.all(np.abs(one.values - TRUE)[:6] < 3.0 * one.std[:6])
    np.testing.assert_array_equal(one.values[6:], 0.0)
    np.testing.assert_allclose(one.std[6:], PRIOR[6:])
    # an axis that is not measured has the prior's bias
    flat = IMU.model_copy(update={"axes": ("x", "z")})
    two = calibrate_static(R3, flat, POSES, _at_rest(POSES)[:, [0, 2]], 1e-4)
    assert "bias y" not in two.determined
    assert "bias x" in two.determined
    assert two.std[1] == pytest.approx(PRIOR[1])


def test_scale_is_told_by_poses_that_turn_every_axis_to_gravity():
    gains = np.array([1.01, 0.99, 1.02])
    clean = np.array([MAP.rest(x, STILL) for x in POSES]) @ rotation_about(TURN)
    fit = ("bias", "misalignment", "scale")
    found = calibrate_static(R3, IMU, POSES, clean * gains + BIAS, 1e-7, fit=fit, angle_std=0.0)
    np.testing.assert_allclose(found.values[6:9], gains - 1.0, atol=1e-5)
    np.testing.assert_allclose(found.correct(clean * gains + BIAS), clean, atol=1e-4)


def test_motion_tells_delay_too_with_deviations_that_hold():
    z = []
    for seed in range(16):
        noise = 0.1 * np.random.default_rng(seed).standard_normal(SHOWN.shape)
        found = calibrate_motion(R3, IMU, PERIOD, Q, SHOWN + noise)
        z.append((found.values - TRUE)[[0, 1, 2, 3, 4, 5, 9]] / found.std[[0, 1, 2, 3, 4, 5, 9]])
    # 112 numbers, taken as independent: four deviations of a rms, and of the largest of them
    assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=4.0 / np.sqrt(2 * 112))
    assert np.abs(z).max() < 4.0
    assert len(found.determined) == 7
    # white noise of 0.1 m/s^2, of which the low-pass leaves less than 150 rad/s of 1571: a third
    assert 0.02 < found.residual < 0.04
    assert found.std[9] < 2e-4


def test_coloured_noise_and_coloured_residuals_widen_the_deviation_of_a_mean():
    # Moving averages of four: correlated over three rows.
    colour, count, std = np.array([1.0, 0.75, 0.5, 0.25, 0.0]), 300, 0.1
    where = fitted_mask(("bias",), ("bias",))

    def deviations(readings):
        none = np.zeros((count, 3))
        given = np.zeros(10), np.diag(PRIOR**2)
        found = fit_readings(lambda _: (none, none), readings, np.full((count, 3), std),
                             (0, 1, 2), where, *given, colour=colour)  # fmt: skip
        return np.sqrt(np.diag(found.covariance))[:3]

    whole = toeplitz(np.concatenate([colour, np.zeros(count - 5)])).sum()
    # the prior of 1 m/s^2 against 300 readings of 0.1: a part of 1 / 30000
    expected = std * np.sqrt(whole) / count
    np.testing.assert_allclose(deviations(np.zeros((count, 3))), expected, rtol=1e-4)
    # Residuals of that size that stay for 50 rows ask for more: what Newey and West say.
    slow = 0.0995 * np.sign(np.sin(np.pi / 50.0 * (np.arange(count) + 0.5)))[:, None] * np.ones(3)
    asked = np.sqrt(naive.newey_west(slow, 4)[0, 0]) / count
    assert asked > 1.05 * expected
    np.testing.assert_allclose(deviations(slow), asked, rtol=1e-4)


def test_motion_without_noise_is_exact_to_the_filters():
    found = calibrate_motion(R3, IMU, PERIOD, Q, SHOWN)
    # The low-pass loses (7 / 150)^8 of what the angles do, and some of the square of it.
    np.testing.assert_allclose(found.values, TRUE, atol=2e-3 * np.abs(TRUE).max())
    assert found.delay == pytest.approx(DELAY, abs=1e-5)
    # rest first, then motion: what rest has told is not told worse
    rest = calibrate_static(R3, IMU, POSES, _at_rest(POSES), 1e-4)
    both = calibrate_motion(R3, IMU, PERIOD, Q, SHOWN, prior=rest)
    assert np.all(both.std[:6] <= rest.std[:6] * (1.0 + 1e-9))
    np.testing.assert_allclose(both.values, TRUE, atol=1e-3)


def test_missing_readings_are_left_out():
    noise = 0.05 * np.random.default_rng(3).standard_normal(SHOWN.shape)
    holes = SHOWN + noise
    holes[300:304, 1] = np.nan
    holes[450] = np.nan
    found = calibrate_motion(R3, IMU, PERIOD, Q, holes)
    assert np.all(np.abs(found.values - TRUE) < 4.0 * found.std)
    assert found.rows < calibrate_motion(R3, IMU, PERIOD, Q, SHOWN).rows
    with pytest.raises(RotatumError, match="too little of the log"):
        calibrate_motion(R3, IMU, PERIOD, Q, np.full_like(SHOWN, np.nan))


@pytest.mark.parametrize("late", [-4.3e-3, 0.0, 0.7e-3, 6.25e-3])
def test_correlation_finds_a_delay_between_samples(late):
    t = 1e-3 * np.arange(1500)

    def wave(t):
        return np.column_stack([np.sin(40.0 * t) + np.cos(11.0 * t), np.sin(23.0 * t)])

    found = delay_between(wave(t), 0.7 * wave(t - late) + 3.0, 1e-3, 0.02)
    # The parabola through three samples of a sine of 40 rad/s is off by (0.04)^2 / 16 of a sample;
    # what comes and goes at the ends of the log, 40 ms of 1.5 s, by a part of that.
    assert found == pytest.approx(late, abs=0.03 * 1e-3 + 0.01 * abs(late))
    assert delay_between(np.ones((99, 2)), np.ones((99, 2)), 1e-3, 0.02) == 0.0


def test_rest_is_found_in_a_log_and_calibrates():
    rng = np.random.default_rng(7)
    stops = POSES[:4]
    share = np.clip((np.arange(1200) % 400 - 250) / 150.0, 0.0, 1.0)[:, None]
    share = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    part = np.arange(1200) // 400
    theta = np.concatenate([stops[part] * (1 - share) + stops[part + 1] * share,
                            np.repeat(stops[3:], 250, axis=0)])  # fmt: skip
    ends = np.array([links_at_rest(R3, DEVICE.joints, x).q for x in stops])
    q = theta + np.concatenate([ends[part] - stops[part], np.repeat(ends[3:] - stops[3:], 250, 0)])
    dq = np.gradient(q, PERIOD, axis=0)
    moving = zip(q, dq, np.gradient(dq, PERIOD, axis=0), strict=True)
    shown = np.array([MAP.readings(*x) for x in moving]) @ rotation_about(TURN) + BIAS
    shown += 0.05 * rng.standard_normal(shown.shape)
    theta += 1e-5 * rng.uniform(-0.5, 0.5, theta.shape)
    shown[30] = np.nan
    spells = rest_spells(theta, shown, PERIOD, shortest=0.3)
    # Half a window of 51 samples is lost at each end, and a smooth start is still for some more.
    assert len(spells) == 4
    for spell, begin, end in zip(spells, (31, 400, 800, 1200), (250, 650, 1050, 1450), strict=True):
        assert begin - 15 <= spell.start <= begin + 30
        assert end - 30 <= spell.stop <= end + 15
    found = poses_at_rest(R3, DEVICE.joints, theta, shown, PERIOD, shortest=0.3)
    np.testing.assert_allclose(found.q, ends, atol=1e-5)
    # white noise of 0.05 over 220 samples; 20 blocks tell it to a third, the larger is taken
    assert np.all((found.std > 0.003) & (found.std < 0.007))
    result = calibrate_static(R3, IMU, found.q, found.readings, found.std)
    assert np.all(np.abs(result.values - TRUE)[:6] < 3.0 * result.std[:6])
    assert len(result.determined) == 6
    assert rest_spells(theta[250:400], shown[250:400], PERIOD) == ()


def test_a_simulated_industrial_arm_tells_all_seven_from_a_short_motion():
    bent = {f"joint.axis{i}.drives.motors.path.{key}": value for i, path in {
        1: ([0.05, 0.3, 0.4, 0.7], [0.0, 0.087, 0.087, 0.0]),
        2: ([0.05, 0.3, 0.4, 0.7], [0.8, 0.9, 0.9, 0.8]),
        3: ([0.1, 0.35, 0.45, 0.75], [0.8, 0.6, 0.6, 0.8]),
    }.items() for key, value in zip(("times", "values"), path, strict=True)}  # fmt: skip
    wrong = {"noise": 0.1, "bias": BIAS.tolist(), "misalignment": TURN.tolist(), "delay": DELAY}
    scenario = load_scenario("deluca2007/coordinated").with_values(
        {"seconds": 0.8, "inertial.link4": wrong, **bent}
    )
    log, sensor = scenario.run(1), scenario.device.accelerometers[0]
    shown = np.column_stack([log.inertial["link4"][f"a{axis}"] for axis in "xyz"])
    q, theta = (
        np.column_stack([log.joints[joint.name][role] for joint in DEVICE.joints])
        for role in ("q", "theta")
    )
    found = calibrate_motion(R3, sensor, 1e-3, q, shown)
    assert np.all(np.abs(found.values - TRUE) <= 3.0 * found.std)
    assert len(found.determined) == 7
    # Noise of 0.1 m/s^2, 0.6 s with 25 Hz of it let through, 30 numbers an axis: 0.02 m/s^2 and
    # as much over g or over the jerk, 200 m/s^3, where each is told alone; together, up to double.
    assert np.all(np.abs(found.bias - BIAS) < 0.04)
    assert np.all(np.abs(found.misalignment - TURN) < 0.004)
    assert abs(found.delay - DELAY) < 2e-4
    # From the motors' angles the links' swinging is left over, and the deviations widen.
    blind = calibrate_motion(R3, sensor, 1e-3, theta, shown)
    assert blind.residual > 10.0 * found.residual
    assert np.all(blind.std[[0, 1, 2, 3, 4, 5, 9]] > 5.0 * found.std[[0, 1, 2, 3, 4, 5, 9]])


def test_what_does_not_belong_together_is_refused():
    with pytest.raises(RotatumError, match=r"imu.*static poses"):
        calibrate_static(R3, IMU, POSES, np.zeros((6, 2)), 0.1)
    with pytest.raises(RotatumError, match=r"fit.*biass.*bias"):
        calibrate_static(R3, IMU, POSES, np.zeros((6, 3)), 0.1, fit=("biass",))
    with pytest.raises(RotatumError, match="each axis and instant"):
        calibrate_motion(R3, IMU, PERIOD, Q[:-1], SHOWN)
    with pytest.raises(RotatumError, match=r"cutoff.*785"):
        calibrate_motion(R3, IMU, PERIOD, Q, SHOWN, cutoff=800.0)
    with pytest.raises(RotatumError, match="too short"):
        calibrate_motion(R3, IMU, PERIOD, Q[:50], SHOWN[:50])
