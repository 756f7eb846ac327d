"""Device files that are right."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest

from rotatum.logs.mapping import map_channels
from rotatum.models import Setpoint, Transmission, Uncertain, device_from_tables, load_device

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


def test_one_transmission_stands_for_both() -> None:
    table = {"law": "sinh", "k": 0.02, "a": 11.0}
    tables = {"name": "vsa", "actuation": "antagonistic", "transmission": table}
    joint = device_from_tables(tables, "test").joints[0]
    one, other = joint.transmissions
    assert one == other == joint.transmission
    assert list(one.constants) == [0.02, 11.0]
    assert one.model.name == "sinh"


def test_two_transmissions_in_order() -> None:
    pair = [{"law": "linear", "stiffness": k, "preload": 0.1} for k in (1.0, 2.0)]
    tables = {"name": "vsa", "actuation": "antagonistic", "transmission": pair}
    joint = device_from_tables(tables, "test").joints[0]
    assert [float(t.torque(0.4)) for t in joint.transmissions] == [0.5, 1.0]
    without = device_from_tables({"name": "vsa", "actuation": "antagonistic"}, "test").joints[0]
    assert len(without.transmissions) == 2


_SERIAL = """
name = "awas"
actuation = "serial"
[motor]
gear_ratio = 50
[setpoint]
law = "lever"
r0 = 0.1
b = 4e-4
[setpoint.motor]
inertia = 1e-7
gear_ratio = 23
[transmission]
law = "lever"
spring = 14220
[channels]
setpoint = { name = "theta_c", side = "motor", unit = "deg" }
[sources]
setpoint = "sourced: data sheet"
motor.gear_ratio = "computed: from the teeth"
"setpoint.motor.inertia" = "inferred: from its size"
"""


def test_a_setpoint_with_its_motor(tmp_path: Path) -> None:
    joint = load_device(_write(tmp_path, _SERIAL)).joints[0]
    assert joint.setpoint is not None
    assert joint.setpoint.motor is not None
    assert joint.setpoint.slope == -4e-4
    assert joint.setpoint.value(50.0) == 0.1 - 4e-4 * 50.0
    assert (joint.gear_ratio("setpoint"), joint.gear_ratio("theta")) == (23.0, 50.0)
    assert joint.setpoint.motor.reflected_inertia == Uncertain(1e-7 * 23.0**2)


def test_a_setpoint_on_the_motors_side_is_an_angle(tmp_path: Path) -> None:
    device = load_device(_write(tmp_path, _SERIAL))
    found = map_channels(device, ["time", "theta_c"], "log.csv")
    (column,) = found.columns
    # Degrees of the motor, 23 of its turns to one behind the gear.
    assert column.slope == pytest.approx(pi / 180.0 / 23.0, rel=1e-15)


def test_a_direct_setpoint_is_what_is_logged() -> None:
    setpoint = Setpoint(law="direct")
    assert (setpoint.value(0.3), setpoint.slope) == (0.3, 1.0)


def test_sources_cover_what_is_below_them(tmp_path: Path) -> None:
    joint = load_device(_write(tmp_path, _SERIAL)).joints[0]
    assert joint.source_of("setpoint.b") == "sourced: data sheet"
    assert joint.source_of("setpoint.motor.gear_ratio") == "sourced: data sheet"
    assert joint.source_of("setpoint.motor.inertia") == "inferred: from its size"
    assert joint.source_of("motor[1].gear_ratio") == "computed: from the teeth"
    assert joint.source_of("motor.inertia") is None


def test_sources_of_several_joints() -> None:
    tables = {
        "name": "arm",
        "sources": {"link": "sourced: a", "encoders": "sourced: b"},
        "joint": [{"name": "one"}, {"name": "two", "sources": {"link": "inferred: c"}}],
    }
    one, two = device_from_tables(tables, "test").joints
    assert (one.source_of("link.inertia"), two.source_of("link.inertia")) == (
        "sourced: a",
        "inferred: c",
    )
    assert two.source_of("encoders.link") == "sourced: b"


def test_antagonistic_roles() -> None:
    channels = {
        "torque_measured2": {"name": "t2", "side": "motor"},
        "stiffness1_true": "k1",
        "torque2_true": "t",
    }
    motors = [{"gear_ratio": 2.0}, {"gear_ratio": 3.0}]
    tables = {"name": "v", "actuation": "antagonistic", "motor": motors, "channels": channels}
    joint = device_from_tables(tables, "test").joints[0]
    assert joint.gear_ratio("torque_measured2") == 3.0
    assert {"torque_measured", "stiffness2_true", "torque1_true"} <= set(joint.roles)


def test_a_transmission_is_written_as_in_the_file() -> None:
    table = {"law": "odd_polynomial", "coefficients": [1.0, 2.0], "zero": "mean", "limit": 0.5}
    written = Transmission.model_validate(table).model_dump(mode="json", exclude_none=True)
    assert written == {**table, "damping": 0.0, "preload": 0.0}
    assert Transmission.model_validate(written) == Transmission.model_validate(table)


def test_the_examples_load(project: Path) -> None:
    files = sorted((project / "examples" / "devices").glob("*.toml"))
    assert len(files) >= 3
    for file in files:
        assert load_device(file).joints
