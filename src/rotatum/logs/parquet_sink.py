"""Writing Parquet."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import ExtraError

__all__ = ["ParquetSink"]


class ParquetSink:
    """An open Parquet file; every chunk becomes a row group.

    Parameters
    ----------
    path : the file.
    shown : its name in messages.

    Raises
    ------
    ExtraError if pyarrow is not installed.
    """

    def __init__(self, path: Path, shown: str) -> None:
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            what = "writing Parquet needs pyarrow"
            raise ExtraError(what, extra="parquet", where=shown) from None
        self._arrow: Any = pyarrow
        self._file = path.open("wb")
        self._writer: Any = None

    def write(self, columns: Mapping[str, NDArray[np.generic]]) -> None:
        """Append rows."""
        arrays = {name: self._arrow.array(column) for name, column in columns.items()}
        table = self._arrow.table(arrays)
        if self._writer is None:
            self._writer = self._arrow.parquet.ParquetWriter(self._file, table.schema)
        self._writer.write_table(table)

    def close(self) -> None:
        """Complete the file."""
        if self._writer is not None:
            self._writer.close()
        self._file.close()

    def abandon(self) -> None:
        """Let go of the file."""
        with suppress(OSError):
            if self._writer is not None:
                self._writer.close()
        with suppress(OSError):
            self._file.close()
