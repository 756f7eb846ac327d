"""From a validation failure to one sentence: file, key, value, allowed, nearest known key."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from rotatum.errors import DeviceError, nearest

__all__ = ["explain", "key_names"]

# The field holds all motors; the file calls each of them a motor. So with transmissions.
_FILE_NAMES = {"motors": "motor", "transmissions": "transmission"}


def explain(
    error: ValidationError, model: type[BaseModel], *, source: str, place: str = ""
) -> DeviceError:
    """Turn pydantic's findings into one error about the first of them.

    Parameters
    ----------
    error : what pydantic raised.
    model : the model that was validated.
    source : the file.
    place : dotted prefix of the validated table in the file, such as "joint[2].".
    """
    details = error.errors(include_url=False)
    first = details[0]
    key = place + _dotted(first["loc"])
    context = first.get("ctx", {})
    hint = _others(place, details)
    if first["type"] in ("extra_forbidden", "unknown_key"):
        below = context.get("key")
        allowed = context.get("allowed") or key_names(_model_at(model, first["loc"][:-1]))
        name = below.rpartition(".")[2] if below else str(first["loc"][-1])
        hint = _joined(_suggestion(name, allowed), hint)
        what = f'unknown key "{_below(key, below)}"'
        return DeviceError(what, where=source, allowed=allowed, hint=hint)
    if first["type"] == "bad_choice":
        value, allowed = context["value"], context["allowed"]
        hint = _joined(_suggestion(value, allowed), hint)
        what = f"{_below(key, context['key'])}: {context['what']}"
        return DeviceError(what, where=source, value=value, allowed=allowed, hint=hint)
    if first["type"] == "bad_value":
        what = f"{_below(key, context['key'])} {context['rule']}"
        return DeviceError(what, where=source, value=context["value"], hint=hint)
    if first["type"] == "missing":
        return DeviceError(f'the key "{key}" is missing', where=source, hint=hint)
    if first["type"] == "literal_error":
        what, value = f"{key} is none of the known values", first["input"]
        expected = context["expected"].replace(" or ", ", ").replace("'", "")
        allowed = tuple(expected.split(", "))
        hint = _joined(_suggestion(str(value), allowed), hint)
        return DeviceError(what, where=source, value=value, allowed=allowed, hint=hint)
    value = first["input"] if not isinstance(first["input"], dict) else None
    return DeviceError(f"{key or 'joint'}{_rule(first)}", where=source, value=value, hint=hint)


def key_names(model: type[BaseModel] | None) -> tuple[str, ...]:
    """Return the keys a table of the file may have."""
    fields = model.model_fields if model is not None else {}
    return tuple(_FILE_NAMES.get(name, name) for name in fields)


def _dotted(location: Sequence[str | int]) -> str:
    """Write a location as the dotted key of the file; the only motor has no number."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]" if part > 0 else ""
        else:
            text += f"{'.' if text else ''}{_FILE_NAMES.get(part, part)}"
    return text


def _below(key: str, below: str | None) -> str:
    """Join a table's key and what is below it."""
    return ".".join(part for part in (key, below) if part).replace("..", ".")


def _rule(detail: ErrorDetails) -> str:
    """Say the broken rule so that it follows the key."""
    text = detail["msg"].removeprefix("Value error, ")
    for pydantic_says, ours in (
        ("Input should be a valid", "must be a"),
        ("Input should be", "must be"),
        ("Input should have", "must have"),
    ):
        text = text.replace(pydantic_says, ours)
    starts_as_rule = text.startswith(("must", "holds", "needs"))
    return f" {text}" if starts_as_rule else f": {text}"


def _suggestion(name: str, allowed: Sequence[str]) -> str | None:
    """Ask whether the nearest known name was meant."""
    close = nearest(name, allowed)
    return f'Did you mean "{close}"?' if close else None


def _others(place: str, details: list[ErrorDetails]) -> str | None:
    """List the further keys that are wrong."""
    keys = sorted({place + _dotted(detail["loc"]) for detail in details[1:]})
    return f"Also wrong: {', '.join(keys)}." if keys else None


def _joined(*sentences: str | None) -> str | None:
    """Join what there is to say."""
    return " ".join(sentence for sentence in sentences if sentence) or None


def _model_at(model: type[BaseModel], location: Sequence[str | int]) -> type[BaseModel] | None:
    """Follow a location down to the model that validates it."""
    current: type[BaseModel] | None = model
    for part in location:
        if isinstance(part, int) or current is None or part not in current.model_fields:
            continue
        current = _model_in(current.model_fields[part].annotation)
    return current


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """Find the table's model in an annotation such as `Link | None` or `tuple[Motor, ...]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    found = (_model_in(inner) for inner in get_args(annotation))
    return next((inner for inner in found if inner is not None), None)
