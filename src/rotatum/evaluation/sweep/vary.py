"""What is varied: ``sensors.encoders.link=256,1024,4096``, values written as in TOML."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any, NamedTuple

from rotatum.errors import ScenarioError

__all__ = ["Value", "Vary", "parse_vary"]

Value = bool | int | float | str | list[Any]
"""A value of a scenario's key; a list holds values of the other kinds, or lists."""

# Quotes do not survive a shell, so that a name or a path needs none.
_BARE = re.compile(r"[A-Za-z_./~][\w./~-]*")
_OPEN, _CLOSE, _QUOTES = "[{", "]}", "\"'"


class Vary(NamedTuple):
    """A key of the scenario and the values it takes in turn.

    Args:
        key: dotted, as ``Scenario.with_values`` takes it.
        values: in the order given.
    """

    key: str
    values: tuple[Value, ...]


def parse_vary(text: str) -> Vary:
    """Read ``key=a,b,c``.

    Values are TOML: numbers, ``true`` and ``false``, arrays in brackets. A text needs no quotes
    if it begins as a name or a path does and holds no comma or blank.

    >>> parse_vary("sensors.encoders.link=256,1024")
    Vary(key='sensors.encoders.link', values=(256, 1024))
    >>> parse_vary("estimate.fit=[],['inertia']").values
    ([], ['inertia'])
    >>> parse_vary("device=vsa-ii,awas").values
    ('vsa-ii', 'awas')

    Raises:
        ScenarioError: no key, no value, the same value twice, or a value that is not TOML.
    """
    key, equals, listed = text.partition("=")
    key = key.strip()
    if not equals or not key:
        raise ScenarioError(
            "what is varied is given as key=value,value",
            where="--vary",
            value=text,
            hint="Such as sensors.encoders.link=256,1024,4096.",
        )
    values = tuple(_value(part.strip(), key) for part in _split(listed))
    for place, value in enumerate(values):
        if repr(value) in map(repr, values[:place]):
            raise ScenarioError("the same value twice", where=f"--vary {key}", value=value)
    return Vary(key, values)


def _value(text: str, key: str) -> Value:
    where = f"--vary {key}"
    if not text:
        raise ScenarioError("a value is missing", where=where, value=text)
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        if _BARE.fullmatch(text):
            return text
        raise ScenarioError(
            "is not a TOML value",
            where=where,
            value=text,
            allowed="numbers, true, false, texts, arrays such as [1, 2]",
        ) from None
    if not _is_value(value):
        raise ScenarioError(
            "is neither a number, a boolean, a text nor an array of them",
            where=where,
            value=text,
            hint="Vary the keys of a table one by one, with dots.",
        )
    checked: Value = value
    return checked


def _is_value(value: object) -> bool:
    if isinstance(value, list):
        return all(map(_is_value, value))
    return isinstance(value, bool | int | float | str)


def _split(text: str) -> Iterator[str]:
    """Split at the commas that are in no bracket and no quotes."""
    depth, quote, first = 0, "", 0
    for place, sign in enumerate(text):
        if quote:
            quote = "" if sign == quote and text[place - 1] != "\\" else quote
        elif sign in _QUOTES:
            quote = sign
        elif sign in _OPEN:
            depth += 1
        elif sign in _CLOSE:
            depth -= 1
        elif sign == "," and depth == 0:
            yield text[first:place]
            first = place + 1
    yield text[first:]
