"""Drives made of others, and all kinds of drives a scenario can write."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rotatum.errors import RotatumError
from rotatum.models.table import Real
from rotatum.simulation.drivers.combined import Scaled, Together
from rotatum.simulation.drivers.paths import FadeIn, Path, Superposed
from rotatum.simulation.drivers.waves import After, Drive
from rotatum.simulation.scenario.wave_tables import (
    ChirpTable,
    DriveTable,
    FileTable,
    HoldTable,
    MultisineTable,
    PrbsTable,
    RampsTable,
    SawtoothTable,
    SinesTable,
    SineTable,
    SquareTable,
)

__all__ = ["AnyDrive", "as_path"]


class FadeInTable(DriveTable):
    """A path that begins at `rest` and has become itself `seconds` after `start`."""

    kind: Literal["fade-in"]
    of: AnyDrive
    seconds: Real
    start: Real = 0.0
    rest: Real = 0.0

    def drive(self, seed: int) -> Drive:
        """Make the path."""
        return FadeIn(
            as_path(self.of.drive(seed), self.of.kind), self.seconds, self.start, self.rest
        )


class SumTable(DriveTable):
    """The sum of drives; that of paths is a path."""

    kind: Literal["sum"]
    of: tuple[AnyDrive, ...]

    def drive(self, seed: int) -> Drive:
        """Make the sum."""
        parts = tuple(part.drive(seed + number) for number, part in enumerate(self.of))
        paths = tuple(part for part in parts if isinstance(part, Path))
        return Superposed(paths) if len(paths) == len(parts) else Together(parts)


class ScaledTable(DriveTable):
    """A drive times a factor."""

    kind: Literal["scaled"]
    factor: Real
    of: AnyDrive

    def drive(self, seed: int) -> Drive:
        """Make the multiple."""
        return Scaled(self.factor, self.of.drive(seed))


class AfterTable(DriveTable):
    """Nothing until `start`, then a drive from its beginning."""

    kind: Literal["after"]
    start: Real
    of: AnyDrive

    def drive(self, seed: int) -> Drive:
        """Make the drive."""
        return After(self.start, self.of.drive(seed))


AnyDrive = Annotated[
    SineTable
    | SinesTable
    | MultisineTable
    | ChirpTable
    | SawtoothTable
    | SquareTable
    | PrbsTable
    | FileTable
    | RampsTable
    | HoldTable
    | FadeInTable
    | SumTable
    | ScaledTable
    | AfterTable,
    Field(discriminator="kind"),
]
"""Any drive, told apart by its `kind`."""

for _table in (FadeInTable, SumTable, ScaledTable, AfterTable):
    _table.model_rebuild()


def as_path(drive: Drive, kind: str) -> Path:
    """Return a drive as the path it is.

    Raises `RotatumError` for one that does not know its velocity and acceleration.
    """
    if isinstance(drive, Path):
        return drive
    raise RotatumError(
        "a path must be smooth",
        value=kind,
        allowed=("sine", "sines", "multisine", "ramps", "hold", "fade-in", "sum of such"),
    )
