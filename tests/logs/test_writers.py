"""Writing: the whole file or none, whatever goes wrong."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotatum.errors import OutputError
from rotatum.logs import TableWriter, beside, write_table

Table = dict[str, NDArray[Any]]
_ENDINGS = ["csv", "csv.gz", "tsv", "npz", "parquet"]


class _Disk:
    """A disk that is full after some bytes."""

    def __init__(self, real: Any, room: int) -> None:
        self._real = real
        self._room = room

    def write(self, data: Any) -> int:
        self._room -= len(data)
        if self._room < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return int(self._real.write(data))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *error: object) -> None:
        self._real.close()


def _write_chunks(path: Path, chunks: list[Table], *, then: Exception | None = None) -> None:
    with TableWriter(path) as writer:
        for chunk in chunks:
            writer.write(chunk)
        if then is not None:
            raise then


@pytest.mark.parametrize("ending", _ENDINGS)
def test_a_full_disk_leaves_no_partial_file(
    ending: str, tmp_path: Path, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"out.{ending}"
    target = {
        "csv": "rotatum.logs.csv_sink.CsvSink.write",
        "csv.gz": "rotatum.logs.csv_sink.CsvSink.write",
        "tsv": "rotatum.logs.csv_sink.CsvSink.close",
        "npz": "rotatum.logs.npz_sink.NpzSink.close",
        "parquet": "rotatum.logs.parquet_sink.ParquetSink.close",
    }[ending]

    def full(*args: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(target, full)
    with pytest.raises(OutputError, match="No space left on device"):
        write_table(path, table)
    monkeypatch.undo()
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_fills_up_on_the_way(
    tmp_path: Path, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = Path.open

    def limited(path: Path, *args: Any, **kwargs: Any) -> Any:
        return _Disk(opened(path, *args, **kwargs), room=20_000)

    monkeypatch.setattr(Path, "open", limited)
    path = tmp_path / "out.csv"
    with pytest.raises(OutputError, match="No space left"):
        _write_chunks(path, [table] * 50)
    monkeypatch.undo()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_dev_full(tmp_path: Path, table: Table) -> None:
    link = tmp_path / "out.csv"
    link.symlink_to("/dev/full")
    with pytest.raises(OutputError, match="No space left on device"):
        write_table(link, table)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.csv"]
    assert Path("/dev/full").is_char_device()


def test_an_error_keeps_the_old_file(tmp_path: Path, table: Table) -> None:
    path = tmp_path / "out.csv"
    path.write_text("old")
    with pytest.raises(RuntimeError, match="in between"):
        _write_chunks(path, [table], then=RuntimeError("in between"))
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("ending", _ENDINGS)
def test_a_missing_folder(ending: str, tmp_path: Path, table: Table) -> None:
    with pytest.raises(OutputError, match="the folder 'nowhere' does not exist"):
        write_table(tmp_path / "nowhere" / f"out.{ending}", table)


def test_a_folder_that_cannot_be_written(
    tmp_path: Path, table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    def deny(*args: object, **kwargs: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "open", deny)  # root may write anywhere, so it has to be made up
    with pytest.raises(OutputError, match=r"cannot be written \(Permission denied\)"):
        write_table(tmp_path / "out.csv", table)


def test_a_folder_instead_of_a_file(tmp_path: Path, table: Table) -> None:
    (tmp_path / "out.csv").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        write_table(tmp_path / "out.csv", table)


def test_an_unknown_ending(tmp_path: Path, table: Table) -> None:
    with pytest.raises(OutputError, match=r"allowed: \.csv, \.csv\.gz, \.tsv, \.npz, \.parquet"):
        write_table(tmp_path / "out.xlsx", table)


def test_columns_must_stay_the_same(tmp_path: Path, table: Table) -> None:
    with pytest.raises(OutputError, match="not those of the first chunk"):
        _write_chunks(tmp_path / "out.csv", [table, {"time": table["time"]}])
    with pytest.raises(OutputError, match="the same length"):
        write_table(tmp_path / "out.csv", {**table, "j.q": table["j.q"][1:]})
    assert list(tmp_path.iterdir()) == []


def test_texts_and_integers_in_csv(tmp_path: Path) -> None:
    columns: Table = {
        "time": np.array([1530821160.115114, 0.1]),
        "verdict": np.array(["a,b", 'say "x"']),
        "status": np.array([3, -1], dtype=np.int32),
        "x": np.array([np.nan, 1.0 / 3.0]),
    }
    write_table(tmp_path / "out.csv", columns)
    assert (tmp_path / "out.csv").read_text() == (
        'time,verdict,status,x\n1530821160.115114,"a,b",3,nan\n0.1,"say ""x""",-1,0.333333333333\n'
    )


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_chunks_make_one_table(ending: str, tmp_path: Path, table: Table) -> None:
    with TableWriter(tmp_path / f"chunks.{ending}") as writer:
        for start in range(0, 300, 70):
            writer.write({name: column[start : start + 70] for name, column in table.items()})
    write_table(tmp_path / f"whole.{ending}", table)
    if ending == "csv":
        contents = [(tmp_path / f"{n}.csv").read_text() for n in ("chunks", "whole")]
        assert contents[0] == contents[1]
    elif ending == "npz":
        with np.load(tmp_path / "chunks.npz") as archive:
            assert all(np.array_equal(archive[name], table[name]) for name in table)
    else:
        import pyarrow.parquet

        read = pyarrow.parquet.read_table(tmp_path / "chunks.parquet")
        assert read.equals(pyarrow.parquet.read_table(tmp_path / "whole.parquet"))


def test_beside_follows_a_link(tmp_path: Path) -> None:
    real = tmp_path / "real.txt"
    real.write_text("old")
    link = tmp_path / "link.txt"
    link.symlink_to(real)
    with beside(link) as new:
        new.write_text("new")
        assert real.read_text() == "old"
    assert link.is_symlink()
    assert real.read_text() == "new"
