"""Robots and inertial sensors in device files."""

from __future__ import annotations

import pickle
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rotatum.errors import DeviceError
from rotatum.models import Device, device_from_tables, device_names, load_device
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from tests.models.test_robot_urdf_errors import PLAIN

PLANAR: dict[str, Any] = {"model": "planar", "lengths": [0.5, 0.4], "masses": [0.2, 0.1]}
URDF: dict[str, Any] = {"urdf": "manutec-r3", "joints": ["axis1", "axis2"]}


def _device(robot: dict[str, Any] | None, **more: Any) -> Device:
    joints = [{"name": "a"}, {"name": "b"}]
    tables = {"name": "arm", "joint": joints, **more}
    if robot is not None:
        tables["robot"] = robot
    return device_from_tables(tables, "arm.toml")


def test_planar() -> None:
    robot = _device({**PLANAR, "motor_masses": [0.3], "gravity": 0.0}).build_robot()
    assert isinstance(robot, Planar)
    assert robot.names == ("a", "b")
    told = Planar((0.5, 0.4), (0.2, 0.1), motor_masses=(0.3,), gravity=0.0)
    q = np.array([0.3, 0.7])
    assert np.array_equal(robot.mass(q), told.mass(q))
    assert not robot.gravity(q).any()


def test_a_pendulum_on_a_single_joint() -> None:
    tables = {
        "name": "one",
        "robot": {"model": "pendulum", "lengths": [0.5], "masses": [0.1]},
        "accelerometer": [{"name": "imu", "frame": "tip", "position": [0, 0, 0.1]}],
    }
    device = device_from_tables(tables, "one.toml")
    robot = device.build_robot()
    assert isinstance(robot, Pendulum)
    assert robot.names == ("one",)
    # A uniform rod: m l^2 / 3 and m g l / 2.
    assert robot.mass(np.zeros(1)) == pytest.approx(0.1 * 0.25 / 3)
    assert robot.gravity(np.array([np.pi / 2])) == pytest.approx(0.1 * 9.81 * 0.25)
    assert device.accelerometers[0].axes == ("x", "y", "z")
    assert device.gyroscopes == ()


def test_no_robot_is_none() -> None:
    device = _device(None)
    assert device.robot is None
    assert device.build_robot() is None


def test_urdf_with_names_of_its_own_and_a_payload() -> None:
    load = {"frame": "flange", "mass": 5.0, "position": [0.0, 0.0, 0.1]}
    device = _device({**URDF, "locked": {"axis3": -0.5}, "payload": load})
    robot = device.build_robot()
    assert robot is not None
    assert robot.names == ("a", "b")
    bare = _device({**URDF, "locked": {"axis3": -0.5}}).build_robot()
    assert bare is not None
    q = np.array([0.2, 0.9])
    told = bare.with_payload("flange", 5.0, (0.0, 0.0, 0.1)).mass(q)
    assert np.array_equal(robot.mass(q), told)
    assert robot.mass(q)[1, 1] > bare.mass(q)[1, 1] + 5.0


def test_a_urdf_file_beside_the_device_file(tmp_path: Path) -> None:
    (tmp_path / "two.urdf").write_text(PLAIN)
    text = 'name = "two"\n[robot]\nurdf = "two.urdf"\n'
    joints = '[[joint]]\nname = "shoulder"\n[[joint]]\nname = "elbow"\n'
    (tmp_path / "two.toml").write_text(text + joints)
    device = load_device(tmp_path / "two.toml")
    (tmp_path / "two.urdf").unlink()
    # What was read is kept: a process elsewhere has no such file.
    robot = pickle.loads(pickle.dumps(device)).build_robot()
    assert robot is not None
    assert robot.names == ("shoulder", "elbow")


def test_coupling() -> None:
    assert not _device(PLANAR).robot.coupling_matrix.any()
    told = _device({**PLANAR, "coupling": [[0, 0.1], [0, 0]]}).robot.coupling_matrix
    assert told.tolist() == [[0.0, 0.1], [0.0, 0.0]]


def test_a_part_of_the_joints_has_no_arm() -> None:
    mounted = {"accelerometer": [{"name": "i", "frame": "tip"}]}
    device = _device(PLANAR, **mounted)
    part = device.only(["b"])
    assert (part.robot, part.accelerometers) == (None, ())
    # All of them keep the order along the arm.
    assert device.only(["b", "a"]) is device
    assert device.only(None) is device


