"""Reading piece by piece gives what reading whole gives, in constant memory."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs import TableWriter, open_log, read_log, write_table
from rotatum.models import Device, device_from_tables

Table = dict[str, NDArray[Any]]


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(chunk=st.integers(1, 400))
def test_pieces_make_the_whole(
    ending: str, chunk: int, tmp_path: Path, table: Table, plain: Device
) -> None:
    path = tmp_path / f"run.{ending}"
    bad = {**table, "j.tau": np.where(np.arange(300) % 40 < 3, np.nan, table["j.tau"])}
    bad["time"] = table["time"] + 0.01 * (np.arange(300) > 150)
    write_table(path, bad)
    whole = read_log(path, plain)
    if chunk < 3:
        chunk = 3  # one or two samples have no period
    reader = open_log(path, plain, chunk=chunk)
    for _ in range(2):  # a reader can be read again
        pieces = list(reader)
        assert max(piece.samples for piece in pieces) <= chunk
        assert np.array_equal(np.concatenate([p.time for p in pieces]), whole.time)
        tau = np.concatenate([p.joints["j"]["tau"] for p in pieces])
        assert np.array_equal(tau, whole.joints["j"]["tau"], equal_nan=True)
        assert reader.samples == 300
        assert reader.warnings == whole.warnings
        assert reader.clock.gaps == pytest.approx(whole.clock.gaps)


def test_a_reader_says_what_it_has_before_it_is_read(
    tmp_path: Path, table: Table, plain: Device
) -> None:
    write_table(tmp_path / "run.parquet", table)
    reader = open_log(tmp_path / "run.parquet", plain, chunk=50)
    assert reader.roles == {"j": ("q", "theta", "tau")}
    assert reader.samples == 300
    assert reader.format == "Parquet"
    assert reader.period == pytest.approx(1e-3, rel=1e-12)
    write_table(tmp_path / "run.csv", table)
    assert open_log(tmp_path / "run.csv", plain, chunk=50).samples is None


def test_too_few_samples_are_found_at_the_end(tmp_path: Path, table: Table, plain: Device) -> None:
    write_table(tmp_path / "run.csv", {name: column[:99] for name, column in table.items()})
    with pytest.raises(LogError, match="too short, got 99"):
        list(open_log(tmp_path / "run.csv", plain, chunk=50))


def test_a_made_up_clock_runs_on_across_pieces(tmp_path: Path, table: Table) -> None:
    del table["time"]
    write_table(tmp_path / "run.csv", table)
    device = device_from_tables({"name": "rig", "estimator": {"period": 0.5}}, "rig.toml")
    pieces = list(open_log(tmp_path / "run.csv", device, chunk=64))
    assert np.array_equal(np.concatenate([p.time for p in pieces]), 0.5 * np.arange(300))


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_memory_does_not_grow_with_the_log(ending: str, tmp_path: Path, plain: Device) -> None:
    def peak(rows: int) -> int:
        path = tmp_path / f"{rows}.{ending}"
        with TableWriter(path) as writer:
            for start in range(0, rows, 2000):
                time = 1e-3 * np.arange(start, start + 2000)
                writer.write({"time": time, "j.q": np.sin(time), "j.theta": np.cos(time)})
        tracemalloc.start()
        for piece in open_log(path, plain, chunk=2000):
            assert piece.samples <= 2000
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return largest

    peak(4000)  # what is imported on the way is not the log's
    # Ten times the rows; the margin is for what the allocator and the imports do beside.
    assert peak(60000) < 1.5 * peak(6000) + 100_000
