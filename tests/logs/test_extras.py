"""A format whose package is not installed: the error says what to install."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from numpy.typing import NDArray

from rotatum.errors import ExtraError
from rotatum.logs import read_log, write_table
from rotatum.models import Device

Table = dict[str, NDArray[Any]]


def test_parquet(
    tmp_path: Path, table: Table, plain: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_table(tmp_path / "run.parquet", table)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ExtraError, match=r"rotatum\[parquet\]"):
        read_log(tmp_path / "run.parquet", plain)
    with pytest.raises(ExtraError, match=r"rotatum\[parquet\]"):
        write_table(tmp_path / "out.parquet", table)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.parquet"]


def test_hdf5(tmp_path: Path, plain: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "run.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ExtraError, match=r"rotatum\[hdf5\]"):
        read_log(tmp_path / "run.h5", plain)