def test_inertial_sensors() -> None:
    table = {"name": "imu", "frame": "body2", "position": [0.1, 0, 0], "rpy": [0, 0, 1.57]}
    gyro = {"name": "imu", "frame": "flange", "axes": ["z"]}
    device = _device(URDF, accelerometer=[table], gyroscope=[gyro])
    assert device.accelerometers[0].position == (0.1, 0.0, 0.0)
    assert device.accelerometers[0].rpy == (0.0, 0.0, 1.57)
    assert device.gyroscopes[0].axes == ("z",)


_WRONG: list[tuple[dict[str, Any], str]] = [
    ({}, r'robot: give model \("pendulum" or "planar"\) or urdf, one of them'),
    ({**PLANAR, **URDF}, "robot: give model"),
    ({**PLANAR, "model": "planer"}, 'robot.model.*Did you mean "planar"'),
    ({**PLANAR, "lenghts": [1.0]}, r'unknown key "robot\.lenghts".*Did you mean "lengths"'),
    ({"model": "planar", "lengths": [0.5, 0.4]}, r"robot\.masses is needed with model"),
    ({**PLANAR, "lengths": [0.5]}, r"robot\.lengths needs one entry for each .*so 2, got \[0\.5"),
    ({**PLANAR, "lengths": [0.5, -1.0]}, r"robot\.lengths\[1\] must be greater than 0"),
    ({**PLANAR, "masses": [0.5, 0.0]}, r"robot\.masses\[1\] must be greater than 0, got 0\.0"),
    ({**PLANAR, "inertias": [0.5]}, r"robot\.inertias needs one entry"),
    ({**PLANAR, "motor_masses": [1.0, 1.0]}, r"motor_masses has one number .* so 1, got"),
    ({**PLANAR, "gravity": -9.81}, r"robot\.gravity must be .*0, got -9\.81"),
    ({**PLANAR, "model": "pendulum"}, r"\"pendulum\" has 1 joint, got \['a', 'b'\]"),
    ({**PLANAR, "locked": {"x": 0.0}}, "robot: locked does not go with model"),
    ({**URDF, "masses": [1.0]}, "robot: masses does not go with urdf"),
    ({**PLANAR, "coupling": [[0, 1]]}, r"robot\.coupling needs one entry .*so 2"),
    (
        {**PLANAR, "coupling": [[0, 1], [0]]},
        r"robot\.coupling needs one entry .*so 2, got \[0\.0\]",
    ),
    ({**PLANAR, "coupling": [[0, 1], [1, 0]]}, "must be 0 on and below its diagonal"),
    ({**PLANAR, "payload": {"frame": "tipp", "mass": 1.0}}, 'payload: .*frame.*mean "tip"'),
    ({**PLANAR, "payload": {"frame": "tip", "mass": 0.0}}, r"payload\.mass must be greater than 0"),
    ({**PLANAR, "payload": {"frame": "tip", "mass": 1.0, "mas": 1.0}}, 'payload.mas".*mean "mass"'),
    ({**PLANAR, "sources": {"mases": "sourced: x"}}, 'robot.sources.mases".*mean "masses"'),
    ({**PLANAR, "centres": [0.0, 0.0], "inertias": [0.1, 0.0]}, "needs an inertia about its joint"),
    ({"urdf": "manutec-r3"}, r"no such joint, got 'a'; allowed: axis1"),
    ({**URDF, "joints": ["axis1"]}, r"robot\.joints needs one entry"),
    ({**URDF, "joints": ["axis1", "axs2"]}, 'no such joint.*mean "axis2"'),
    ({**URDF, "locked": {"axs4": 0.0}}, 'no such joint to lock.*mean "axis4"'),
    ({"urdf": "manutec-r4"}, 'no such URDF file.*mean "manutec-r3"'),
]


@pytest.mark.parametrize(("robot", "told"), _WRONG)
def test_wrong_robots(robot: dict[str, Any], told: str) -> None:
    with pytest.raises(DeviceError, match=told):
        _device(robot).build_robot()


