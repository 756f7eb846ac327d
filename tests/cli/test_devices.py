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


def test_one_device_has_values_units_and_text() -> None:
    done = run("devices", "series-demo")
    assert done.code == 0
    assert "kg m^2, motor side" in done.out
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
    told = {key: (value, unit) for key, value, unit in values(joint)}
    assert told["motor.inertia"] == ("3e-05", "kg m^2, motor side")
    assert told["basis.full"] == ("no", "")
