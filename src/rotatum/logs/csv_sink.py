"""Writing text tables."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

__all__ = ["CsvSink"]

_ROWS = 8192  # formatted at once
# The shortest text that gives back the same double costs three times as much as 12 digits, and no
# sensor has more. A clock that counts from 1970 does.
_EXACT = "time"


class CsvSink:
    """An open text table.

    Parameters
    ----------
    path : the file.
    delimiter : between cells.
    packed : compress with gzip.
    """

    def __init__(self, path: Path, delimiter: str, *, packed: bool) -> None:
        self._delimiter = delimiter
        self._format = ""
        self._file = _open(path, packed=packed)

    def write(self, columns: Mapping[str, NDArray[np.generic]]) -> None:
        """Append rows; the first call writes the header and settles the format of the cells."""
        if not self._format:
            cells = [_cell_format(name, column) for name, column in columns.items()]
            self._format = self._delimiter.join(cells) + "\n"
            self._file.write(self._delimiter.join(self._quoted(name) for name in columns) + "\n")
        arrays = list(columns.values())
        for start in range(0, len(arrays[0]), _ROWS):
            self._write_rows([array[start : start + _ROWS] for array in arrays])

    def close(self) -> None:
        """Complete the file."""
        self._file.close()

    def abandon(self) -> None:
        """Let go of the file."""
        with suppress(OSError):
            self._file.close()

    def _write_rows(self, arrays: list[NDArray[np.generic]]) -> None:
        """Format rows with one operation: a call per cell would take most of the time."""
        rows, width = len(arrays[0]), len(arrays)
        cells: list[object] = [None] * (rows * width)
        for place, array in enumerate(arrays):
            values = array.tolist()
            is_text = array.dtype.kind in "OSU"
            cells[place::width] = [self._quoted(str(v)) for v in values] if is_text else values
        self._file.write((self._format * rows) % tuple(cells))

    def _quoted(self, text: str) -> str:
        """Quote a text that holds the delimiter, a quote or a line's end."""
        if not any(sign in text for sign in (self._delimiter, '"', "\n", "\r")):
            return text
        return '"' + text.replace('"', '""') + '"'


def _open(path: Path, *, packed: bool) -> TextIO:
    """Open a file for text, through gzip if it is to be compressed."""
    if packed:
        return gzip.open(path, "wt", encoding="utf-8", newline="", compresslevel=2)
    return path.open("w", encoding="utf-8", newline="")


def _cell_format(name: str, column: NDArray[np.generic]) -> str:
    """Return how a column's cells are printed."""
    kind = np.asarray(column).dtype.kind
    if kind == "f":
        return "%r" if name == _EXACT else "%.12g"
    return "%d" if kind in "iub" else "%s"
