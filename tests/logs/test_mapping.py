"""Channels: factor, offset, sign, then unit, then side; canonical columns; the clock."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs import Log, open_log, read_log, write_table
from rotatum.models import ROLES, device_from_tables
from rotatum.models.channel import STATES
from rotatum.simulation.sensing.sensors import ENCODERS

Table = dict[str, NDArray[Any]]


def _read(folder: Path, table: Table, **device: Any) -> Log:
    path = folder / "run.npz"
    write_table(path, table)
    return read_log(path, device_from_tables({"name": "rig", **device}, "rig.toml"))


def test_factor_offset_sign_unit_side_in_this_order(tmp_path: Path, table: Table) -> None:
    theta = {"factor": 2.0, "offset": 5.0, "sign": -1, "unit": "deg", "side": "motor"}
    tau = {"factor": 0.1, "offset": 3.0, "sign": -1, "unit": "N mm", "side": "motor"}
    log = _read(
        tmp_path,
        table,
        motor={"gear_ratio": -50.0},
        channels={"theta": {"name": "j.theta", **theta}, "tau": {"name": "j.tau", **tau}},
    )
    joint = log.joints["rig"]
    # A few roundings at values of about 10.
    expected = -(2.0 * table["j.theta"] + 5.0) * pi / 180 / -50.0
    np.testing.assert_allclose(joint["theta"], expected, rtol=1e-14)
    expected = -(0.1 * table["j.tau"] + 3.0) * 1e-3 * -50.0
    np.testing.assert_allclose(joint["tau"], expected, rtol=1e-13, atol=1e-15)


def test_both_sides_of_an_antagonistic_joint_have_a_gear_of_their_own(
    tmp_path: Path, table: Table
) -> None:
    sides = {
        role: {"name": "j.tau", "side": "motor"}
        for role in ("theta1", "theta2", "tau1", "tau2", "torque_measured1", "torque_measured2")
    }
    log = _read(
        tmp_path,
        table,
        actuation="antagonistic",
        motor=[{"gear_ratio": 50.0}, {"gear_ratio": -80.0}],
        channels={"q": "j.q", **sides},
    )
    joint = log.joints["rig"]
    for end, ratio in (("1", 50.0), ("2", -80.0)):
        # One rounding each.
        np.testing.assert_allclose(joint[f"theta{end}"], table["j.tau"] / ratio, rtol=1e-15)
        for role in ("tau", "torque_measured"):
            np.testing.assert_allclose(joint[f"{role}{end}"], table["j.tau"] * ratio, rtol=1e-15)


def test_a_setpoint_has_the_gear_of_its_motor(tmp_path: Path, table: Table) -> None:
    lever = {"law": "lever", "r0": 0.1, "b": 4e-4, "motor": {"gear_ratio": 23.0}}
    channel = {"name": "j.tau", "side": "motor", "unit": "deg"}
    log = _read(
        tmp_path,
        table,
        actuation="serial",
        setpoint=lever,
        channels={"q": "j.q", "setpoint": channel},
    )
    expected = np.deg2rad(table["j.tau"]) / 23.0
    np.testing.assert_allclose(log.joints["rig"]["setpoint"], expected, rtol=1e-14)  # roundings


def test_canonical_columns_of_a_pair(tmp_path: Path, table: Table) -> None:
    for role in ROLES["antagonistic"]:
        table[f"j.{role}"] = table["j.q"]
    log = _read(tmp_path, table, actuation="antagonistic")
    # j.theta and j.tau are no roles; true positions and rates come on request
    measured = set(ROLES["antagonistic"]) - set(STATES["antagonistic"])
    assert set(log.joints["j"]) == measured


def test_every_role_is_in_the_reference(project: Path) -> None:
    text = (project / "docs" / "reference" / "log-files.md").read_text("utf-8")
    told = text[text.index("## Roles") : text.index("## Canonical")]
    missing = {role for roles in ROLES.values() for role in roles if f"`{role}`" not in told}
    assert not missing


def test_units_give_the_same_log(tmp_path: Path, table: Table) -> None:
    si = _read(tmp_path, table)
    other = {
        "time": table["time"] * 1e3,
        "j.q": np.rad2deg(table["j.q"]),
        "j.theta": np.rad2deg(table["j.theta"]),
        "j.tau": table["j.tau"] * 1e3,
    }
    channels = {
        "time": {"unit": "ms"},
        "q": {"unit": "deg"},
        "theta": {"unit": "deg"},
        "tau": {"unit": "Nmm", "hold": "held"},
    }
    log = _read(tmp_path, other, channels=channels)
    assert log.period == pytest.approx(si.period, rel=1e-12)
    for role, values in si.joints["j"].items():
        # To and fro between the units: two roundings.
        np.testing.assert_allclose(log.joints["j"][role], values, rtol=1e-15, atol=1e-18)
    assert log.holds["j"] == {"q": "sampled", "theta": "sampled", "tau": "held"}


def test_the_only_prefix_is_the_joint(tmp_path: Path, table: Table) -> None:
    assert list(_read(tmp_path, table).joints) == ["j"]


def test_the_devices_own_prefix_wins(tmp_path: Path, table: Table) -> None:
    both = {**table, **{f"rig.{n[2:]}": 2.0 * c for n, c in table.items() if n != "time"}}
    log = _read(tmp_path, both)
    assert list(log.joints) == ["rig"]
    assert np.array_equal(log.joints["rig"]["q"], both["rig.q"])


def test_truth_columns_come_along(tmp_path: Path, table: Table) -> None:
    log = _read(tmp_path, {**table, "j.stiffness_true": np.full(300, 7.0)})
    assert log.joints["j"]["stiffness_true"][0] == 7.0
    assert log.warnings == ()  # truth may be constant


@pytest.mark.parametrize("actuation", ["series", "antagonistic", "serial"])
def test_true_states_come_on_request(actuation: str, tmp_path: Path, table: Table) -> None:
    for number, role in enumerate(ROLES[actuation]):
        table[f"j.{role}"] = table["j.q"] + number
    path = tmp_path / "run.npz"
    write_table(path, table)
    device = device_from_tables({"name": "rig", "actuation": actuation}, "rig.toml")
    plain, log = read_log(path, device), read_log(path, device, true_states=True)
    # what the simulator writes: positions, and their rates with a "d" in front
    positions = {role for role in ROLES[actuation] if role in ENCODERS}
    states = {f"{d}{role}_true" for role in positions for d in ("", "d")}
    assert set(log.joints["j"]) - set(plain.joints["j"]) == states == set(STATES[actuation])
    for role in states:
        assert np.array_equal(log.joints["j"][role], table[f"j.{role}"])
    reader = open_log(path, device, chunk=100, true_states=True)
    assert set(reader.roles["j"]) == set(ROLES[actuation])
    joined = np.concatenate([piece.joints["j"]["dq_true"] for piece in reader])
    assert np.array_equal(joined, table["j.dq_true"])


def test_true_states_in_other_columns_and_units(tmp_path: Path, table: Table) -> None:
    table["laser"] = np.rad2deg(table["j.q"])
    path = tmp_path / "run.npz"
    write_table(path, table)
    channels = {"q": "j.q", "q_true": {"name": "laser", "unit": "deg"}}
    device = device_from_tables({"name": "j", "channels": channels}, "rig.toml")
    log = read_log(path, device, true_states=True)
    # to and fro: two roundings
    np.testing.assert_allclose(log.joints["j"]["q_true"], table["j.q"], rtol=1e-15)
    assert "q_true" not in read_log(path, device).joints["j"]


def test_true_states_may_stand_still(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.npz"
    write_table(path, {**table, "j.q_true": np.zeros(300), "j.dq_true": np.zeros(300)})
    device = device_from_tables({"name": "j"}, "rig.toml")
    assert read_log(path, device, true_states=True).warnings == ()
    # and one that is empty is no matter for who did not ask for it
    write_table(path, {**table, "j.q_true": np.full(300, np.nan)})
    assert read_log(path, device).warnings == ()
    with pytest.raises(LogError, match="q_true of joint j never holds a finite number"):
        read_log(path, device, true_states=True)


def test_several_joints(tmp_path: Path, table: Table) -> None:
    more = {**table, "k.q": table["j.q"] + 1.0, "k.theta": table["j.theta"]}
    log = _read(tmp_path, more, joint=[{"name": "j"}, {"name": "k"}])
    assert {joint: tuple(roles) for joint, roles in log.joints.items()} == {
        "j": ("q", "theta", "tau"),
        "k": ("q", "theta"),
    }


def test_a_joint_without_channels_is_named(tmp_path: Path, table: Table) -> None:
    with pytest.raises(LogError, match=r"no channel of joint k; .* such as k\.q"):
        _read(tmp_path, table, joint=[{"name": "j"}, {"name": "k"}])


def test_an_unknown_channel_suggests(tmp_path: Path, table: Table) -> None:
    with pytest.raises(LogError, match=r"rig\.q, got 'j\.qq'; allowed: .*Did you mean \"j\.q\""):
        _read(tmp_path, table, channels={"q": "j.qq"})


def test_the_period_stands_in_for_a_clock(tmp_path: Path, table: Table) -> None:
    del table["time"]
    log = _read(tmp_path, table, estimator={"period": 0.002})
    np.testing.assert_allclose(log.time, 0.002 * np.arange(300), rtol=1e-15)
    assert log.warnings == ("the log has no clock; the device's period of 0.002 s is used",)


def test_neither_clock_nor_period(tmp_path: Path, table: Table) -> None:
    del table["time"]
    with pytest.raises(LogError, match='no column "time"'):
        _read(tmp_path, table)


def _rows(table: Table, by_sample: bool) -> Table:
    stacked = np.stack([table["j.q"], table["j.theta"]])
    return {"time": table["time"], "a": stacked.T if by_sample else stacked}


@pytest.mark.parametrize("by_sample", [True, False])
def test_index_takes_the_axis_that_is_not_time(
    by_sample: bool, tmp_path: Path, table: Table
) -> None:
    np.savez(tmp_path / "run.npz", **_rows(table, by_sample))
    channels = {"q": {"name": "a", "index": 0}, "theta": {"name": "a", "index": 1}}
    device = device_from_tables({"name": "rig", "channels": channels}, "rig.toml")
    log = read_log(tmp_path / "run.npz", device)
    assert np.array_equal(log.joints["rig"]["theta"], table["j.theta"])


@pytest.mark.parametrize(
    ("channel", "message"),
    [
        ({"name": "a"}, r"is 2 x 300.*Give the index"),
        ({"name": "a", "index": 2}, r"no such index, got 2; allowed: 0 to 1"),
        ({"name": "time", "index": 4}, r"has one dimension; its only index is 0"),
        ({"name": "short"}, r"rig\.q has 299 samples but time has 300"),
        ({"name": "small", "index": 0}, r"is 3 x 4; neither side has 300 samples"),
        ({"name": "text"}, r"does not hold numbers"),
        ({"name": "empty"}, r"is empty"),
    ],
)
def test_arrays_that_do_not_fit(
    channel: dict[str, Any], message: str, tmp_path: Path, table: Table
) -> None:
    np.savez(
        tmp_path / "run.npz",
        **_rows(table, False),
        short=table["j.q"][:-1],
        small=np.zeros((3, 4)),
        text=np.array(["x"] * 300),
        empty=np.zeros(0),
    )
    device = device_from_tables({"name": "rig", "channels": {"q": channel}}, "rig.toml")
    with pytest.raises(LogError, match=message):
        read_log(tmp_path / "run.npz", device)


def test_an_index_needs_an_array(tmp_path: Path, table: Table) -> None:
    write_table(tmp_path / "run.csv", table)
    tables = {"name": "rig", "channels": {"q": {"name": "j.q", "index": 1}}}
    with pytest.raises(LogError, match=r"index is for 2-D arrays"):
        read_log(tmp_path / "run.csv", device_from_tables(tables, "rig.toml"))
