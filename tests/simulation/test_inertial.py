"""Accelerometers and gyroscopes against closed forms, and what goes wrong with them."""

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rotatum.errors import RotatumError
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from rotatum.models.rotations import rotation_about, rotation_of
from rotatum.simulation.motion import Motion
from rotatum.simulation.sensing.inertial import (
    InertialFaults,
    Links,
    angular_rate,
    inertial_readings,
    specific_force,
    with_faults,
)
from tests.simulation.moving import SWINGS, angle, speed, swinging
from tests.simulation.plants import PERIOD

G = 9.81
LENGTH = 0.4
ARM = Pendulum(0.3, 2.0, LENGTH)
MOVED = swinging(500)
TIME = MOVED.time


@dataclass(frozen=True)
class Mount:
    name: str = "imu"
    frame: str = "link"
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    axes: tuple[str, ...] = ("x", "y", "z")


def _swing_acceleration(t):
    return -(SWINGS["q"][1] ** 2) * angle("q", t)


def _swinging(t):
    columns = (angle("q", t), speed("q", t), _swing_acceleration(t))
    return Links(*(x[:, np.newaxis] for x in columns))


# Only what the readings look at of a device and of a motion.
DEVICE = SimpleNamespace(
    name="arm",
    source="arm.toml",
    joints=(SimpleNamespace(name="elbow"),),
    accelerometers=(Mount("tip", "tip", axes=("x", "z")), Mount("hub")),
    gyroscopes=(Mount("spin"),),
)
MOTION = Motion(TIME, {"elbow": MOVED}, {}, {"elbow": _swing_acceleration(TIME)}, robot=ARM)


def _read(faults=None, *, seed=0, **options):
    return inertial_readings(MOTION, DEVICE, faults or {}, seed=seed, **options)


IDEAL = _read()


def test_on_a_pendulum_it_feels_tangential_centripetal_and_gravity():
    links, t = _swinging(TIME), TIME
    q, dq, ddq = angle("q", t), speed("q", t), _swing_acceleration(t)
    expected = np.column_stack(
        [LENGTH * ddq + G * np.sin(q), np.zeros_like(q), LENGTH * dq**2 + G * np.cos(q)]
    )
    # at the tip, or as far away from the joint by its own position: rounding of 20 m/s^2
    at_tip = specific_force(ARM, Mount(frame="tip"), links)
    away = specific_force(ARM, Mount(position=(0.0, 0.0, -LENGTH)), links)
    np.testing.assert_allclose(at_tip, expected, atol=1e-13)
    np.testing.assert_allclose(away, expected, atol=1e-13)
    # off the link: the same with the place in polar coordinates
    side = specific_force(ARM, Mount(position=(0.1, 0.7, -LENGTH)), links)
    expected += np.column_stack([-0.1 * dq**2, 0 * q, 0.1 * ddq])
    np.testing.assert_allclose(side, expected, atol=1e-13)


def test_a_gyroscope_shows_the_rate_about_the_joint():
    seen = angular_rate(ARM, Mount(frame="tip"), _swinging(TIME))
    np.testing.assert_allclose(seen, -speed("q", TIME)[:, None] * [0.0, 1.0, 0.0], atol=1e-15)
    seen = angular_rate(ARM, Mount(rpy=(math.pi / 2, 0.0, 0.0)), _swinging(TIME))
    np.testing.assert_allclose(seen, speed("q", TIME)[:, None] * [0.0, 0.0, 1.0], atol=1e-14)


ANGLES = st.floats(-3.1, 3.1)


@given(st.tuples(ANGLES, ANGLES, ANGLES), ANGLES)
def test_at_rest_it_shows_gravity_upwards_in_its_own_axes(rpy, q):
    rest = Links(np.array([[q]]), np.zeros((1, 1)), np.zeros((1, 1)))
    seen = specific_force(ARM, Mount(rpy=rpy), rest)[0]
    in_link = np.array([G * math.sin(q), 0.0, G * math.cos(q)])
    np.testing.assert_allclose(
        seen, Rotation.from_euler("xyz", rpy).inv().apply(in_link), atol=1e-13
    )
    np.testing.assert_allclose(
        rotation_of(rpy), Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-15
    )


