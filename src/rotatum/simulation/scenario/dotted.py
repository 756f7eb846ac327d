"""Dotted keys: `sensors.encoders.link`, `payload[0].mass`, `joint."axis 1".start.q`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rotatum.errors import ScenarioError

__all__ = ["Key", "assigned", "flat", "path_of"]

Key = tuple[str | int, ...]
"""The parts of a dotted key: names of tables, places in arrays."""

_PART = re.compile(r'(?:^|(?<=.)\.)(?:"([^"]+)"|([^."\[\]\s]+))|\[(\d+)\]')


def path_of(key: str) -> Key:
    """Split a dotted key.

    Raises
    ------
    ScenarioError if it is none.

    >>> path_of('payload[0].mass')
    ('payload', 0, 'mass')
    """
    parts: list[str | int] = []
    place = 0
    while place < len(key):
        found = _PART.match(key, place)
        if found is None:
            break
        quoted, plain, number = found.groups()
        parts.append(int(number) if number is not None else quoted or plain)
        place = found.end()
    if place < len(key) or not parts or isinstance(parts[0], int):
        raise ScenarioError(
            "is not a dotted key", value=key, allowed='such as sensors.encoders.link or "a b".c[0]'
        )
    return tuple(parts)


def assigned(table: object, path: Sequence[str | int], value: object) -> Any:
    """Return a copy of a table with another value at a path; tables that are missing are made.

    A name stands for all entries of an array of tables: `motor.inertia` is that of both motors.

    Raises
    ------
    ScenarioError for a place an array does not have.
    """
    if not path:
        return value
    head, rest = path[0], path[1:]
    if isinstance(head, int):
        entries = table if isinstance(table, list) else [table]
        if head >= len(entries):
            raise ScenarioError("there are fewer entries", value=f"[{head}]")
        new = [assigned(e, rest, value) if i == head else e for i, e in enumerate(entries)]
        return new if isinstance(table, list) else new[0]
    if isinstance(table, list):
        return [assigned(entry, path, value) for entry in table]
    here = dict(table) if isinstance(table, Mapping) else {}
    here[head] = assigned(here.get(head, {}), rest, value)
    return here


def flat(table: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, Any]]:
    """Yield dotted key and value of all that is in a table; `{ value, std }` is one value."""
    for name, value in table.items():
        key = f"{place}.{name}" if place else name
        if isinstance(value, Mapping) and value and "value" not in value:
            yield from flat(value, key)
        else:
            yield key, value
