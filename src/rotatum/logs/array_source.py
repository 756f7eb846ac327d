"""Logs that are a set of arrays: NPZ, MAT and HDF5."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.source import CLOCK, Block, Pick, no_such_column

__all__ = ["ArraySource"]


class ArraySource:
    """Arrays by name; what is picked is held in memory, the rest is not read.

    Parameters
    ----------
    path : the file, for messages.
    format : name of the format.
    names : names of the arrays.
    load : returns the array of a name.
    """

    def __init__(
        self,
        path: str,
        format: str,
        names: tuple[str, ...],
        load: Callable[[str], NDArray[np.generic]],
    ) -> None:
        self._path = path
        self._format = format
        self._names = names
        self._load = load
        self._samples: int | None = None

    @property
    def format(self) -> str:
        """Name of the format."""
        return self._format

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arrays; nested ones as dotted paths."""
        return self._names

    @property
    def samples(self) -> int | None:
        """Number of samples, known once something has been picked."""
        return self._samples

    def blocks(self, picks: Sequence[Pick], rows: int) -> Iterator[Block]:
        """Yield slices of the picked arrays."""
        columns = self._columns(picks)
        self._samples = columns[0].size
        for start in range(0, self._samples, rows):
            yield tuple(column[start : start + rows] for column in columns)

    def _columns(self, picks: Sequence[Pick]) -> list[NDArray[np.float64]]:
        """Load every pick as a column of the same length."""
        arrays = [self._numbers(pick) for pick in picks]
        first = arrays[0] if picks[0].label == CLOCK else max(arrays, key=lambda a: max(a.shape))
        samples = max(first.shape)
        columns = [
            self._column(pick, array, samples) for pick, array in zip(picks, arrays, strict=True)
        ]
        for pick, column in zip(picks, columns, strict=True):
            if column.size != samples:
                reference = picks[0].label if picks[0].label == CLOCK else "the longest channel"
                what = f"{pick.label} has {column.size} samples but {reference} has {samples}"
                raise LogError(what, where=self._path)
        return columns

    def _numbers(self, pick: Pick) -> NDArray[np.float64]:
        """Load an array and make sure that it holds real numbers, at least one."""
        if pick.name is None or pick.name not in self._names:
            raise no_such_column(pick, self._names, self._path)
        array = np.squeeze(self._load(pick.name))
        if array.dtype.kind not in "fiub":
            what = f'"{pick.name}" ({pick.label}) does not hold numbers but {array.dtype}'
            raise LogError(what, where=self._path)
        if array.size == 0:
            raise LogError(f'"{pick.name}" ({pick.label}) is empty', where=self._path)
        return np.atleast_1d(array).astype(np.float64, copy=False)

    def _column(self, pick: Pick, array: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
        """Take the row or column of an array that the index says."""
        if array.ndim == 1:
            if pick.index in (None, 0):
                return array
            what = f'"{pick.name}" ({pick.label}) has one dimension; its only index is 0'
            raise LogError(what, where=self._path, value=pick.index)
        shape = " x ".join(str(length) for length in array.shape)
        if array.ndim > 2 or pick.index is None:
            what = f'"{pick.name}" ({pick.label}) is {shape}'
            hint = "Give the index of a row or column." if array.ndim == 2 else None
            raise LogError(what, where=self._path, allowed="1-D or 2-D with an index", hint=hint)
        if samples not in array.shape:
            what = f'"{pick.name}" ({pick.label}) is {shape}; neither side has {samples} samples'
            raise LogError(what, where=self._path)
        by_sample = array if array.shape[0] == samples else array.T
        if pick.index >= by_sample.shape[1]:
            what = f'"{pick.name}" ({pick.label}) is {shape}; no such index'
            allowed = f"0 to {by_sample.shape[1] - 1}"
            raise LogError(what, where=self._path, value=pick.index, allowed=allowed)
        return np.ascontiguousarray(by_sample[:, pick.index])
