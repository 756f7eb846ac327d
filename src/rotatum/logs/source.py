"""What every file format offers the reader: names, and blocks of numbers by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError, nearest

__all__ = ["CLOCK", "Block", "Pick", "Source", "column_positions", "no_such_column", "unreadable"]

CLOCK = "time"  # label of the pick that is the sample clock
Block = tuple[NDArray[np.float64], ...]


@dataclass(frozen=True)
class Pick:
    """A column to read.

    Parameters
    ----------
    label : what it is to the log, "time" or "<joint>.<role>"; for messages.
    name : column, variable or dotted path in the file; None: the index alone says which.
    index : zero-based row or column of a 2-D array; without a name the number of a column.
    """

    label: str
    name: str | None
    index: int | None = None


class Source(Protocol):
    """An opened log file."""

    @property
    def format(self) -> str:
        """Name of the format, for people."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of everything that can be picked."""

    @property
    def samples(self) -> int | None:
        """Number of rows, where the file says so before it is read."""

    def blocks(self, picks: Sequence[Pick], rows: int) -> Iterator[Block]:
        """Yield blocks of at most `rows` rows, one array per pick; start anew at each call."""


def column_positions(picks: Sequence[Pick], names: Sequence[str], path: str) -> tuple[int, ...]:
    """Return the column number of each pick in a table whose columns have names.

    Raises
    ------
    LogError if there is no such column, or an index is given beside a name.
    """
    positions: list[int] = []
    for pick in picks:
        if pick.name is None:
            if pick.index is None or pick.index >= len(names):
                what = f"the log has {len(names)} columns; no column for {pick.label}"
                raise LogError(what, where=path, value=pick.index)
            positions.append(pick.index)
            continue
        if pick.index is not None:
            what = f'index is for 2-D arrays; column "{pick.name}" ({pick.label}) has one dimension'
            raise LogError(what, where=path, value=pick.index)
        found = [place for place, name in enumerate(names) if name == pick.name]
        if not found:
            raise no_such_column(pick, names, path)
        if len(found) > 1:
            what = f"{len(found)} columns have the name of {pick.label}"
            raise LogError(what, where=path, value=pick.name)
        positions.append(found[0])
    return tuple(positions)


def no_such_column(pick: Pick, names: Sequence[str], path: str) -> LogError:
    """Return the error of a column that does not exist, with the nearest one that does."""
    wanted = pick.name or pick.label
    close = nearest(wanted, names)
    hint = f'Did you mean "{close}"?' if close else None
    what = f"no column or variable for {pick.label}"
    return LogError(what, where=path, value=wanted, allowed=tuple(names), hint=hint)


def unreadable(path: str, kind: str, error: Exception) -> LogError:
    """Return the error of a file that is damaged, truncated or of another format."""
    reason = str(error).strip().rstrip(".") or type(error).__name__
    return LogError(f"cannot be read as {kind}; damaged or truncated? ({reason})", where=path)
