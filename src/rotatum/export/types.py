"""Types of the subset: three scalars, records, and fixed-size arrays of either."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from rotatum.record import Field, Layout


@dataclass(frozen=True)
class Scalar:
    """A number, or the outcome of a comparison."""

    name: str
    c: str

    def __str__(self) -> str:
        """Name the type."""
        return self.name


FLOAT = Scalar("float", "double")
INT = Scalar("int", "int64_t")
BOOL = Scalar("bool", "bool")


def shape_key(layout: Layout) -> str:
    """Return a text equal for layouts that are one C struct: name, field names, kinds and sizes."""
    fields = ",".join(
        f"{name}:{f.kind if isinstance(f.kind, str) else shape_key(f.kind)}{f.dims}"
        for name, f in layout.fields.items()
    )
    return f"{layout.name}({fields})"


@dataclass(frozen=True)
class Record:
    """A reference to a record. Two are the same type when they are the same C struct."""

    layout: Layout = field(compare=False)
    key: str

    def __str__(self) -> str:
        """Name the type."""
        return self.layout.name


@dataclass(frozen=True)
class Array:
    """A reference to a fixed-size array, row-major."""

    item: Scalar | Record
    dims: tuple[int, ...]

    def __str__(self) -> str:
        """Name the type."""
        return f"{self.item}{list(self.dims)}"


Type: TypeAlias = Scalar | Record | Array


def of_layout(layout: Layout) -> Record:
    """Return the type of a reference to one record."""
    return Record(layout, shape_key(layout))


def of_field(f: Field) -> Type:
    """Return the type of a record's field."""
    scalars = {"float": FLOAT, "int": INT}
    item = of_layout(f.kind) if isinstance(f.kind, Layout) else scalars[f.kind]
    return Array(item, tuple(int(d) for d in f.dims)) if f.dims else item
