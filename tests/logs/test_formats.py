"""The same log in every format gives the same numbers."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from numpy.typing import NDArray

from rotatum.logs import open_log, read_log, write_table
from rotatum.models import Device, device_from_tables

Table = dict[str, NDArray[Any]]


@pytest.mark.parametrize("ending", ["csv", "csv.gz", "tsv", "npz", "parquet"])
def test_what_is_written_is_read(ending: str, tmp_path: Path, table: Table, plain: Device) -> None:
    path = tmp_path / f"run.{ending}"
    write_table(path, table)
    log = read_log(path, plain)
    # Text keeps 12 significant digits of values below 2; the other formats keep them all.
    tolerance = 1e-11 if "sv" in ending else 0.0
    assert np.array_equal(log.time, table["time"])
    for role in ("q", "theta", "tau"):
        np.testing.assert_allclose(
            log.joints["j"][role], table[f"j.{role}"], atol=tolerance, rtol=0
        )
    assert log.holds["j"]["tau"] == "sampled"
    assert log.samples == 300
    assert log.period == pytest.approx(1e-3, rel=1e-12)
    assert log.warnings == ()
    again = tmp_path / "again.npz"
    write_table(again, log.columns())
    assert np.array_equal(read_log(again, plain).joints["j"]["q"], log.joints["j"]["q"])


def _struct_device(index: int | None) -> Device:
    def channel(name: str) -> dict[str, Any]:
        return {"name": name} if index is None else {"name": name, "index": index}

    channels = {
        "time": "rec.t",
        "q": channel("rec.pos.q"),
        "theta": channel("rec.pos.theta"),
        "tau": channel("rec.tau"),
    }
    return device_from_tables({"name": "j", "channels": channels}, "rig.toml")


def _struct(table: Table) -> dict[str, Any]:
    def stacked(name: str) -> NDArray[Any]:
        return np.stack([0.0 * table[name], table[name]])

    pos = {"q": stacked("j.q"), "theta": stacked("j.theta")}
    return {"rec": {"t": table["time"], "pos": pos, "tau": stacked("j.tau")}}


def test_mat_with_nested_structs(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, _struct(table))
    log = read_log(path, _struct_device(1))
    assert np.array_equal(log.joints["j"]["q"], table["j.q"])
    assert np.array_equal(log.joints["j"]["tau"], table["j.tau"])


def test_mat_of_version_4(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.mat"
    plain_names = {name.replace("j.", ""): column for name, column in table.items()}
    scipy.io.savemat(path, plain_names, format="4")
    channels = {role: role for role in ("time", "q", "theta", "tau")}
    device = device_from_tables({"name": "j", "channels": channels}, "rig.toml")
    assert np.array_equal(read_log(path, device).joints["j"]["theta"], table["j.theta"])


@pytest.mark.parametrize("transposed", [False, True])
def test_hdf5_either_way_round(transposed: bool, tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["rec/t"] = table["time"][:, None]
        for role, place in (("q", "pos/q"), ("theta", "pos/theta"), ("tau", "tau")):
            column = np.stack([0.0 * table[f"j.{role}"], table[f"j.{role}"]])
            file[f"rec/{place}"] = column.T if transposed else column
    # MATLAB writes its own 512 bytes before the HDF5 part.
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    reader = open_log(path, _struct_device(1))
    assert reader.format == "HDF5"
    (log,) = reader
    assert np.array_equal(log.joints["j"]["tau"], table["j.tau"])


def test_integers_and_single_precision(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.npz"
    microseconds = np.arange(300, dtype=np.uint64) * 1000 + 1_530_821_160_115_114
    counts = np.arange(300, dtype=np.int32)
    np.savez(path, t=microseconds, q=counts, theta=table["j.theta"].astype(np.float32))
    channels = {"time": {"name": "t", "unit": "us"}, "q": "q", "theta": "theta"}
    log = read_log(path, device_from_tables({"name": "j", "channels": channels}, "rig.toml"))
    # A double holds 1.5e9 s to 2.4e-7 s: the period is known to that.
    assert log.period == pytest.approx(1e-3, abs=3e-7)
    assert log.joints["j"]["q"][-1] == 299.0


_LAYOUTS = {
    "comma": "t,q,m\n{},{},{}\n",
    "semicolon and decimal comma": "t;q;m\n{};{};{}\n",
    "tab": "t\tq\tm\n{}\t{}\t{}\n",
    "blanks": "t  q  m\n  {}   {}  {}\n",
    "quoted names": '"t","q","m"\n{},{},{}\n',
    "windows lines": "t,q,m\r\n{},{},{}\r\n",
    "comment as header": "# t,q,m\n{},{},{}\n",
    "comments before the header": "# a rig\n# on a day\nt,q,m\n{},{},{}\n",
    "byte order mark": "\ufefft,q,m\n{},{},{}\n",
    "blank lines": "\nt,q,m\n\n{},{},{}\n",
}


@pytest.mark.parametrize("layout", _LAYOUTS.values(), ids=_LAYOUTS.keys())
@pytest.mark.parametrize("packed", [False, True])
def test_text_layouts(layout: str, packed: bool, tmp_path: Path, table: Table) -> None:
    head, row = layout.rsplit("{}", 3)[0], layout[layout.index("{}") :]
    end = head.rindex("\n") + 1
    head, row = head[:end], head[end:] + row
    lines = [
        row.format(*(repr(float(v)) for v in values))
        for values in zip(table["time"], table["j.q"], table["j.theta"], strict=True)
    ]
    body = "".join(lines)
    text = head + (body.replace(".", ",") if ";" in row else body)
    path = tmp_path / ("run.csv.gz" if packed else "run.csv")
    path.write_bytes(gzip.compress(text.encode()) if packed else text.encode())
    channels = {"time": "t", "q": "q", "theta": "m"}
    log = read_log(path, device_from_tables({"name": "j", "channels": channels}, "rig.toml"))
    # repr gives every double back exactly.
    assert np.array_equal(log.joints["j"]["q"], table["j.q"])
    assert np.array_equal(log.joints["j"]["theta"], table["j.theta"])


def test_text_without_header_by_number(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.txt"
    np.savetxt(path, np.column_stack([table["time"], table["j.q"], table["j.theta"]]))
    channels = {"time": {"index": 0}, "q": {"index": 1}, "theta": "2"}
    log = read_log(path, device_from_tables({"name": "j", "channels": channels}, "rig.toml"))
    # savetxt writes 19 significant digits.
    assert np.array_equal(log.joints["j"]["theta"], table["j.theta"])


def test_columns_of_text_that_are_not_asked_for(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "run.csv"
    rows = (
        f'"a, b",{t!r},{q!r}\n'
        for t, q in zip(table["time"].tolist(), table["j.q"].tolist(), strict=True)
    )
    path.write_text("note,time,j.q\n" + "".join(rows))
    log = read_log(path, device_from_tables({"name": "j"}, "rig.toml"))
    assert np.array_equal(log.joints["j"]["q"], table["j.q"])


def test_one_column_for_two_roles(tmp_path: Path, table: Table) -> None:
    for ending in ("csv", "parquet", "npz"):
        path = tmp_path / f"run.{ending}"
        write_table(path, table)
        channels = {"q": "j.q", "theta": "j.q"}
        log = read_log(path, device_from_tables({"name": "x", "channels": channels}, "rig.toml"))
        assert np.array_equal(log.joints["x"]["q"], log.joints["x"]["theta"])
