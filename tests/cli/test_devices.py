"""`rotatum devices`."""

from __future__ import annotations

import json
import tomllib

from rotatum import device_names, load_device
from rotatum.cli.device_values import UNITS, values
from rotatum.models import Basis, Encoders, EstimatorSettings, Link, Motor, Setpoint, Transmission
from tests.cli.conftest import Scene
from tests.cli.runs import run


def test_the_catalogue_is_listed() -> None:
    done = run("devices")
    assert done.code == 0
    assert all(name in done.out for name in device_names())
    told = json.loads(run("devices", "--json").out)
    assert [device["name"] for device in told] == list(device_names())
    assert all(device["about"] and device["joints"] for device in told)
    row = next(line for line in done.out.splitlines() if "qbmove-advanced" in line)
    assert "antagonistic" in row
    assert "sinh" in row


def test_one_device_has_values_units_and_text() -> None:
    done = run("devices", "series-demo")
    assert done.code == 0
    assert "kg m^2, motor side" in done.out
    row = next(line for line in done.out.splitlines() if "motor.inertia" in line)
    assert row.split()[-1] == "inferred"
    text = done.out[done.out.index("# catalogue:series-demo") :]
    assert tomllib.loads(text)["motor"]["gear_ratio"] == 100
    (joint,) = json.loads(run("devices", "series-demo", "--json").out)["joints"]
    assert joint["motors"][0]["inertia"]["value"] == 3.0e-5


def test_a_file_is_shown_too(scene: Scene) -> None:
    done = run("devices", scene.device)
    assert done.code == 0
    assert scene.device.read_text() in done.out


def test_an_unknown_name_suggests() -> None:
    done = run("devices", "compact-sae")
    assert done.code == 2
    assert "compact-sea" in done.err


def test_units_are_of_keys_that_exist() -> None:
    parts = {
        "motor": Motor, "setpoint": Setpoint, "transmission": Transmission, "link": Link,
        "encoders": Encoders, "basis": Basis, "estimator": EstimatorSettings,
    }  # fmt: skip
    for key in UNITS:
        table, _, name = key.partition(".")
        assert name in parts[table].model_fields, key


def test_a_value_with_its_interval_is_told() -> None:
    joint = load_device("series-demo").joints[0]
    told = {value.key: value[1:3] for value in values(joint)}
    assert told["motor.inertia"] == ("3e-05", "kg m^2, motor side")
    assert told["transmission.cubic"] == ("20000", "N m/rad^3")
    assert told["basis.full"] == ("no", "")


def test_each_motor_and_each_transmission_is_told() -> None:
    told = {v.key: v for v in values(load_device("qbmove-maker-pro").joints[0])}
    assert told["transmission[1].k"].text == "0.0216"
    assert told["transmission[1].k"].unit == "N m"
    assert told["motor[1].damping"].source.startswith("computed: ")
    awas = {v.key: v for v in values(load_device("awas").joints[0])}
    assert awas["setpoint.motor.gear_ratio"].text == "23"
    assert awas["setpoint.motor.inertia"].unit == "kg m^2, motor side"
    assert awas["transmission.spring"].unit == "N/m"
    # What the file leaves out is nobody's number.
    assert awas["motor.coulomb"].source == "default"
    assert awas["motor.damping"].source.startswith("sourced: ")
