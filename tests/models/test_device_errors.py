"""Device files that are wrong: the error names the file, the key, the value and what is allowed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rotatum.errors import DeviceError
from rotatum.models import device_from_tables, load_device

_WRONG: list[tuple[dict[str, Any], str]] = [
    ({"motor": {"inertia": 0.0}}, r"motor\.inertia must be greater than 0, got 0\.0"),
    ({"motor": {"inertia": -1.0}}, r"motor\.inertia must be greater than 0, got -1\.0"),
    ({"motor": {"inertia": "1e-3"}}, r"motor\.inertia must be a number"),
    ({"motor": {"inertia": {"value": 1.0, "sd": 1.0}}}, 'unknown key "sd"; allowed: value, std'),
    ({"motor": {"inertia": {"value": 1.0, "std": -1.0}}}, "std must be positive"),
    ({"motor": {"inertia": {"std": 1.0}}}, "needs the key value"),
    ({"motor": {"gear_ratio": 0}}, r"motor\.gear_ratio must not be 0"),
    ({"motor": {"gear_ratio": True}}, r"motor\.gear_ratio must be a number"),
    ({"motor": {"intertia": 1.0}}, r'unknown key "motor\.intertia".*Did you mean "inertia"'),
    ({"motors": [{}]}, r'unknown key "motors".*Did you mean "motor"'),
    ({"motor": [{}, {}]}, r'"series" has 1 motor tables, not 2'),
    ({"actuation": "antagonistic", "motor": {}}, r'"antagonistic" has 2 motor tables, not 1'),
    ({"actuation": "serie"}, r'actuation.*allowed: series, .*Did you mean "series"'),
    ({"encoder": {}}, r'unknown key "encoder".*Did you mean "encoders"'),
    ({"encoders": {"link": -5}}, r"encoders\.link must be greater than 0, got -5"),
    ({"link": {"inertia": 0}}, r"link\.inertia must be greater than 0"),
    ({"basis": {"orders": 2}}, "deflection_range is needed when orders > 1"),
    ({"basis": {"full": True}}, "deflection_range is needed"),
    ({"basis": {"setpoint_orders": 1}}, "setpoint_range is needed"),
    ({"transmission": {"law": "linear"}}, 'law "linear" needs the constant stiffness'),
    ({"transmission": {"stiffness": 1.0}}, "without a law has no constant stiffness"),
    ({"transmission": {"law": "cubic", "stiffness": 1.0}}, "needs the constant cubic"),
    (
        {"transmission": {"law": "linear", "stiffness": 1.0, "cubic": 2.0}},
        'transmission: law "linear" has no constant cubic; it has stiffness',
    ),
    (
        {"transmission": {"law": "sihn", "k": 1.0, "a": 1.0}},
        r'transmission\.law: is none of the known laws.*Did you mean "sinh"',
    ),
    ({"transmission": {"law": 3}}, r"transmission\.law: is none of the known laws, got '3'"),
    (
        {"transmission": {"law": "fourbar", "spring": 1.0, "raito": 2.0}},
        r'unknown key "transmission\.raito".*spring, ratio.*Did you mean "ratio"',
    ),
    ({"transmission": {"given": {}}}, r'unknown key "transmission\.given"'),
    (
        {"transmission": {"law": "linear", "stiffness": -1.0}},
        r"transmission\.stiffness must be greater than 0, got -1\.0",
    ),
    (
        {"transmission": {"law": "linear", "stiffness": "1"}},
        r"transmission\.stiffness must be a number, got '1'",
    ),
    (
        {"transmission": {"law": "fourbar", "spring": 1.0, "ratio": 0.9}},
        "transmission: ratio must be greater than 1",
    ),
    (
        {"transmission": {"law": "odd_polynomial", "coefficients": []}},
        r"transmission\.coefficients must be a list of numbers",
    ),
    (
        {"transmission": {"law": "odd_polynomial", "coefficients": [0.0, -1.0]}},
        "the first coefficient that is not 0 must be positive",
    ),
    (
        {"transmission": {"law": "polynomial", "coefficients": [0.0, 1.0]}},
        "must be positive and belong to an odd power",
    ),
    (
        {"transmission": {"law": "table", "deflection": [0.0, 1.0], "torque": [0.0, 1.0]}},
        "lists of one length, at least 3",
    ),
    (
        {"transmission": {"law": "table", "deflection": [0.0, 1.0, 2.0], "torque": [0, 2, 1]}},
        "must both grow",
    ),
    (
        {"transmission": {"law": "table", "deflection": [0.0, 1.0, 2.0], "torque": [1, 2, 3]}},
        "must contain the deflection at which the torque is 0",
    ),
    ({"transmission": {"limit": 0.0}}, r"transmission\.limit must be greater than 0"),
    ({"transmission": [{}, {}]}, r'"series" has 1 transmission table, not 2'),
    (
        {"actuation": "antagonistic", "transmission": [{}, {}, {}]},
        r'"antagonistic" has 1 or 2 transmission tables, not 3',
    ),
    (
        {"actuation": "antagonistic", "transmission": [{}, {"preloda": 0.1}]},
        r'unknown key "transmission\[1\]\.preloda".*Did you mean "preload"',
    ),
    (
        {"transmission": {"law": "lever", "spring": 1.0}},
        r'law "lever" depends on a set-point, which actuation "series" has not',
    ),
    ({"transmissions": [{}]}, r'unknown key "transmissions".*Did you mean "transmission"'),
    (
        {
            "actuation": "serial",
            "transmission": {
                "law": "maccepa",
                "spring": 1.0,
                "lever": 2.0,
                "base": 1.0,
                "drum": 1.0,
            },
        },
        "lever must be less than base",
    ),
    ({"setpoint": {"law": "direct"}}, r'actuation "series" has no set-point'),
    ({"actuation": "serial", "setpoint": {"law": "lever", "r0": 1.0}}, "needs the constant b"),
    (
        {"actuation": "serial", "setpoint": {"law": "direct", "b": 1.0}},
        r'setpoint: law "direct" has no constant b',
    ),
    (
        {"actuation": "serial", "channels": {"setpoint": {"side": "motor"}}},
        r"channel setpoint.*so \[setpoint\.motor\] gear_ratio is needed",
    ),
    (
        {
            "actuation": "serial",
            "setpoint": {"law": "direct", "motor": {}},
            "channels": {"setpoint": {"side": "motor", "unit": "mm"}},
        },
        "channel setpoint is a length",
    ),
    (
        {
            "actuation": "antagonistic",
            "motor": [{}, {}],
            "channels": {"torque_measured": {"side": "motor"}},
        },
        "channel torque_measured is always at the joint",
    ),
    ({"sources": {"motor": "guessed"}}, r"sources\.motor must begin with \"sourced: \""),
    ({"sources": {"motor": "sourced: "}}, r"sources\.motor must begin with"),
    ({"sources": {"motr": "sourced: x"}}, r'unknown key "sources\.motr".*Did you mean "motor"'),
    (
        {"sources": {"motor": {"inretia": "sourced: x"}}},
        r'unknown key "sources\.motor\.inretia".*Did you mean "inertia"',
    ),
    ({"sources": 3}, r"sources must be a table"),
    ({"transmission": {"zero": "last"}}, r'transmission\.zero must be "first", "mean" or'),
    ({"estimator": {"cutoff": 0.0}}, r"estimator\.cutoff must be greater than 0"),
    ({"estimator": {"cutoff": float("nan")}}, r"estimator\.cutoff must be greater than 0"),
    ({"estimator": {"cutoff": float("inf")}}, "deadbeat form of method"),
    ({"estimator": {"cutoff": 1.0, "window": 1.0}}, "not both"),
    ({"estimator": {"fit": ["dampin"]}}, r"estimator\.fit.*'dampin'.*Did you mean \"damping\""),
    ({"estimator": {"period": -1.0}}, r"estimator\.period must be greater than 0"),
    ({"channels": {"thet": "x"}}, r"channels: unknown channel, got 'thet'.*\"theta\""),
    ({"channels": {"q": {"unit": "degs"}}}, r"channels\.q\.unit: unknown unit.*\"deg\""),
    (
        {"channels": {"q": {"unit": "N m"}}},
        r"channels\.q\.unit: this is a unit of torque.*rad, mrad, deg",
    ),
    (
        {"channels": {"time": {"unit": "deg"}}},
        r"channels\.time\.unit: this is a unit of angle.*: s, ms",
    ),
    (
        {"channels": {"dq_true": {"unit": "deg"}}},
        r"channels\.dq_true\.unit: this is a unit of angle.*: rad/s, deg/s",
    ),
    ({"channels": {"acc": {"unit": "rad/s"}}}, r"unit of speed.*: rad/s\^2, deg/s\^2, m/s\^2, g"),
    ({"channels": {"theta1_true": "x"}}, r"unknown channel.*\"theta_true\""),
    ({"channels": {"q": {"side": "motor"}}}, "channel q is always at the joint"),
    ({"channels": {"theta": {"side": "motor"}}}, r"so \[motor\] gear_ratio is needed"),
    ({"channels": {"q": {"factor": 0.0}}}, r"channels\.q\.factor must not be 0"),
    ({"channels": {"q": {"sign": 2}}}, r"channels\.q\.sign .* allowed: 1, -1"),
    ({"channels": {"q": {"index": -1}}}, r"channels\.q\.index must be greater than or equal to 0"),
    ({"channels": 3}, "channels must be a table"),
    ({"joint": [{"name": "a", "motr": {}}]}, r'unknown key "joint\[0\]\.motr".*"motor"'),
    ({"joint": [{}]}, r'the key "joint\[0\]\.?\.name" is missing'),
    ({"joint": []}, "must be an array of tables"),
    ({"joint": [{"name": "a"}, {"name": "a"}]}, "two joints have the same name"),
    ({"joint": [{"name": "a"}], "motor": {}}, 'unknown key "motor"'),
    ({"joint": [{"name": "a"}], "channels": {"q": "x"}}, r"channels\.q belongs into"),
]


@pytest.mark.parametrize(("tables", "message"), _WRONG, ids=[message for _, message in _WRONG])
def test_wrong_tables(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(DeviceError, match=message) as caught:
        device_from_tables({"name": "rig", **tables}, "rig.toml")
    assert str(caught.value).startswith("rig.toml: ")


def test_the_error_keeps_its_data() -> None:
    with pytest.raises(DeviceError) as caught:
        device_from_tables({"name": "rig", "motor": {"gear_ratio": 0}}, "rig.toml")
    assert (caught.value.where, caught.value.value) == ("rig.toml", 0)


def test_several_errors_are_all_named() -> None:
    tables = {"name": "rig", "motor": {"inertia": -1.0}, "link": {"inertia": -1.0}}
    with pytest.raises(DeviceError, match=r"motor\.inertia.*Also wrong: link\.inertia"):
        device_from_tables(tables, "rig.toml")


def test_a_missing_name() -> None:
    with pytest.raises(DeviceError, match="needs name"):
        device_from_tables({}, "rig.toml")


def test_a_missing_file_suggests_from_the_catalogue() -> None:
    with pytest.raises(DeviceError, match='Did you mean "series-demo"'):
        load_device("series_demo")


def test_broken_toml_says_the_line(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text('name = "rig"\n[motor\n')
    with pytest.raises(DeviceError, match=r"not valid TOML: .*line 2"):
        load_device(path)


def test_binary_and_folder(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(DeviceError, match="not a text file"):
        load_device(path)
    with pytest.raises(DeviceError, match="cannot be read"):
        load_device(tmp_path)