def test_on_two_links_it_feels_the_second_derivative_of_where_it_is():
    arm = Planar((0.5, 0.3), (1.0, 0.7))
    mount = Mount("imu", "link2", (0.05, 0.02, -0.2), (0.3, -0.4, 1.1))
    t = np.arange(9) * 1e-3

    def course(t):
        q = np.column_stack([0.7 * np.sin(5 * t + 0.2), 0.9 * np.cos(4 * t)])
        dq = np.column_stack([3.5 * np.cos(5 * t + 0.2), -3.6 * np.sin(4 * t)])
        ddq = np.column_stack([-17.5 * np.sin(5 * t + 0.2), -14.4 * np.cos(4 * t)])
        return Links(q, dq, ddq)

    def place(at):
        pose = arm.pose("link2", at)
        return pose.position + pose.rotation @ np.array(mount.position)

    links = course(t)
    where = np.array([place(q) for q in course(np.arange(-1, 10) * 1e-3).q])
    acceleration = (where[2:] - 2 * where[1:-1] + where[:-2]) / 1e-6
    turns = [arm.pose("link2", q).rotation @ rotation_of(mount.rpy) for q in links.q]
    up = np.array([0.0, 0.0, G])
    expected = [R.T @ (a + up) for R, a in zip(turns, acceleration, strict=True)]
    # h^2 / 12 of a fourth derivative of 1e3 m/s^4, and 2e-16 / h^2 of rounding
    np.testing.assert_allclose(specific_force(arm, mount, links), expected, atol=2e-4)
    rate = -links.dq.sum(axis=1)
    np.testing.assert_allclose(
        angular_rate(arm, mount, links),
        [R[1] * w for R, w in zip(turns, rate, strict=True)],
        atol=1e-14,
    )


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3), st.sampled_from([1e-2, 1e-3]))
def test_misalignment_is_a_small_turn(direction, size):
    e = size * np.array(direction)
    true = np.array([[1.0, -4.0, 9.0], [3.0, 2.0, 0.5]])
    seen = with_faults(true, InertialFaults(misalignment=tuple(e)), np.zeros((2, 3)))
    # second order: |e|^2 / 2 of 10 m/s^2, |e|^2 being at most 3 size^2
    np.testing.assert_allclose(seen, true + np.cross(true, e), atol=15.1 * size**2)
    np.testing.assert_allclose(
        np.linalg.norm(seen, axis=1), np.linalg.norm(true, axis=1), rtol=1e-14
    )
    np.testing.assert_allclose(rotation_about(e), Rotation.from_rotvec(e).as_matrix(), atol=1e-15)


def test_bias_noise_saturation_and_resolution():
    faults = {"hub": InertialFaults(bias=(0.1, -0.2, 0.3))}
    for axis, bias in zip(("ax", "ay", "az"), (0.1, -0.2, 0.3), strict=True):
        np.testing.assert_allclose(
            _read(faults)["hub"][axis] - IDEAL["hub"][axis], bias, atol=1e-14
        )
    noisy = _read({"hub": InertialFaults(noise=0.05)})["hub"]
    drawn = [noisy[axis] - IDEAL["hub"][axis] for axis in ("ax", "ay", "az")]
    # three standard deviations of a std of 500 samples and of a correlation of them
    np.testing.assert_allclose(np.std(drawn, axis=1), 0.05, rtol=0.095)
    assert np.max(np.abs(np.corrcoef(drawn) - np.eye(3))) < 3.5 / math.sqrt(500)
    clipped = _read({"tip": InertialFaults(saturation=4.0)})["tip"]
    np.testing.assert_array_equal(clipped["ax"], np.clip(IDEAL["tip"]["ax"], -4.0, 4.0))
    coarse = _read({"tip": InertialFaults(resolution=0.25)})["tip"]["ax"]
    assert np.max(np.abs(coarse - IDEAL["tip"]["ax"])) <= 0.125
    np.testing.assert_array_equal(coarse % 0.25, 0.0)


