"""Scenarios: their files, what they refuse, and every ready one."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.errors import RotatumError, ScenarioError
from rotatum.logs import Log, read_log, write_table
from rotatum.models import device_from_tables, device_names, load_device
from rotatum.simulation.scenario import (
    Scenario,
    load_scenario,
    ready_abouts,
    scenario_from_tables,
    scenario_names,
)
from rotatum.simulation.scenario.device_tables import device_toml
from rotatum.simulation.scenario.dotted import assigned, flat, path_of
from rotatum.simulation.scenario.merge import merged

SERIES = """\
device = "series-demo"
seconds = 0.5
period = 0.001
[drives.tau]
kind = "sine"
amplitude = 3.0
frequency = 1.0
"""
ARM = """\
device = "planar-vsa-ii"
seconds = 0.5
period = 0.001
[drives.tau1]
kind = "sine"
amplitude = 0.05
frequency = 1.0
[drives.tau2]
kind = "hold"
value = 0.0
"""


def scenario(text: str, source: str = "my.toml") -> Scenario:
    return scenario_from_tables(tomllib.loads(text), source)


def refused(text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        scenario(text)
    assert str(caught.value).startswith("my.toml: ")
    return str(caught.value)


# What is refused, and what is said of it.


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("[sensor.noise]\nq = 1.0", ['unknown key "sensor"', '"sensors"']),
        ("[sensors.nois]\nq = 1.0", ['unknown key "sensors.nois"', '"noise"']),
        ("[sensors.noise]\nthta = 1.0", ["'thta'", "'theta'"]),
        ("[sensors.noise]\ntheta1 = 1.0", ["series-demo", "theta1"]),
        ("[sensors.noise]\nq = '1'", ["sensors.noise.q must be a number", "'1'"]),
        ("[sensors.encoders]\nlnk = 4096", ['"sensors.encoders.lnk"', '"link"']),
        ("[sensors.encoders]\nlink = -1", ["sensors.encoders.link", "greater than 0", "-1"]),
        ("[sensors]\nencoders = { link = 9 }\ncounts = {}", ["give one of them"]),
        ("[effects]\nbaklash = 1e-3", ['unknown key "effects.baklash"', '"backlash"']),
        ("[effects.drift]\nrate = nan", ["effects.drift.rate", "finite"]),
        ("[effects]\nbacklash = true", ["effects.backlash must be a number"]),
        ("[start]\nthet = 1.0", ['unknown key "start.thet"', '"theta"']),
        ("[truth]\nmoter.inertia = 1.0", ["[truth]", "moter", '"motor"']),
        ("[truth]\nmotor.inertia = -1.0", ["[truth]", "motor.inertia", "greater than 0"]),
        ("[truth]\ntransmission.stiffness = 0.0", ["[truth]", "stiffness"]),
        ("[truth]\nname = 'other'", ["cannot change"]),
        ("[joint.elbow.effects]\nbacklash = 1e-3", ["[joint]", "'elbow'", "series-demo"]),
        ("[joint.series-demo.effect]\nbacklash = 1e-3", ["'effect'", '"effects"']),
        ("[joint.series-demo.effects]\nbaklash = 1.0", ["joint.series-demo.effects.baklash"]),
        ("[joint.series-demo.drives.tau]\nkind = 'sin'", ["joint.series-demo.drives.tau.kind"]),
        ("[estimate]\nsolver = 'qr'", ["estimate.solver", "'qr'", "ud"]),
        ("[[payload]]\nmass = -1.0", ["payload[0]", "positive mass"]),
        ("[inertial.wrist]\nnoise = 1.0", ["[inertial]", "'wrist'"]),
        ("[external]\nkind = 'push'", ["external.kind", "'push'", "sine"]),
    ],
)
def test_a_wrong_key_or_value_is_named_with_what_is_right(more: str, said: list[str]) -> None:
    told = refused(f"{SERIES}{more}\n")
    assert all(word in told for word in said), told


@pytest.mark.parametrize(
    ("drive", "said"),
    [
        ("kind = 'sien'", ["drives.tau.kind", "'sien'", '"sine"']),
        ("amplitude = 1.0", ['"drives.tau.kind" is missing']),
        ("kind = 'sine'\namplitude = 1.0", ['the key "drives.tau.frequency" is missing']),
        ("kind = 'sine'\nampl = 1.0\nfrequency = 1.0", ['"drives.tau.ampl"', '"amplitude"']),
        ("kind = 'scaled'\nfactor = 2.0\nof = { kind = 'sien' }", ["drives.tau.of.kind", "sine"]),
        ("kind = 'ramps'\ntimes = [1.0, 0.0]\nvalues = [0.0, 1.0]", ["ramps.times", "grow"]),
        ("kind = 'fade-in'\nseconds = 1\nof = { kind = 'prbs', amplitude = 1, bit = 1 }",
         ["smooth", "'prbs'"]),
        ("kind = 'file'\npath = 'none.csv'\ncolumn = 'x'", ["none.csv"]),
    ],
)  # fmt: skip
def test_a_wrong_drive_is_named(drive: str, said: list[str]) -> None:
    head = SERIES[: SERIES.index("kind")]
    told = refused(f"{head}{drive}\n")
    assert all(word in told for word in said), told


def test_a_motor_is_not_driven_twice() -> None:
    told = refused(
        f"{SERIES}[drives.motors]\nkind = 'position'\nbandwidth = 9.0\n"
        "path = { kind = 'hold', value = 0.0 }\n"
    )
    assert "not both" in told


def test_a_missing_key_and_an_unknown_device_are_named() -> None:
    assert '"seconds" is missing' in refused('device = "awas"\nperiod = 0.001\n')
    with pytest.raises(RotatumError, match="series-demo"):
        scenario(SERIES.replace("series-demo", "series-dmeo"))
    with pytest.raises(ScenarioError, match='Did you mean "trouble/skew"'):
        load_scenario("skew")


# Tables over tables.


def test_a_joint_overrides_key_by_key() -> None:
    more = (
        "[sensors.noise]\nq = 1e-3\ntau1 = 1e-2\n[joint.elbow.sensors.noise]\nq = 2e-3\n"
        "[joint.elbow.drives.tau1]\nkind = 'hold'\nvalue = 0.01\n[joint.shoulder.start]\nq = 0.1\n"
    )
    shoulder, elbow = scenario(ARM + more).joints
    assert shoulder.sensors.noise == {"q": 1e-3, "tau1": 1e-2}
    assert elbow.sensors.noise == {"q": 2e-3, "tau1": 1e-2}
    assert (shoulder.start, elbow.start) == ({"q": 0.1}, {})
    time = np.array([0.25])
    assert _torque(shoulder.driven(0, None), time) == pytest.approx(0.05)
    assert _torque(elbow.driven(0, None), time) == 0.01


def _torque(drives: Mapping[str, Any], time: np.ndarray) -> float:
    return float(drives["tau1"](time)[0])


def test_one_way_to_drive_replaces_the_other() -> None:
    tau, law = {"kind": "hold", "value": 1.0}, {"kind": "position"}
    assert merged({"drives": {"tau": tau}}, {"drives": {"motors": law}}) == {
        "drives": {"motors": law}
    }
    given = {"drives": {"tau": tau, "setpoint": tau}}
    over = {"drives": {"setpoint_angle": tau}}
    assert merged(given, over) == {"drives": {"tau": tau, "setpoint_angle": tau}}


Trees = st.recursive(
    st.floats(allow_nan=False),
    lambda inner: st.dictionaries(st.sampled_from(["a", "b", "c", "d e"]), inner, min_size=1),
    max_leaves=12,
).filter(lambda tree: isinstance(tree, dict))


@given(Trees, Trees)
def test_merging_keeps_what_is_over_and_adds_nothing(base: Any, over: Any) -> None:
    result = merged(base, over)
    assert merged(result, over) == result
    leaves = dict(flat(result))
    assert all(leaves[key] == value for key, value in flat(over))
    assert all(key in dict(flat(base)) or key in dict(flat(over)) for key in leaves)


@given(Trees, st.floats(allow_nan=False))
def test_a_value_assigned_is_found_and_nothing_else_moves(tree: Any, value: float) -> None:
    key = next(iter(tree))
    new = assigned(tree, (key, "z"), value)
    assert new[key]["z"] == value
    assert {k: v for k, v in new.items() if k != key} == {k: v for k, v in tree.items() if k != key}


def test_dotted_keys() -> None:
    assert path_of('joint."axis 1".drives.tau.of[2].rms') == (
        *("joint", "axis 1", "drives", "tau", "of"), 2, "rms",
    )  # fmt: skip
    for wrong in ("", ".a", "a.", "a..b", "a b", "[0].a", "a[x]"):
        with pytest.raises(ScenarioError, match="dotted key"):
            path_of(wrong)
    two = {"motor": [{"inertia": 1.0}, {"inertia": 2.0}]}
    assert assigned(two, ("motor", "inertia"), 3.0)["motor"] == [{"inertia": 3.0}] * 2
    assert assigned(two, ("motor", 1, "inertia"), 3.0)["motor"][0] == {"inertia": 1.0}
    with pytest.raises(ScenarioError, match="fewer"):
        assigned(two, ("motor", 2, "inertia"), 3.0)


def test_values_are_replaced_by_their_keys() -> None:
    base = scenario(SERIES + "[truth]\nmotor.inertia = 4e-5\n")
    new = base.with_values(
        {"sensors.encoders.link": 1024, "truth.motor.inertia": 5e-5, "drives.tau.amplitude": 1}
    )
    assert new.device.joints[0].encoders.link == 1024.0
    assert new.plant.joints[0].motors[0].inertia.value == 5e-5
    assert base.plant.joints[0].motors[0].inertia.value == 4e-5
    assert new.device.joints[0].motors[0].inertia.value == 3e-5
    assert scenario_from_tables(new.tables, new.source) == new
    with pytest.raises(ScenarioError, match='"amplitude"'):
        base.with_values({"drives.tau.amplitud": 1.0})


# What is true and what is told.


def test_truth_and_told_part_plant_and_device() -> None:
    more = (
        "[truth]\n'motor.inertia' = 1e-3\n'elbow.motor[1].damping' = 0.5\n"
        "[told]\nlink.damping = 0.9\nelbow.encoders.link = 77\n"
        "[joint.shoulder.sensors.encoders]\nlink = 512\n"
    )
    made = scenario(ARM + more)
    shoulder, elbow = made.plant.joints
    assert [m.inertia.value for joint in (shoulder, elbow) for m in joint.motors] == [1e-3] * 4
    assert [m.damping.value for m in elbow.motors] == [1.27e-3, 0.5]
    assert [m.damping.value for m in shoulder.motors] == [1.27e-3] * 2
    assert [joint.link.damping.value for joint in made.device.joints] == [0.9, 0.9]
    assert [m.inertia.value for m in made.device.joints[0].motors] == [1e-4] * 2
    # Users know their encoders: the told device has the scenario's, unless [told] says otherwise.
    assert [joint.encoders.link for joint in made.device.joints] == [512.0, 77.0]
    assert [joint.encoders.link for joint in made.plant.joints] == [512.0, 4059.0]
    assert made.device.robot == made.plant.robot


def test_another_law_leaves_the_old_constants_behind() -> None:
    more = "[truth]\ntransmission = { law = 'linear', stiffness = 300.0 }\n"
    (spring,) = scenario(SERIES + more).plant.joints[0].transmissions
    assert (spring.law, spring.stiffness(0.05)) == ("linear", 300.0)


def test_torques_are_told_as_held_where_they_are() -> None:
    def hold(text: str) -> str:
        channels = scenario(text).device.joints[0].channels
        return channels["tau"].hold if "tau" in channels else "sampled"

    assert hold(SERIES) == "held"
    assert hold("log_period = 0.0005\n" + SERIES) == "held"
    assert hold("log_period = 0.005\n" + SERIES) == "sampled"


@pytest.mark.parametrize("name", device_names())
def test_a_device_survives_its_own_file(name: str) -> None:
    device = load_device(name)
    assert device_from_tables(tomllib.loads(device_toml(device)), device.source) == device


# Files.


def test_files_extend_and_find_what_is_beside_them(tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    text = device_toml(load_device("series-demo")).replace("gear_ratio = 100.0", "gear_ratio = 50")
    (tmp_path / "robots" / "mine.toml").write_text(text)
    (tmp_path / "torque.csv").write_text("time,u\n0.0,1.0\n0.1,2.0\n")
    base = SERIES.replace("series-demo", "robots/mine.toml")
    (tmp_path / "base.toml").write_text(base)
    child = tmp_path / "robots" / "child.toml"
    child.write_text(
        'extends = "../base.toml"\nseconds = 0.2\n'
        '[drives.tau]\nkind = "file"\npath = "../torque.csv"\ncolumn = "u"\n'
    )
    made = load_scenario(child)
    assert (made.name, made.seconds, made.period) == ("child", 0.2, 0.001)
    assert made.device.joints[0].motors[0].gear_ratio == 50.0
    drive = made.joints[0].driven(0, None)["tau"]
    assert np.array_equal(drive(np.array([0.0, 0.15])), [1.0, 2.0])
    assert made.with_values({"seed": 3}).device == made.device


def test_a_circle_of_files_is_refused(tmp_path: Path) -> None:
    for one, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{one}.toml").write_text(f'extends = "{other}.toml"\n')
    with pytest.raises(ScenarioError, match="circle"):
        load_scenario(tmp_path / "a.toml")
    (tmp_path / "a.toml").write_text("seconds = \n")
    with pytest.raises(ScenarioError, match="not valid TOML"):
        load_scenario(tmp_path / "a.toml")


# Every ready scenario.


def test_the_papers_and_a_dozen_troubles_are_there() -> None:
    groups: dict[str, int] = {}
    for name in scenario_names():
        group = name.partition("/")[0]
        groups[group] = groups.get(group, 0) + 1
    papers = {"deluca2007", "flacco2012", "menard2013", "trumic2022"}
    assert set(groups) == {*papers, "link-side", "trouble"}
    assert groups["trouble"] > 20
    assert all(ready_abouts().values())


@pytest.mark.parametrize("name", scenario_names())
def test_a_ready_scenario_runs_and_its_files_read_back(name: str, tmp_path: Path) -> None:
    made = load_scenario(name).with_values({"seconds": _SHORT, **_fewer(name)})
    log = made.run()
    path = tmp_path / "run.npz"
    write_table(path, log.columns())
    (tmp_path / "run.toml").write_text(made.device_text())
    device = load_device(tmp_path / "run.toml")
    assert device.joints == made.device.joints
    read = read_log(path, device, true_states=True)
    assert device.inertial == made.device.inertial
    assert read.inertial_roles == log.inertial_roles
    for sensor, axes in log.inertial.items():
        for axis, values in axes.items():
            assert np.array_equal(read.inertial[sensor][axis], values, equal_nan=True)
    for joint in made.device.joints:
        _check(log, read, joint.name, made)


_SHORT = 0.6  # s: what the slowest log needs to be read, 100 samples


def _fewer(name: str) -> dict[str, object]:
    """Faults that a second has no room for, or that come later."""
    counts = {"dropouts", "repeats", "stale", "nans"}
    given = load_scenario(name).tables.get("sensors", {})
    return {f"sensors.{fault}": 2 for fault in counts if fault in given}


def test_a_seed_decides_everything() -> None:
    values = {"seconds": 0.5, "sensors.noise.q": 1e-4, "sensors.dropouts": 3, "sensors.nans": 2}
    made = load_scenario("trouble/clean").with_values(values)
    one, same, other = made.run(5), made.run(5), made.run(6)
    for role, column in one.columns().items():
        assert np.array_equal(column, same.columns()[role], equal_nan=True)
    # The multisine gives no seed of its own: another seed is another motion.
    assert not np.array_equal(one.joints["series-demo"]["tau"], other.joints["series-demo"]["tau"])
    kept = made.with_values({"drives.tau.of.of[1].seed": 9})
    one, other = kept.run(5), kept.run(6)
    time, places, others = np.intersect1d(one.time, other.time, return_indices=True)
    assert time.size > 400
    torque = one.joints["series-demo"]["tau"][places], other.joints["series-demo"]["tau"][others]
    there = np.isfinite(torque[0]) & np.isfinite(torque[1])
    assert np.array_equal(torque[0][there], torque[1][there])
    angles = one.joints["series-demo"]["q"][places], other.joints["series-demo"]["q"][others]
    assert not np.array_equal(*angles, equal_nan=True)


def _check(log: Log, read: Log, name: str, made: Scenario) -> None:
    channels = log.joints[name]
    truth = channels["stiffness_true"]
    assert np.all(np.isfinite(truth))
    # Zero where a cubic spring is slack, and within a backlash.
    assert np.all(truth >= 0.0)
    assert truth.max() > 0.0
    assert set(read.joints[name]) == set(channels)
    for role, values in channels.items():
        assert np.array_equal(read.joints[name][role], values, equal_nan=True)
        if "nans" not in made.tables.get("sensors", {}):
            assert np.all(np.isfinite(values)), role
    (joint,) = (joint for joint in made.device.joints if joint.name == name)
    for role in ("tau", "tau1", "tau2"):
        if role in channels and role in joint.channels:
            assert joint.channels[role].hold == log.holds[name][role] == read.holds[name][role]


def test_a_quoted_key_of_the_truth_is_a_key_of_the_device():
    base = load_scenario("trouble/clean")
    quoted = base.with_values({'truth."motor.inertia"': 6e-5})
    assert quoted.plant == load_scenario("trouble/rotor-inertia").plant
    assert quoted.plant == base.with_values({"truth.motor.inertia": 6e-5}).plant
    again = load_scenario("trouble/rotor-inertia").with_values({'truth."motor.inertia"': 7e-5})
    assert again.plant.joints[0].motors[0].inertia.value == 7e-5


def test_a_misspelt_table_of_the_sensors_is_told_of_the_encoders():
    with pytest.raises(ScenarioError, match=r'sensors\.encoder".*Did you mean "encoders"\?'):
        load_scenario("trouble/clean").with_values({"sensors.encoder.link": 4096.0})
