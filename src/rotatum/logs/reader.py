"""A log as a sequence of pieces, in constant memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.clock import Clock, ClockWatch, median_period
from rotatum.logs.log import Log
from rotatum.logs.mapping import Column, Mapped
from rotatum.logs.source import Block, Source
from rotatum.logs.watch import ChannelWatch

__all__ = ["LogReader"]

_FEWEST = 100  # samples; fewer cannot tell a stiffness from noise
_DISAGREEMENT = 0.01  # of the device's period


class LogReader:
    """A log as a sequence of pieces; can be iterated as often as needed.

    `clock` and the warnings speak of the first piece until the log has been read to its end once,
    then of the whole log. The period is that of the first piece.

    Parameters
    ----------
    path : the file, for messages.
    source : the opened file.
    mapped : the channels to read.
    period : the device's period [s], if it declares one.
    chunk : samples per piece.
    """

    def __init__(
        self, path: str, source: Source, mapped: Mapped, period: float | None, chunk: int
    ) -> None:
        self._path = path
        self._source = source
        self._mapped = mapped
        self._chunk = chunk
        clock = [mapped.clock.pick] if mapped.clock else []
        self._columns = (*mapped.columns, *mapped.inertial)
        self._picks = (*clock, *(column.pick for column in self._columns))
        first, whole = self._peek()
        # A log that fits into one piece is not read from the disk again.
        self._kept = first if whole else None
        if whole and first[0].size < _FEWEST:
            what = "the log is too short"
            raise LogError(what, where=path, value=first[0].size, allowed="100 samples or more")
        self._samples = first[0].size if whole else source.samples
        self._period = period or nan
        time = self._time(first, 0)
        self._period = self._checked_period(time, period)
        watch = ClockWatch(self._period)
        watch.add(time)
        self._clock = watch.clock()
        self._warnings = tuple(self._clock_sentences(self._clock))
        self._inertial_warnings: tuple[str, ...] = ()

    @property
    def source(self) -> str:
        """The file."""
        return self._path

    @property
    def format(self) -> str:
        """Name of the file's format."""
        return self._source.format

    @property
    def samples(self) -> int | None:
        """Number of samples; None while it is not known (a long CSV that was not read yet)."""
        return self._samples

    @property
    def clock(self) -> Clock:
        """Period, jitter and gaps."""
        return self._clock

    @property
    def period(self) -> float:
        """Sample period [s]."""
        return self._period

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is odd about the log, its inertial sensors aside."""
        return self._warnings

    @property
    def inertial_warnings(self) -> tuple[str, ...]:
        """What is odd about the readings of the inertial sensors."""
        return self._inertial_warnings

    @property
    def roles(self) -> Mapping[str, tuple[str, ...]]:
        """Joint -> roles the log has for it."""
        return _roles(self._mapped.columns)

    @property
    def inertial_roles(self) -> Mapping[str, tuple[str, ...]]:
        """Accelerometer or gyroscope -> axes the log has of it; those without one are left out."""
        return _roles(self._mapped.inertial)

    @property
    def holds(self) -> Mapping[str, Mapping[str, str]]:
        """Joint -> role -> "sampled" or "held"."""
        return {
            joint: {c.role: c.hold for c in self._mapped.columns if c.owner == joint}
            for joint in self.roles
        }

    def __iter__(self) -> Iterator[Log]:
        """Yield the log's pieces; at the end bring `clock`, `samples` and `warnings` up to date."""
        clock = ClockWatch(self._period)
        watches = [
            *(ChannelWatch(f"joint {c.owner}", c.role) for c in self._mapped.columns),
            *(ChannelWatch(f"sensor {c.owner}", c.role) for c in self._mapped.inertial),
        ]
        holds = self.holds
        rows = 0
        for block in self._blocks():
            time = self._time(block, rows)
            rows += time.size
            clock.add(time)
            yield self._piece(block, time, watches, holds)
        self._finish(clock, watches, rows)

    def _peek(self) -> tuple[Block, bool]:
        """Read the first block, and find out whether it is the whole log."""
        blocks = self._source.blocks(self._picks, self._chunk)
        first = next(blocks, None)
        if first is None or not first[0].size:
            raise LogError("the log holds no samples", where=self._path)
        whole = next(blocks, None) is None
        return first, whole

    def _blocks(self) -> Iterator[Block]:
        """Yield the file's blocks, from memory if they are there."""
        if self._kept is not None:
            yield self._kept
        else:
            yield from self._source.blocks(self._picks, self._chunk)

    def _time(self, block: Block, start: int) -> NDArray[np.float64]:
        """Return the clock of a block [s]; made from the device's period if the file has none."""
        if self._mapped.clock is not None:
            return self._mapped.clock.convert(block[0])
        return np.arange(start, start + block[0].size, dtype=np.float64) * self._period

    def _checked_period(self, time: NDArray[np.float64], declared: float | None) -> float:
        """Return the clock's period, refusing one that is none or not the device's."""
        period = median_period(time[np.isfinite(time)])
        if period is None:
            raise LogError("the clock does not increase", where=self._path, value=_start(time))
        if declared is not None and abs(period - declared) > _DISAGREEMENT * declared:
            what = f"the log's period is {period:.6g} s, the device's estimator.period {declared:g}"
            hint = "Check the unit of channels.time, or whether it is this device's log."
            raise LogError(f"{what} s", where=self._path, hint=hint)
        return period

    def _piece(
        self,
        block: Block,
        time: NDArray[np.float64],
        watches: list[ChannelWatch],
        holds: Mapping[str, Mapping[str, str]],
    ) -> Log:
        """Convert a block to SI values at the joints and in the sensors' axes."""
        numbers = block[1:] if self._mapped.clock is not None else block
        values = [
            watch.clean(column.convert(raw), time)
            for column, watch, raw in zip(self._columns, watches, numbers, strict=True)
        ]
        joints = len(self._mapped.columns)
        return Log(
            source=self._path,
            time=time,
            joints=_by_owner(self._mapped.columns, values[:joints]),
            holds=holds,
            clock=self._clock,
            inertial=_by_owner(self._mapped.inertial, values[joints:]),
        )

    def _finish(self, clock: ClockWatch, watches: list[ChannelWatch], rows: int) -> None:
        """Note what is known only after the last piece."""
        if rows < _FEWEST:
            what = "the log is too short"
            raise LogError(what, where=self._path, value=rows, allowed="100 samples or more")
        joints = len(self._mapped.columns)
        for watch in watches[:joints]:
            watch.refuse_empty(self._path)
        self._samples = rows
        self._clock = clock.clock()
        said = self._clock_sentences(self._clock)
        for watch in watches[:joints]:
            said.extend(watch.warnings())
        self._warnings = tuple(said)
        # Stiffness is estimated without them: even a dead sensor is for its readers to judge.
        self._inertial_warnings = tuple(s for watch in watches[joints:] for s in watch.warnings())

    def _clock_sentences(self, clock: Clock) -> list[str]:
        """Say what is odd about the clock, or that there is none."""
        if self._mapped.clock is None:
            return [f"the log has no clock; the device's period of {self._period:g} s is used"]
        return clock.describe()


def _roles(columns: Sequence[Column]) -> dict[str, tuple[str, ...]]:
    """Return owner -> roles."""
    owners = dict.fromkeys(column.owner for column in columns)
    return {owner: tuple(c.role for c in columns if c.owner == owner) for owner in owners}


def _by_owner(
    columns: Sequence[Column], values: Sequence[NDArray[np.float64]]
) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return owner -> role -> values."""
    found: dict[str, dict[str, NDArray[np.float64]]] = {}
    for column, own in zip(columns, values, strict=True):
        found.setdefault(column.owner, {})[column.role] = own
    return found


def _start(time: NDArray[np.float64]) -> str:
    """Write the first few times."""
    return ", ".join(f"{value:g}" for value in time[:5]) + ", ..."
