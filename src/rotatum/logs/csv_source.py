"""Text tables: any delimiter, with or without header, plain or gzip, read block by block."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.dialect import MISSING, Dialect, find_dialect, split
from rotatum.logs.source import Block, Pick, column_positions, unreadable

__all__ = ["CsvSource"]

_LOOKED_AT = 50  # lines the layout is worked out from
_PARSED = 16384  # lines parsed at once: a bad cell costs a slow second look at these only


class CsvSource:
    """An opened text table.

    Parameters
    ----------
    path : the file; gzip is recognised by its first bytes.

    Raises
    ------
    LogError if the file is not text or holds no table.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        with self._open() as file:
            lines = self._take(file, _LOOKED_AT)
        if any("\0" in line for line in lines):
            raise LogError("is not a text table: it holds binary data", where=path)
        dialect = find_dialect(lines)
        if dialect is None:
            raise LogError("is empty", where=path)
        self._dialect: Dialect = dialect

    @property
    def format(self) -> str:
        """Name of the format."""
        return "CSV"

    @property
    def names(self) -> tuple[str, ...]:
        """Names in the header; the columns' numbers where there is none."""
        return self._dialect.names

    @property
    def samples(self) -> int | None:
        """Unknown before the file is read."""
        return None

    def blocks(self, picks: Sequence[Pick], rows: int) -> Iterator[Block]:
        """Yield blocks of rows; one number is parsed per picked cell, the others are skipped."""
        positions = column_positions(picks, self.names, self._path)
        number = self._dialect.skip
        with self._open() as file:
            self._take(file, self._dialect.skip)
            while True:
                tables: list[NDArray[np.float64]] = []
                for size in _portions(rows):
                    lines = self._take(file, size)
                    tables.append(self._parse(lines, number, positions))
                    number += len(lines)
                    if len(lines) < size:
                        break
                table = np.concatenate(tables)
                if not len(table):
                    return
                yield tuple(np.ascontiguousarray(column) for column in table.T)

    def _open(self) -> TextIO:
        """Open the file as text, through gzip if it is compressed."""
        try:
            with open(self._path, "rb") as raw:
                packed = raw.read(2) == b"\x1f\x8b"
            if packed:
                return gzip.open(self._path, "rt", encoding="utf-8-sig")
            return open(self._path, encoding="utf-8-sig")
        except OSError as error:
            raise unreadable(self._path, "CSV", error) from error

    def _take(self, file: TextIO, count: int) -> list[str]:
        """Read up to `count` lines."""
        try:
            return list(islice(file, count))
        except UnicodeDecodeError as error:
            raise LogError("is not a text table in UTF-8", where=self._path) from error
        except (EOFError, OSError, zlib.error) as error:
            raise unreadable(self._path, "CSV", error) from error

    def _parse(
        self, lines: list[str], number: int, positions: tuple[int, ...]
    ) -> NDArray[np.float64]:
        """Parse lines into (rows, picks), carefully if they are not plain numbers."""
        if self._dialect.decimal == ",":
            lines = [line.replace(",", ".") for line in lines]
        if not any(line.strip() for line in lines):
            return np.empty((0, len(positions)))
        try:
            return np.loadtxt(
                lines,
                delimiter=self._dialect.delimiter,
                usecols=positions,
                comments=None,
                quotechar='"',
                ndmin=2,
            )
        except ValueError:
            return self._parse_carefully(lines, number, positions)

    def _parse_carefully(
        self, lines: list[str], number: int, positions: tuple[int, ...]
    ) -> NDArray[np.float64]:
        """Parse cell by cell: empty cells are NaN, anything else that is no number an error."""
        rows: list[list[float]] = []
        for line_number, line in enumerate(lines, start=number + 1):
            if not line.strip():
                continue
            cells = split(line, self._dialect.delimiter)
            if len(cells) <= max(positions):
                what = (
                    f"line {line_number} has {len(cells)} cells where {len(self.names)} are "
                    "expected; truncated?"
                )
                raise LogError(what, where=self._path)
            rows.append([self._number(cells[place], line_number, place) for place in positions])
        return np.array(rows, dtype=np.float64).reshape(-1, len(positions))

    def _number(self, cell: str, line: int, place: int) -> float:
        """Turn a cell into a number."""
        if cell.lower() in MISSING:
            return float("nan")
        try:
            return float(cell)
        except ValueError:
            where = f"{self._path}, line {line}, column {self.names[place]!r}"
            raise LogError("a cell is not a number", where=where, value=cell) from None


def _portions(rows: int) -> Iterator[int]:
    """Split a number of rows into what is parsed at once."""
    for start in range(0, rows, _PARSED):
        yield min(_PARSED, rows - start)
