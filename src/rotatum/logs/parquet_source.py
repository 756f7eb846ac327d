"""Parquet logs, streamed by record batches with only the picked columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import ExtraError, LogError
from rotatum.logs.source import Block, Pick, column_positions, unreadable

__all__ = ["ParquetSource"]


class ParquetSource:
    """An opened Parquet file.

    Parameters
    ----------
    path : the file.

    Raises
    ------
    ExtraError if pyarrow is not installed; LogError if the file is damaged or truncated.
    """

    def __init__(self, path: str) -> None:
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise ExtraError("reading Parquet needs pyarrow", extra="parquet", where=path) from None
        self._path = path
        self._damage = (pyarrow.ArrowException, OSError)
        try:
            with pyarrow.parquet.ParquetFile(path) as file:
                self._names = tuple(file.schema_arrow.names)
                self._samples = int(file.metadata.num_rows)
        except self._damage as error:
            raise unreadable(path, "Parquet", error) from error

    @property
    def format(self) -> str:
        """Name of the format."""
        return "Parquet"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self._names

    @property
    def samples(self) -> int | None:
        """Number of rows."""
        return self._samples

    def blocks(self, picks: Sequence[Pick], rows: int) -> Iterator[Block]:
        """Yield record batches; they may be smaller than asked for at the end of a row group."""
        import pyarrow.parquet

        positions = column_positions(picks, self._names, self._path)
        names = [self._names[place] for place in positions]
        try:
            with pyarrow.parquet.ParquetFile(self._path) as file:
                for batch in file.iter_batches(batch_size=rows, columns=list(dict.fromkeys(names))):
                    yield tuple(self._numbers(batch.column(name), name) for name in names)
        except self._damage as error:
            raise unreadable(self._path, "Parquet", error) from error

    def _numbers(self, column: Any, name: str) -> NDArray[np.float64]:
        """Turn an Arrow column into numbers, nulls into NaN."""
        values: NDArray[np.generic] = column.to_numpy(zero_copy_only=False)
        if values.dtype.kind not in "fiub":
            what = f'column "{name}" does not hold numbers but {column.type}'
            raise LogError(what, where=self._path)
        return values.astype(np.float64, copy=False)
