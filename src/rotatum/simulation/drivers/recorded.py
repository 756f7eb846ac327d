"""A drive that plays a column of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import LogError, RotatumError, nearest
from rotatum.logs.formats import open_source
from rotatum.logs.source import CLOCK, Pick

__all__ = ["Recorded", "recorded"]

Array = NDArray[np.float64]
BETWEEN = ("held", "linear")
AFTER = ("last", "zero")
_ROWS = 262144
# Of a step: 7 * 0.1 s is 0.7000000000000001, and a file may say 0.7, or the other way round.
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Recorded:
    """Values played back; the first row is at t = 0, whatever the file's clock says there.

    Before t = 0 it is the first value.

    Parameters
    ----------
    time
        (N,) s, growing.
    values
        (N,) N m at the joint, or whatever is driven.
    between
        Rows: "held" until the next, or "linear" to it.
    after
        The last row: its value stays ("last"), or nothing acts ("zero").
    """

    time: Array
    values: Array
    between: str = "held"
    after: str = "last"

    def __post_init__(self) -> None:
        """Raise `RotatumError` for columns that are no drive, and unknown words."""
        if self.time.ndim != 1 or self.time.shape != self.values.shape or self.time.size < 2:
            raise RotatumError(
                "time and values of a recorded drive must be as many, at least two",
                value=(self.time.shape, self.values.shape),
            )
        for name, column in (("time", self.time), ("values", self.values)):
            bad = np.flatnonzero(~np.isfinite(column))
            if bad.size:
                what = f"{bad.size} of {column.size} rows are not numbers, the first is row"
                raise RotatumError(what, where=f"file.{name}", value=int(bad[0]))
        back = np.flatnonzero(np.diff(self.time) <= 0.0)
        if back.size:
            raise RotatumError(
                "the clock must grow; it does not after row",
                where="file.time",
                value=int(back[0]),
            )
        _check_word("between", self.between, BETWEEN)
        _check_word("after", self.after, AFTER)

    def __call__(self, time: ArrayLike) -> Array:
        """Return the value (N,) at times (N,) [s]."""
        clock = self.time - self.time[0]
        t = np.asarray(time, dtype=np.float64)
        slack = _ROUNDING * float(np.min(np.diff(clock)))
        if self.between == "linear":
            value = np.interp(t, clock, self.values)
        else:
            row = np.searchsorted(clock, t + slack, side="right") - 1
            value = self.values[np.maximum(row, 0)]
        if self.after == "zero":
            value = np.where(t > clock[-1] + slack, 0.0, value)
        return np.asarray(value, dtype=np.float64)


def recorded(
    path: str | Path,
    column: str,
    *,
    time: str = CLOCK,
    between: str = "held",
    after: str = "last",
) -> Recorded:
    """Return the drive that a column of a file holds.

    Parameters
    ----------
    path
        CSV, NPZ, MAT, HDF5 or Parquet.
    column
        Name of the values, in the unit of what they drive (N m at the joint, rad).
    time
        Name of the clock [s].
    between, after
        As in `Recorded`.

    Raises `LogError` for a file that cannot be read, a column it does not have (with the nearest
    one) and values that are no drive, naming file and column; `ExtraError` if the format needs a
    package that is not installed.
    """
    source = open_source(path)
    picks = (Pick(CLOCK, time), Pick("the drive", column))
    blocks = list(source.blocks(picks, _ROWS))
    clock, values = (
        np.concatenate([block[k] for block in blocks]) if blocks else np.empty(0) for k in (0, 1)
    )
    try:
        return Recorded(clock, values, between, after)
    except RotatumError as error:
        where = f"{path}, columns {time} and {column}"
        raise LogError(
            error.what, where=where, value=error.value, allowed=error.allowed, hint=error.hint
        ) from error


def _check_word(name: str, word: str, allowed: tuple[str, ...]) -> None:
    if word not in allowed:
        close = nearest(word, allowed)
        hint = f"Did you mean {close!r}?" if close else None
        raise RotatumError(
            "unknown word", where=f"file.{name}", value=word, allowed=allowed, hint=hint
        )
