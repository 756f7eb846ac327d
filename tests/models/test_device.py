"""Device files that are right."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest

from rotatum.models import Uncertain, device_from_tables, device_names, load_device

_FULL = """
name = "rig"
actuation = "series"
[motor]
inertia = { value = 2e-5, std = 1e-6 }
damping = 1e-3
coulomb = 0.02
gear_ratio = -50
torque_limit = 1
[transmission]
law = "cubic"
stiffness = 200
cubic = 1e4
zero = 0.01
[link]
inertia = 0.1
[encoders]
link = 40000
accuracy = 1e-4
[basis]
deflection_range = 0.01
orders = 2
[estimator]
method = "weak"
fit = ["inertia", "offset"]
period = 1e-3
[channels]
time = { name = "t", unit = "ms" }
q = "q_link"
theta = { name = "q_motor", side = "motor", unit = "deg" }
tau = { hold = "held" }
"""


def _write(folder: Path, text: str) -> Path:
    path = folder / "rig.toml"
    path.write_text(text)
    return path


def test_one_joint_takes_the_devices_name(tmp_path: Path) -> None:
    device = load_device(_write(tmp_path, _FULL))
    (joint,) = device.joints
    assert joint.name == device.name == "rig"
    assert device.source == str(tmp_path / "rig.toml")
    assert device.period == 1e-3
    assert device.time is not None
    assert device.time.unit == "ms"
    assert joint.estimator.fit == ("inertia", "offset")
    assert joint.transmission.zero == 0.01
    assert joint.encoders.resolution("link") == 2 * pi / 40000
    assert joint.encoders.resolution("motor") is None


def test_constants_are_reflected_through_the_gear(tmp_path: Path) -> None:
    (motor,) = load_device(_write(tmp_path, _FULL)).joints[0].motors
    # Exact: products of two doubles with one rounding, computed the same way.
    assert motor.reflected_inertia == Uncertain(2e-5 * 2500, 1e-6 * 2500)
    assert motor.reflected_damping.value == 2.5
    assert motor.reflected_coulomb.value == 1.0


def test_channels(tmp_path: Path) -> None:
    channels = load_device(_write(tmp_path, _FULL)).joints[0].channels
    assert channels["q"].name == "q_link"
    assert channels["tau"].name is None
    assert channels["tau"].hold == "held"
    assert "time" not in channels


def test_a_device_without_a_motor() -> None:
    joint = device_from_tables({"name": "sensor"}, "test").joints[0]
    assert joint.motors == ()
    assert joint.transmission.zero == "first"


def test_joints_share_estimator_and_clock() -> None:
    tables = {
        "name": "arm",
        "channels": {"time": "t"},
        "estimator": {"cutoff": 60.0, "fit": ["offset"]},
        "joint": [{"name": "a"}, {"name": "b", "estimator": {"cutoff": 90.0}}],
    }
    device = device_from_tables(tables, "test")
    assert [joint.name for joint in device.joints] == ["a", "b"]
    assert [joint.estimator.cutoff for joint in device.joints] == [60.0, 90.0]
    assert device.joints[1].estimator.fit == ("offset",)
    assert device.time is not None
    assert device.time.name == "t"


def test_antagonistic_motors_in_order() -> None:
    tables = {
        "name": "vsa",
        "actuation": "antagonistic",
        "motor": [{"gear_ratio": 2.0}, {"gear_ratio": 3.0}],
    }
    joint = device_from_tables(tables, "test").joints[0]
    assert (joint.gear_ratio("theta1"), joint.gear_ratio("tau2")) == (2.0, 3.0)


def test_the_catalogue_loads() -> None:
    assert {"series-demo", "compact-sea", "cjt-orange-80-6000"} <= set(device_names())
    for name in device_names():
        device = load_device(name)
        assert device.name == name
        assert device.source == f"catalogue:{name}"


def test_catalogue_constants_agree_with_their_source() -> None:
    (joint,) = load_device("cjt-orange-80-6000").joints
    assert joint.motors[0].reflected_inertia is not None
    # Four digits are given in the file.
    assert joint.motors[0].reflected_inertia.value == pytest.approx(0.2300 + 0.0717, rel=2e-4)
    assert joint.motors[0].reflected_damping.value == pytest.approx(0.0036 + 2.2, rel=2e-4)
    assert joint.motors[0].reflected_coulomb.value == pytest.approx(2.64, rel=1e-12)


def test_the_examples_load(project: Path) -> None:
    files = sorted((project / "examples" / "devices").glob("*.toml"))
    assert len(files) >= 3
    for file in files:
        assert load_device(file).joints
