"""Where the numbers of a device file are from: its [sources] table."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from rotatum.models.table import bad_value, unknown_key

__all__ = ["MARKS", "flat_sources", "mark_of", "source_of"]

MARKS = ("sourced", "computed", "inferred")
"""First word of an entry: read in the source named; worked out from what was read; chosen."""


def flat_sources(raw: object) -> dict[str, str]:
    """Return dotted key -> text; TOML nests what is written dotted and not quoted.

    Raises
    ------
    PydanticCustomError or ValueError for an entry that does not say its mark and its source.
    """
    if not isinstance(raw, Mapping):
        raise ValueError("must be a table")
    return dict(_flat(raw, ""))


def _flat(table: Mapping[str, object], place: str) -> Iterator[tuple[str, str]]:
    for name, value in table.items():
        key = f"{place}.{name}" if place else name
        if isinstance(value, Mapping):
            yield from _flat(value, key)
        elif not isinstance(value, str) or mark_of(value) is None:
            rule = 'must begin with "sourced: ", "computed: " or "inferred: " and say where from'
            raise bad_value(rule, key, value)
        else:
            yield key, value


def mark_of(text: str) -> str | None:
    """Return the mark an entry begins with; None if it has none, or says nothing after it."""
    mark, colon, rest = text.partition(": ")
    return mark if mark in MARKS and colon and rest.strip() else None


def source_of(sources: Mapping[str, str], key: str) -> str | None:
    """Return the entry of a value: its own, or that of the nearest table around it.

    Parameters
    ----------
    sources : dotted key -> text.
    key : such as "motor.inertia", or "motor[1].inertia" for the second of them.
    """
    parts = key.split(".")
    for length in range(len(parts), 0, -1):
        around = ".".join(parts[:length])
        for name in (around, without_number(around)):
            if name in sources:
                return sources[name]
    return None


def without_number(key: str) -> str:
    """Return a key without the number of its table.

    >>> without_number("motor[1].inertia")
    'motor.inertia'
    """
    return re.sub(r"\[\d+\]", "", key)


def check_key(key: str, tables: Mapping[str, tuple[str, ...]]) -> None:
    """Refuse an entry about a key that the file cannot have.

    Parameters
    ----------
    key : dotted key.
    tables : dotted name of each table -> its keys.

    Raises
    ------
    PydanticCustomError naming the keys there are.
    """
    plain = without_number(key)
    table, _, name = plain.rpartition(".")
    known = (*tables, *tables.get(table, ()))
    if plain not in tables and name not in tables.get(table, ()):
        raise unknown_key(f"sources.{key}", tables.get(table, known))
