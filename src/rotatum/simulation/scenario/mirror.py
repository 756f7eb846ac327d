"""Tables that mirror a dataclass, so that its fields are listed once."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Mapping
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel, Field, ValidationError, create_model

from rotatum.errors import RotatumError, ScenarioError
from rotatum.models.explain import explain
from rotatum.models.table import Real
from rotatum.simulation.scenario.part import Part

__all__ = ["read"]

Kind = TypeVar("Kind")

# Strict: the text "5" is not a number, and true is not 1.
_STRICT: dict[Any, Any] = {
    float: Real,
    int: Annotated[int, Field(strict=True)],
    bool: Annotated[bool, Field(strict=True)],
}


def read(kind: type[Kind], raw: object, *, source: str, place: str) -> Kind:
    """Make an object of a dataclass from a table of a scenario.

    Parameters
    ----------
    kind : a dataclass of numbers, names, mappings, tuples and other such dataclasses.
    raw : the table.
    source : the file.
    place : dotted key of the table, with a dot at its end.

    Raises
    ------
    ScenarioError naming the file, the key, the value, what is allowed and the nearest key.
    """
    wanted: Any = kind
    model = _mirror(wanted)
    try:
        table = model.model_validate(raw)
    except ValidationError as error:
        raise explain(error, model, source=source, place=place, kind=ScenarioError) from None
    try:
        made: Kind = _made(kind, table)
    except RotatumError as error:
        raise ScenarioError(
            f"{place.rstrip('.')}: {error.what}" + (f" ({error.where})" if error.where else ""),
            where=source,
            value=error.value,
            allowed=error.allowed,
            hint=error.hint,
        ) from None
    return made


@cache
def _mirror(kind: Any) -> type[BaseModel]:
    """Return the table of a dataclass."""
    hints = get_type_hints(kind)
    fields: dict[str, Any] = {}
    for each in dataclasses.fields(kind):
        default: Any = ...
        if each.default_factory is not dataclasses.MISSING:
            default = Field(default_factory=each.default_factory)
        elif each.default is not dataclasses.MISSING:
            default = each.default
        fields[each.name] = (_strict(hints[each.name]), default)
    model: type[BaseModel] = create_model(kind.__name__, __base__=Part, **fields)
    return model


def _strict(hint: Any) -> Any:
    """Return a type hint whose numbers are strict and whose dataclasses are tables."""
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return _mirror(hint)
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return reduce(or_, (_strict(each) for each in inner))
    if origin is not None and origin is not Annotated:
        return origin[tuple(_strict(each) for each in inner)]
    return _STRICT.get(hint, hint)


def _made(kind: Any, table: BaseModel) -> Any:
    """Make the object, and those within it, from what the file gives."""
    hints = get_type_hints(kind)
    given: dict[str, Any] = {}
    for name in table.model_fields_set:
        given[name] = _object(hints[name], getattr(table, name))
    return kind(**given)


def _object(hint: Any, value: object) -> object:
    if not isinstance(value, BaseModel):
        return dict(value) if isinstance(value, Mapping) else value
    inner: list[Any] = [k for k in (hint, *get_args(hint)) if dataclasses.is_dataclass(k)]
    own = next(kind for kind in inner if _mirror(kind) is type(value))
    return _made(own, value)