def test_only_the_sensor_named_is_wrong_and_only_its_axes_are_read():
    assert set(IDEAL["tip"]) == {"ax", "az"}
    assert set(IDEAL["spin"]) == {"gx", "gy", "gz"}
    seen = _read({"tip": InertialFaults(noise=0.1, bias=(1.0, 0.0, 0.0))})
    for name in ("hub", "spin"):
        for axis, x in IDEAL[name].items():
            np.testing.assert_array_equal(seen[name][axis], x)


def test_each_sensor_has_noise_of_its_own_that_repeats_with_the_seed():
    faults = dict.fromkeys(("tip", "hub", "spin"), InertialFaults(noise=1.0))
    one, again, other = (_read(faults, seed=seed) for seed in (3, 3, 4))
    drawn = []
    for name, axes in IDEAL.items():
        for axis, x in axes.items():
            np.testing.assert_array_equal(one[name][axis], again[name][axis])
            drawn += [one[name][axis] - x, other[name][axis] - x]
    # 120 pairs: four standard deviations of a correlation of 500 samples
    assert np.max(np.abs(np.corrcoef(drawn) - np.eye(16))) < 4.0 / math.sqrt(500)


@pytest.mark.parametrize("every", [1, 5])
def test_delay_and_jitter_read_the_arm_in_between(every):
    late = np.random.default_rng(0).uniform(-0.4, 0.4, TIME[::every].size) * PERIOD
    faults = {"tip": InertialFaults(delay=2.3e-3), "spin": InertialFaults(delay=2.3e-3)}
    seen = _read(faults, every=every, late=late)
    t = TIME[::every] + late - 2.3e-3
    moving = t > 0.0
    q, ddq = angle("q", t), _swing_acceleration(t)
    # accelerations go straight: h^2 / 8 of 0.6 * 9^4 rad/s^4, on 0.4 m
    bound = LENGTH * PERIOD**2 / 8 * 0.6 * 9.0**4 + 1e-9
    force = LENGTH * ddq + G * np.sin(q)
    assert np.max(np.abs(seen["tip"]["ax"] - force)[moving]) < bound
    np.testing.assert_allclose(seen["spin"]["gy"][moving], -speed("q", t)[moving], atol=1e-7)
    # before it all, the arm stood where it started
    np.testing.assert_allclose(seen["tip"]["ax"][~moving], G * np.sin(angle("q", 0.0)), atol=1e-13)
    np.testing.assert_array_equal(seen["spin"]["gy"][~moving], 0.0)


def test_what_cannot_be_is_refused_by_name():
    with pytest.raises(RotatumError, match="Did you mean 'tip'"):
        _read({"tipp": InertialFaults()})
    with pytest.raises(RotatumError, match="describes no arm"):
        inertial_readings(replace(MOTION, robot=None), DEVICE, {}, seed=0)
    bare = SimpleNamespace(**{**vars(DEVICE), "accelerometers": (), "gyroscopes": ()})
    assert inertial_readings(replace(MOTION, robot=None), bare, {}, seed=0) == {}
    both = SimpleNamespace(**{**vars(DEVICE), "gyroscopes": (Mount("hub"),)})
    assert set(inertial_readings(MOTION, both, {}, seed=0)["hub"]) == {
        "ax",
        "ay",
        "az",
        "gx",
        "gy",
        "gz",
    }
    with pytest.raises(RotatumError, match="two names"):
        inertial_readings(MOTION, both, {"hub": InertialFaults(noise=0.1)}, seed=0)
    lost = SimpleNamespace(**{**vars(DEVICE), "gyroscopes": (Mount("spin", frame="tipp"),)})
    with pytest.raises(RotatumError, match="no such frame"):
        inertial_readings(MOTION, lost, {}, seed=0)


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"noise": -1.0}, "noise"),
        ({"bias": (0.0, 1.0)}, "bias"),
        ({"misalignment": (0.0, 1.0, math.nan)}, "misalignment"),
        ({"delay": -1e-3}, "delay"),
        ({"saturation": 0.0}, "saturation"),
        ({"resolution": -0.1}, "resolution"),
    ],
)
def test_impossible_faults_are_refused_by_name(settings, match):
    with pytest.raises(RotatumError, match=f"inertial.{match}"):
        InertialFaults(**settings)
