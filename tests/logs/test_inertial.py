"""Accelerometers and gyroscopes of a device, from its log."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs import Log, open_log, read_log, write_table
from rotatum.models import Device, device_from_tables, load_device
from rotatum.simulation.scenario.device_tables import device_toml, plain_channels

Table = dict[str, NDArray[Any]]
# "imu" is two sensors of one name, as one housing has them.
AXES = {"imu": ("ax", "ay", "az", "gx", "gy", "gz"), "tool": ("az",)}


def _device(**channels: Any) -> Device:
    """A pendulum with three sensors; `channels` are those of the accelerometer imu."""
    imu = {"name": "imu", "frame": "tip"}
    return device_from_tables(
        {
            "name": "j",
            "robot": {"model": "pendulum", "lengths": [0.5], "masses": [1.0]},
            "accelerometer": [
                {**imu, "channels": channels},
                {"name": "tool", "frame": "tip", "axes": ["z"]},
            ],
            "gyroscope": [imu],
        },
        "rig.toml",
    )


@pytest.fixture
def inertial(table: Table) -> Table:
    """The small log with the columns of all sensors, each another number."""
    rng = np.random.default_rng(3)
    names = [f"{name}.{axis}" for name, axes in AXES.items() for axis in axes]
    return {**table, **{name: rng.standard_normal(300) for name in names}}


def _write(path: Path, table: Table) -> None:
    if path.suffix == ".h5":
        with h5py.File(path, "w") as file:
            file.update({name.replace(".", "/"): column for name, column in table.items()})
    elif path.suffix == ".mat":
        nested: dict[str, Any] = {}
        for name, column in table.items():
            owner, _, role = name.rpartition(".")
            (nested.setdefault(owner, {}) if owner else nested)[role] = column
        scipy.io.savemat(path, nested)
    else:
        write_table(path, table)


def _read(folder: Path, table: Table, device: Device) -> Log:
    _write(folder / "run.npz", table)
    return read_log(folder / "run.npz", device)


@pytest.mark.parametrize("ending", ["csv", "npz", "mat", "h5", "parquet"])
def test_canonical_columns_of_every_format(ending: str, tmp_path: Path, inertial: Table) -> None:
    path = tmp_path / f"run.{ending}"
    _write(path, inertial)
    reader = open_log(path, _device(), chunk=64)
    assert reader.inertial_roles == AXES
    assert reader.roles == {"j": ("q", "theta", "tau")}
    pieces = list(reader)
    assert len(pieces) == 5
    whole = read_log(path, _device())
    assert whole.inertial_roles == AXES
    for name, axes in AXES.items():
        for axis in axes:
            given = inertial[f"{name}.{axis}"]
            # text keeps 12 significant digits of values of a few units
            tolerance = 1e-11 if ending == "csv" else 0.0
            np.testing.assert_allclose(whole.inertial[name][axis], given, atol=tolerance, rtol=0)
            joined = np.concatenate([piece.inertial[name][axis] for piece in pieces])
            assert np.array_equal(joined, whole.inertial[name][axis])
    assert whole.columns().keys() == inertial.keys()


def test_those_that_are_absent_are_no_error(tmp_path: Path, inertial: Table, table: Table) -> None:
    log = _read(tmp_path, table, _device())
    assert (log.inertial, log.inertial_roles, log.inertial_warnings) == ({}, {}, ())
    del inertial["imu.ay"], inertial["tool.az"]
    (tmp_path / "more").mkdir()
    log = _read(tmp_path / "more", inertial, _device())
    assert log.inertial_roles == {"imu": ("ax", "az", "gx", "gy", "gz")}


def test_axes_a_sensor_does_not_have_are_not_read(tmp_path: Path, inertial: Table) -> None:
    inertial["tool.ax"] = inertial["tool.az"]
    assert _read(tmp_path, inertial, _device()).inertial_roles["tool"] == ("az",)


@pytest.mark.parametrize(
    ("unit", "factor"), [("g", 9.80665), ("mg", 9.80665e-3), ("m/s2", 1.0), (None, 1.0)]
)
def test_factor_offset_sign_then_unit(
    unit: str | None, factor: float, tmp_path: Path, inertial: Table
) -> None:
    ax = {"name": "acc", "factor": 2.0, "offset": 5.0, "sign": -1}
    inertial["acc"] = inertial.pop("imu.ax")
    log = _read(tmp_path, inertial, _device(ax=ax | ({"unit": unit} if unit else {})))
    expected = -(2.0 * inertial["acc"] + 5.0) * factor
    # a few roundings of values of up to 100
    np.testing.assert_allclose(log.inertial["imu"]["ax"], expected, rtol=1e-13, atol=1e-14)
    assert np.array_equal(log.inertial["imu"]["ay"], inertial["imu.ay"])  # where it always is


@pytest.mark.parametrize("unit", ["deg/s", "dps", "°/s"])
def test_a_gyroscope_in_degrees(unit: str, tmp_path: Path, inertial: Table) -> None:
    device = device_from_tables(
        {
            "name": "j",
            "robot": {"model": "pendulum", "lengths": [0.5], "masses": [1.0]},
            "gyroscope": [
                {"name": "imu", "frame": "tip", "axes": ["y"], "channels": {"gy": {"unit": unit}}}
            ],
        },
        "rig.toml",
    )
    log = _read(tmp_path, inertial, device)
    expected = inertial["imu.gy"] * pi / 180.0
    np.testing.assert_allclose(log.inertial["imu"]["gy"], expected, rtol=1e-15)  # one rounding


def test_rows_of_an_array(tmp_path: Path, inertial: Table) -> None:
    stacked = np.stack([inertial.pop(f"imu.a{axis}") for axis in "xyz"])
    channels = {f"a{axis}": {"name": "acc", "index": k} for k, axis in enumerate("xyz")}
    np.savez(tmp_path / "run.npz", acc=stacked, **inertial)
    log = read_log(tmp_path / "run.npz", _device(**channels))
    for axis, given in zip("xyz", stacked, strict=True):
        assert np.array_equal(log.inertial["imu"][f"a{axis}"], given)


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_a_channel_that_is_named_and_absent_suggests(
    ending: str, tmp_path: Path, inertial: Table
) -> None:
    inertial["imu0_acc"] = inertial.pop("imu.ax")
    path = tmp_path / f"run.{ending}"
    write_table(path, inertial)
    device = _device(ax="imu0_ac")
    with pytest.raises(LogError, match=r"imu\.ax, got 'imu0_ac'; .*Did you mean \"imu0_acc\""):
        read_log(path, device)
    # who does not read them is not held up
    assert open_log(path, device, inertial=False).inertial_roles == {}
    assert read_log(path, device, inertial=False).inertial == {}


def test_what_is_odd_about_them_is_told_apart(tmp_path: Path, inertial: Table) -> None:
    inertial["imu.ax"][50:60] = np.nan
    inertial["imu.ax"][70] = np.inf
    inertial["imu.ay"][:] = np.nan
    inertial["imu.gx"][:] = 0.0  # at rest: nothing odd
    log = _read(tmp_path, inertial, _device())
    assert np.flatnonzero(np.isnan(log.inertial["imu"]["ax"])).tolist() == [*range(50, 60), 70]
    assert log.warnings == ()
    assert log.inertial_warnings == (
        "ax of sensor imu: 11 of 300 samples are not finite (in 2 runs, first at 0.05 s)",
        "ay of sensor imu never holds a finite number",
    )
    reader = open_log(tmp_path / "run.npz", _device(), chunk=90)
    assert not reader.inertial_warnings  # not read yet
    list(reader)
    assert reader.inertial_warnings == log.inertial_warnings
    assert reader.warnings == ()


def test_the_file_of_a_device_keeps_its_sensors_and_their_channels(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    device = _device(ax={"name": "acc", "unit": "g", "factor": -1.0}, ay="acc_y")
    path.write_text(device_toml(device))
    read = load_device(path)
    assert read.accelerometers == device.accelerometers
    assert read.gyroscopes == device.gyroscopes
    # a simulated log is in canonical columns, whatever others of the device are in
    plain = plain_channels(device, {})
    assert plain.inertial == _device().inertial
