"""Writing tables: CSV, NPZ and Parquet, at once or chunk by chunk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import OutputError
from rotatum.logs.beside import beside
from rotatum.logs.csv_sink import CsvSink
from rotatum.logs.npz_sink import NpzSink
from rotatum.logs.parquet_sink import ParquetSink

__all__ = ["TableWriter", "write_table"]

Columns = Mapping[str, NDArray[np.generic]]
_ENDINGS = (".csv", ".csv.gz", ".tsv", ".npz", ".parquet")


class _Sink(Protocol):
    """What writes one format."""

    def write(self, columns: Columns) -> None:
        """Append rows."""

    def close(self) -> None:
        """Complete the file."""

    def abandon(self) -> None:
        """Let go of the file without completing it."""


def write_table(path: str | Path, columns: Columns) -> None:
    """Write a table.

    CSV keeps 12 significant digits (the column `time` all of them); NPZ and Parquet keep all.

    Parameters
    ----------
    path : ends in .csv, .csv.gz, .tsv, .npz or .parquet.
    columns : name -> (N,) numbers or texts, all of the same length.

    Raises
    ------
    OutputError if the ending is none of these or the file cannot be written; ExtraError if
    Parquet needs a package that is not installed.
    """
    with TableWriter(path) as table:
        table.write(columns)


class TableWriter:
    """Writes a table chunk by chunk; the file appears when the `with` block ends well.

    CSV and Parquet are written as the chunks come, NPZ at the end.

    Parameters
    ----------
    path : as in `write_table`.

    Raises
    ------
    OutputError and ExtraError as in `write_table`.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = str(path)
        name = Path(path).name.lower()
        ending = next((e for e in _ENDINGS if name.endswith(e)), None)
        if ending is None:
            what = "the ending of the name says no format that can be written"
            raise OutputError(what, where=self._path, allowed=_ENDINGS)
        self._ending = ending
        self._stack = ExitStack()
        self._sink: _Sink | None = None
        self._names: tuple[str, ...] | None = None

    def __enter__(self) -> Self:
        """Open the file beside its place."""
        with ExitStack() as stack:
            new = stack.enter_context(beside(self._path))
            self._sink = _open_sink(self._ending, new, self._path)
            self._stack = stack.pop_all()
        return self

    def write(self, columns: Columns) -> None:
        """Append rows.

        Parameters
        ----------
        columns : name -> (N,); the names and their order are those of the first call.

        Raises
        ------
        OutputError if the columns differ from the first call's or from each other in length.
        """
        if self._sink is None:
            raise OutputError("the table is not open; use it in a with block", where=self._path)
        names = tuple(columns)
        if self._names is None:
            self._names = names
        if names != self._names:
            what = "the columns are not those of the first chunk"
            raise OutputError(what, where=self._path, value=names, allowed=self._names)
        _check_lengths(columns, self._path)
        self._sink.write(columns)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Complete the file, or remove what there is of it after an error."""
        sink, self._sink = self._sink, None
        if sink is not None and error is not None:
            sink.abandon()
        elif sink is not None:
            with self._stack:
                _complete(sink)
        # After an error `beside` has to see it, to remove the file and to name the reason.
        self._stack.__exit__(kind, error, trace)


def _complete(sink: _Sink) -> None:
    """Close a file; one that cannot be completed is let go of."""
    try:
        sink.close()
    except BaseException:
        sink.abandon()
        raise


def _open_sink(ending: str, new: Path, shown: str) -> _Sink:
    """Open a file for writing in a format."""
    if ending == ".npz":
        return NpzSink(new)
    if ending == ".parquet":
        return ParquetSink(new, shown)
    return CsvSink(new, "\t" if ending == ".tsv" else ",", packed=ending == ".csv.gz")


def _check_lengths(columns: Columns, path: str) -> None:
    """Refuse columns of different lengths or none at all."""
    lengths: Sequence[tuple[int, ...]] = sorted({np.shape(c) for c in columns.values()})
    if len(lengths) != 1 or len(lengths[0]) != 1:
        what = "a table needs columns of one dimension and the same length"
        raise OutputError(what, where=path, value=lengths)
