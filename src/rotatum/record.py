"""Layouts: one class is the numpy dtype, the C struct, the checkpoint and the row in the docs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

Records = NDArray[Any]
"""An array whose dtype is a layout's: one element per joint, or (samples, joints)."""


class LayoutError(RotatumError):
    """A record's fields or sizes do not fit."""


@dataclass(frozen=True)
class Field:
    """One field of a record.

    Args:
        kind: ``"float"`` (float64), ``"int"`` (int64), or a bound ``Layout`` (nested record).
        dims: names (before binding) or sizes (after) of its axes; empty for a scalar.
        doc: what it is, in a line.
        unit: its unit, ``""`` when dimensionless.
        symbol: the letter the papers and kernels use.
    """

    kind: str | Layout
    dims: tuple[str | int, ...] = ()
    doc: str = ""
    unit: str = ""
    symbol: str = ""


def number(doc: str, *, unit: str = "", symbol: str = "") -> Field:
    """A float64 scalar."""
    return Field("float", (), doc, unit, symbol)


def integer(doc: str, *, symbol: str = "") -> Field:
    """An int64 scalar: counts, switches and bit fields."""
    return Field("int", (), doc, "", symbol)


def vector(
    size: str | int, doc: str, *, unit: str = "", symbol: str = "", kind: str = "float"
) -> Field:
    """A fixed-size vector; ``size`` may be a name that ``Record.layout`` binds."""
    return Field(kind, (size,), doc, unit, symbol)


def matrix(
    rows: str | int, columns: str | int, doc: str, *, unit: str = "", symbol: str = ""
) -> Field:
    """A fixed-size row-major matrix."""
    return Field("float", (rows, columns), doc, unit, symbol)


@dataclass(frozen=True)
class Layout:
    """A record with every dimension bound: ``dtype`` for numpy, fields in C order.

    Args:
        name: what the record is called, also in exported C.
        doc: what it holds, in a line.
        fields: name to ``Field``; every field is a multiple of 8 bytes, so there is no padding.
    """

    name: str
    doc: str
    fields: Mapping[str, Field]
    dtype: np.dtype[Any] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Make the dtype."""
        taken = [name for name in self.fields if hasattr(np.record, name)]
        if taken:
            raise LayoutError(
                f"record {self.name} has fields whose names numpy's records use", value=taken
            )
        scalar = {"float": np.dtype(np.float64), "int": np.dtype(np.int64)}
        rows = [
            (
                name,
                f.kind.dtype if isinstance(f.kind, Layout) else scalar[f.kind],
                tuple(int(d) for d in f.dims),
            )
            for name, f in self.fields.items()
        ]
        # align=True at the inner call: numpy ignores it silently at the outer one.
        object.__setattr__(self, "dtype", np.dtype((np.record, np.dtype(rows, align=True))))

    def zeros(self, *shape: int) -> Records:
        """An array of records, all fields zero."""
        return np.zeros(shape, self.dtype)

    def __hash__(self) -> int:
        """Hash by name and fields, like equality."""
        return hash((self.name, tuple(self.fields.items())))


class Record:
    """A record whose sizes are still names; a subclass declares its fields in its body.

    >>> class Pair(Record):
    ...     "Two coefficients."
    ...     gain = vector("p", "what it multiplies", unit="N m")
    >>> Pair.layout(p=2).dtype.itemsize
    16
    """

    @classmethod
    def fields(cls) -> dict[str, Field]:
        """Return the declared fields in order."""
        every = {name: f for kind in reversed(cls.__mro__) for name, f in vars(kind).items()}
        return {name: f for name, f in every.items() if isinstance(f, Field)}

    @classmethod
    def dims(cls) -> tuple[str, ...]:
        """Return the names of the sizes to bind, in order of first use."""
        seen = (d for f in cls.fields().values() for d in f.dims if isinstance(d, str))
        return tuple(dict.fromkeys(seen))

    @classmethod
    def layout(cls, **sizes: int) -> Layout:
        """Bind every size.

        Raises:
            LayoutError: a size is missing, unknown or not positive, or the class holds something
                that is no field.
        """
        if set(sizes) != set(cls.dims()) or any(n < 1 for n in sizes.values()):
            raise LayoutError(
                f"record {cls.__name__} needs the sizes {', '.join(cls.dims()) or '(none)'}, "
                "each >= 1",
                value=sizes,
            )
        strangers = [n for n in vars(cls) if not n.startswith("__") and n not in cls.fields()]
        if strangers:
            raise LayoutError(f"record {cls.__name__} may hold fields only", value=strangers)
        bound = {
            name: Field(f.kind, tuple(_size(d, sizes) for d in f.dims), f.doc, f.unit, f.symbol)
            for name, f in cls.fields().items()
        }
        return Layout(cls.__name__, (cls.__doc__ or "").strip(), bound)


def _size(dim: str | int, sizes: Mapping[str, int]) -> int:
    return sizes[dim] if isinstance(dim, str) else dim


Init = Callable[[Any, Any], None]
Hold = Callable[[Any, Any, Any], None]
Step = Callable[[Any, Any, Any, Any], None]
