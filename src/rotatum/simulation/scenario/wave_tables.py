"""Drives that stand for themselves, as a scenario writes them: waves, sequences, files."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Literal

from pydantic import Field

from rotatum.models.table import Real
from rotatum.simulation.drivers.binary import Prbs
from rotatum.simulation.drivers.paths import Ramps, hold
from rotatum.simulation.drivers.recorded import recorded
from rotatum.simulation.drivers.waves import (
    Chirp,
    Drive,
    Sawtooth,
    Sines,
    Square,
    multisine,
    sine,
)
from rotatum.simulation.scenario.part import Part

__all__ = [
    "ChirpTable",
    "DriveTable",
    "FileTable",
    "HoldTable",
    "MultisineTable",
    "PrbsTable",
    "RampsTable",
    "SawtoothTable",
    "SineTable",
    "SinesTable",
    "SquareTable",
]

Whole = Annotated[int, Field(strict=True, ge=0)]
Reals = tuple[Real, ...]


class DriveTable(Part):
    """A table that says what drives."""

    @abstractmethod
    def drive(self, seed: int) -> Drive:
        """Make the drive; `seed` is that of random ones that give none themselves.

        Raises `RotatumError` for numbers no drive can have.
        """


class SineTable(DriveTable):
    """One sine: ``offset + amplitude sin(2 pi frequency t + phase)``."""

    kind: Literal["sine"]
    amplitude: Real
    frequency: Real
    phase: Real = 0.0
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the sine."""
        return sine(self.amplitude, self.frequency, self.phase, self.offset)


class SinesTable(DriveTable):
    """A sum of sines, one entry of each list for each."""

    kind: Literal["sines"]
    amplitudes: Reals
    frequencies: Reals
    phases: Reals
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the sines."""
        return Sines(self.amplitudes, self.frequencies, self.phases, self.offset)


class MultisineTable(DriveTable):
    """Sines of equal amplitude and random phase, evenly spread over a band."""

    kind: Literal["multisine"]
    rms: Real
    low: Real
    high: Real
    count: Whole
    seed: Whole | None = None
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the sines."""
        own = seed if self.seed is None else self.seed
        return multisine(
            rms=self.rms,
            low=self.low,
            high=self.high,
            count=self.count,
            seed=own,
            offset=self.offset,
        )


class ChirpTable(DriveTable):
    """A sine whose frequency runs from `low` to `high` in `seconds`, then stays."""

    kind: Literal["chirp"]
    amplitude: Real
    low: Real
    high: Real
    seconds: Real
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the sweep."""
        return Chirp(self.amplitude, self.low, self.high, self.seconds, self.offset)


class SawtoothTable(DriveTable):
    """A ramp that starts over."""

    kind: Literal["sawtooth"]
    amplitude: Real
    frequency: Real
    phase: Real = 0.0
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the wave."""
        return Sawtooth(self.amplitude, self.frequency, self.phase, self.offset)


class SquareTable(DriveTable):
    """A square wave."""

    kind: Literal["square"]
    amplitude: Real
    frequency: Real
    phase: Real = 0.0
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the wave."""
        return Square(self.amplitude, self.frequency, self.phase, self.offset)


class PrbsTable(DriveTable):
    """A pseudo-random binary sequence of bits of `bit` seconds."""

    kind: Literal["prbs"]
    amplitude: Real
    bit: Real
    seed: Whole | None = None
    order: Whole = 10
    offset: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the sequence."""
        own = seed if self.seed is None else self.seed
        return Prbs(self.amplitude, self.bit, own, self.order, self.offset)


class FileTable(DriveTable):
    """A column of a file, played back; the path is relative to the scenario's file."""

    kind: Literal["file"]
    path: str
    column: str
    time: str = "time"
    between: Literal["held", "linear"] = "held"
    after: Literal["last", "zero"] = "last"

    def drive(self, seed: int) -> Drive:
        """Read the column."""
        return recorded(
            self.path, self.column, time=self.time, between=self.between, after=self.after
        )


class RampsTable(DriveTable):
    """A quintic path through points, from rest to rest."""

    kind: Literal["ramps"]
    times: Reals
    values: Reals

    def drive(self, seed: int) -> Drive:
        """Make the path."""
        return Ramps(self.times, self.values)


class HoldTable(DriveTable):
    """A value that does not change."""

    kind: Literal["hold"]
    value: Real

    def drive(self, seed: int) -> Drive:
        """Make the constant."""
        return hold(self.value)