@pytest.mark.parametrize("key", ["accelerometer", "gyroscope"])
@pytest.mark.parametrize(
    ("tables", "told"),
    [
        ({"name": "i", "frame": "tip"}, r"KEY must be an array of tables: \[\[KEY\]\]"),
        ([{"name": "i"}], r'the key "KEY\[0\]\.frame" is missing'),
        ([{"name": "i", "frame": "tpi"}], r'KEY "i": .*no such frame.*mean "tip"'),
        (
            [{"name": "i", "frame": "tip", "axes": ["w"]}],
            r"KEY\[0\]\.axes.*got 'w'; allowed: x, y, z",
        ),
        ([{"name": "i", "frame": "tip", "axes": ["x", "x"]}], "must name each axis once"),
        ([{"name": "i", "frame": "tip", "axes": []}], "must name each axis once"),
        ([{"name": "i", "frame": "tip", "ryp": [0, 0, 0]}], 'unknown key .*Did you mean "rpy"'),
        ([{"name": "i", "frame": "tip"}] * 2, "two KEYs have the same name"),
        ([3], r"KEY must be an array of tables: \[\[KEY\]\]"),
    ],
)
def test_wrong_sensors(key: str, tables: Any, told: str) -> None:
    with pytest.raises(DeviceError, match=told.replace("KEY", key)):
        _device(PLANAR, **{key: tables})


@pytest.mark.parametrize(
    ("key", "channels", "told"),
    [
        (
            "accelerometer",
            {"ay": "x"},
            r"\[1\]\.channels: unknown channel, got 'ay'; allowed: ax, az",
        ),
        ("accelerometer", {"acx": "x"}, r'unknown channel.*Did you mean "ax"'),
        ("accelerometer", {"gx": "x"}, r"unknown channel, got 'gx'; allowed: ax, az"),
        ("gyroscope", {"ax": "x"}, r"unknown channel, got 'ax'; allowed: gx, gz"),
        (
            "accelerometer",
            {"ax": {"unit": "rad/s^2"}},
            r"accelerometer\[1\]\.channels\.ax\.unit: this is a unit of angular acceleration, and"
            r" one of acceleration is needed, got 'rad/s\^2'; allowed: m/s\^2, g, mg\.",
        ),
        ("gyroscope", {"gx": {"unit": "deg"}}, r"unit of angle, .*allowed: rad/s, deg/s, rpm\."),
        ("gyroscope", {"gx": {"unit": "deg/ss"}}, r'unknown unit.*Did you mean "deg/s"'),
        ("accelerometer", {"ax": {"factr": 1.0}}, r'ax\.factr".*offset.*Did you mean "factor"'),
        ("accelerometer", {"ax": {"side": "motor"}}, r'unknown key.*\[1\]\.channels\.ax\.side"'),
        ("gyroscope", {"gx": {"hold": "held"}}, r'unknown key "gyroscope\[1\].*\.hold"'),
        ("accelerometer", {"ax": {"factor": 0.0}}, r"\[1\]\.channels\.ax\.factor must not be 0"),
        ("gyroscope", {"gx": {"index": -1}}, r"channels\.gx\.index must be greater than or equal"),
        ("accelerometer", {"ax": {"sign": 2}}, r"channels\.ax\.sign .*allowed: 1, -1"),
        ("accelerometer", 3, r"accelerometer\[1\]\.channels must be a"),
    ],
)
def test_wrong_channels_of_sensors(key: str, channels: Any, told: str) -> None:
    sensor = {"name": "i", "frame": "tip", "axes": ["x", "z"], "channels": channels}
    with pytest.raises(DeviceError, match=told) as caught:
        _device(PLANAR, **{key: [{"name": "h", "frame": "tip"}, sensor]})
    assert str(caught.value).startswith("arm.toml: ")


def test_sensors_need_an_arm() -> None:
    with pytest.raises(DeviceError, match=r"\[\[gyroscope\]\] sits on a link of an arm, and there"):
        _device(None, gyroscope=[{"name": "i", "frame": "tip"}])


def test_robots_of_the_catalogue_say_where_their_numbers_are_from() -> None:
    found = []
    for name in device_names():
        entry = files("rotatum.models") / "catalogue" / f"{name}.toml"
        raw = tomllib.loads(entry.read_text("utf-8"))
        if "robot" not in raw:
            continue
        device = load_device(name)
        robot = device.build_robot()
        assert robot is not None
        assert robot.names == tuple(joint.name for joint in device.joints)
        assert set(raw["robot"]) - {"model", "sources"} == set(device.robot.sources)
        found.append(name)
    assert found == ["kr15-like", "manutec-r3", "planar-qbmove", "planar-vsa-ii", "seven-axis"]
