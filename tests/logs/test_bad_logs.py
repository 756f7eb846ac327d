"""Bad input: an error that says what and where, or a warning that says how much."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs import read_log, write_table
from rotatum.models import Device, device_from_tables

Table = dict[str, NDArray[Any]]
_ENDINGS = ("csv", "csv.gz", "npz", "parquet", "mat")


def _write(path: Path, table: Table) -> Path:
    if path.suffix == ".mat":
        import scipy.io

        scipy.io.savemat(path, {"time": table["time"], "j": {"q": table["j.q"]}})
    else:
        write_table(path, table)
    return path


def test_missing_file_suggests(tmp_path: Path, table: Table, plain: Device) -> None:
    _write(tmp_path / "run1.csv", table)
    with pytest.raises(LogError, match=r'no such file\. Did you mean "run1\.csv"'):
        read_log(tmp_path / "run.csv", plain)
    with pytest.raises(LogError, match="its folder does not exist either"):
        read_log(tmp_path / "nowhere" / "run.csv", plain)


def test_folder_and_empty_file(tmp_path: Path, plain: Device) -> None:
    with pytest.raises(LogError, match="is a folder"):
        read_log(tmp_path, plain)
    (tmp_path / "run.npz").touch()
    with pytest.raises(LogError, match="is empty"):
        read_log(tmp_path / "run.npz", plain)
    (tmp_path / "run.csv").write_text("\n\n")
    with pytest.raises(LogError, match="is empty"):
        read_log(tmp_path / "run.csv", plain)


def test_header_without_rows(tmp_path: Path, plain: Device) -> None:
    (tmp_path / "run.csv").write_text("time,j.q\n")
    with pytest.raises(LogError, match="holds no samples"):
        read_log(tmp_path / "run.csv", plain)


def test_unreadable_file(
    tmp_path: Path, table: Table, plain: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = _write(tmp_path / "run.csv", table)

    def deny(*args: object, **kwargs: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("builtins.open", deny)  # the tests may run as root, who can read anything
    with pytest.raises(LogError, match=r"cannot be read \(Permission denied\)"):
        read_log(path, plain)


@pytest.mark.parametrize("ending", ["csv.gz", "npz", "parquet", "mat"])
@pytest.mark.parametrize("share", [0.05, 0.5, 0.97])
def test_truncated_file(
    ending: str, share: float, tmp_path: Path, table: Table, plain: Device
) -> None:
    path = _write(tmp_path / f"run.{ending}", table)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(LogError, match=r"damaged or truncated|no column|no channel"):
        read_log(path, plain)


def test_damaged_npz(tmp_path: Path, table: Table, plain: Device) -> None:
    path = _write(tmp_path / "run.npz", table)
    content = bytearray(path.read_bytes())
    content[300:400] = b"\xaa" * 100
    path.write_bytes(content)
    with pytest.raises(LogError, match="damaged or truncated"):
        read_log(path, plain)


def test_truncated_hdf5(tmp_path: Path, table: Table, plain: Device) -> None:
    import h5py

    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        file.update({name.replace(".", "/"): column for name, column in table.items()})
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(LogError, match="damaged or truncated"):
        read_log(path, plain)


_WRONG = [
    (named, holds)
    for named in _ENDINGS
    for holds in ("csv", "npz", "parquet", "mat")
    if not named.startswith(holds)
]


@pytest.mark.parametrize(("named", "holds"), _WRONG)
def test_wrong_format(named: str, holds: str, tmp_path: Path, table: Table, plain: Device) -> None:
    content = _write(tmp_path / f"right.{holds}", table).read_bytes()
    path = tmp_path / f"run.{named}"
    path.write_bytes(content)
    with pytest.raises(LogError, match=r"run\."):
        read_log(path, plain)


def test_gzip_by_name_only_does_no_harm(tmp_path: Path, table: Table, plain: Device) -> None:
    path = tmp_path / "run.csv.gz"
    path.write_bytes(_write(tmp_path / "run.csv", table).read_bytes())
    assert read_log(path, plain).samples == 300


def test_unknown_format(tmp_path: Path, plain: Device) -> None:
    (tmp_path / "run.bag").write_bytes(b"\x00\x01\x02" * 500)
    with pytest.raises(LogError, match=r"of no known format; allowed: \.csv"):
        read_log(tmp_path / "run.bag", plain)
    (tmp_path / "run.csv").write_bytes(b"\x01\x02\x00" * 500)
    with pytest.raises(LogError, match="binary data"):
        read_log(tmp_path / "run.csv", plain)
    (tmp_path / "run.csv").write_bytes("Zeit;Öl\n1;2\n".encode("latin-1"))
    with pytest.raises(LogError, match="not a text table in UTF-8"):
        read_log(tmp_path / "run.csv", plain)


def _rows(table: Table) -> list[str]:
    columns = [column.tolist() for column in table.values()]
    head = ",".join(table)
    return [head, *(",".join(map(repr, row)) for row in zip(*columns, strict=True))]


@pytest.mark.parametrize("line", [2, 57, 301])
def test_a_cell_that_is_no_number(line: int, tmp_path: Path, table: Table, plain: Device) -> None:
    rows = _rows(table)
    cells = rows[line - 1].split(",")
    rows[line - 1] = ",".join([*cells[:2], "12,3mm".replace(",", "."), cells[3]])
    path = tmp_path / "run.csv"
    path.write_text("\n".join(rows))
    with pytest.raises(LogError, match=rf"line {line}, column 'j\.theta'.*got '12\.3mm'"):
        read_log(path, plain)


def test_a_row_that_is_too_short(tmp_path: Path, table: Table, plain: Device) -> None:
    rows = _rows(table)
    rows[-1] = rows[-1].rpartition(",")[0]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(rows))
    with pytest.raises(LogError, match=r"line 301 has 3 cells where 4 are expected; truncated\?"):
        read_log(path, plain)


def test_two_columns_of_one_name(tmp_path: Path, table: Table, plain: Device) -> None:
    path = tmp_path / "run.csv"
    path.write_text("\n".join(_rows(table)).replace("j.theta", "j.q"))
    with pytest.raises(LogError, match=r"2 columns have the name of j\.q"):
        read_log(path, plain)


def test_empty_cells_are_missing_values(tmp_path: Path, table: Table, plain: Device) -> None:
    rows = _rows(table)
    for line in (11, 12, 40):
        cells = rows[line].split(",")
        rows[line] = ",".join([cells[0], "" if line < 40 else "NA", *cells[2:]])
    path = tmp_path / "run.csv"
    path.write_text("\n".join(rows))
    log = read_log(path, plain)
    assert np.flatnonzero(np.isnan(log.joints["j"]["q"])).tolist() == [10, 11, 39]
    assert log.warnings == (
        "q of joint j: 3 of 300 samples are not finite (in 2 runs, first at 0.01 s)",
    )
    assert np.array_equal(log.joints["j"]["theta"], table["j.theta"])


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_nan_and_inf_runs_are_kept_and_counted(
    ending: str, tmp_path: Path, table: Table, plain: Device
) -> None:
    table["j.tau"][50:60] = np.nan
    table["j.tau"][100:103] = [np.inf, -np.inf, np.inf]
    path = _write(tmp_path / f"run.{ending}", table)
    log = read_log(path, plain)
    assert np.flatnonzero(np.isnan(log.joints["j"]["tau"])).tolist() == [
        *range(50, 60),
        100,
        101,
        102,
    ]
    assert log.warnings == (
        "tau of joint j: 13 of 300 samples are not finite (in 2 runs, first at 0.05 s)",
    )


def test_a_channel_of_nothing(tmp_path: Path, table: Table, plain: Device) -> None:
    table["j.tau"][:] = np.nan
    with pytest.raises(LogError, match="tau of joint j never holds a finite number"):
        read_log(_write(tmp_path / "run.npz", table), plain)


def test_constant_channels(tmp_path: Path, table: Table, plain: Device) -> None:
    table["j.theta"][:] = 0.25
    log = read_log(_write(tmp_path / "run.npz", table), plain)
    assert log.warnings == ("theta of joint j is constant (0.25)",)


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_too_few_samples(ending: str, tmp_path: Path, table: Table, plain: Device) -> None:
    short = {name: column[:99] for name, column in table.items()}
    with pytest.raises(LogError, match="too short, got 99; allowed: 100 samples or more"):
        read_log(_write(tmp_path / f"run.{ending}", short), plain)
    enough = {name: column[:100] for name, column in table.items()}
    assert read_log(_write(tmp_path / f"run.{ending}", enough), plain).samples == 100


_BROKEN_CLOCKS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "backwards": lambda t: t[::-1].copy(),
    "stopped": lambda t: 0.0 * t,
    "missing": lambda t: np.nan * t,
}


@pytest.mark.parametrize("clock", ["backwards", "stopped", "missing"])
def test_a_clock_that_does_not_increase(
    clock: str, tmp_path: Path, table: Table, plain: Device
) -> None:
    table["time"] = _BROKEN_CLOCKS[clock](table["time"])
    with pytest.raises(LogError, match="the clock does not increase"):
        read_log(_write(tmp_path / "run.npz", table), plain)


def test_gaps_repeats_and_steps_back_are_reported(
    tmp_path: Path, table: Table, plain: Device
) -> None:
    time = table["time"]
    time[100:] += 0.05
    time[200:] += 0.002
    time[20] = time[19]
    time[30] = time[28]
    log = read_log(_write(tmp_path / "run.npz", table), plain)
    assert np.array_equal(log.time, time)  # kept as it is
    # Times after a step back or a repeat are two periods on: holes of one sample.
    assert [gap.missing for gap in log.clock.gaps] == [1, 2, 50, 2]
    assert log.clock.gaps[2].start == pytest.approx(0.099, rel=1e-12)
    assert log.clock.gaps[2].seconds == pytest.approx(0.051, rel=1e-9)
    assert (log.clock.repeated, log.clock.backwards) == (1, 1)
    assert len(log.warnings) == 3
    assert "4 gaps, 55 samples missing in all; the longest lasts 0.051 s" in log.warnings[0]


def test_samples_without_a_time(tmp_path: Path, table: Table, plain: Device) -> None:
    table["time"][5] = np.nan
    log = read_log(_write(tmp_path / "run.npz", table), plain)
    assert log.clock.invalid == 1
    assert "1 sample without a time" in log.warnings


def test_an_uneven_clock(tmp_path: Path, table: Table, plain: Device) -> None:
    table["time"] += 1e-4 * np.random.default_rng(0).standard_normal(300)
    log = read_log(_write(tmp_path / "run.npz", table), plain)
    # Steps are differences of two deviations of 10 % each; 300 of them tell it to 10 %.
    assert log.clock.jitter == pytest.approx(0.1 * np.sqrt(2.0), rel=0.15)
    assert any("the clock is uneven" in warning for warning in log.warnings)


@pytest.mark.parametrize(("period", "fits"), [(1.009e-3, True), (1.011e-3, False), (1.0, False)])
def test_the_devices_period(period: float, fits: bool, tmp_path: Path, table: Table) -> None:
    path = _write(tmp_path / "run.npz", table)
    device = device_from_tables({"name": "rig", "estimator": {"period": period}}, "rig.toml")
    if fits:
        assert read_log(path, device).period == pytest.approx(1e-3, rel=1e-12)
        return
    with pytest.raises(LogError, match=r"period is 0\.001 s, the device's estimator\.period"):
        read_log(path, device)


def test_gzip_of_something_else(tmp_path: Path, plain: Device) -> None:
    (tmp_path / "run.csv.gz").write_bytes(gzip.compress(b"\x00\x01" * 500))
    with pytest.raises(LogError, match="binary data"):
        read_log(tmp_path / "run.csv.gz", plain)
