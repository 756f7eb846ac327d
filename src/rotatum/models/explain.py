"""From a validation failure to one sentence: file, key, value, allowed, nearest known key."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from rotatum.errors import DeviceError, RotatumError, nearest

__all__ = ["explain", "key_names"]

# The field holds all motors; the file calls each of them a motor. So with transmissions.
_FILE_NAMES = {"motors": "motor", "transmissions": "transmission"}


def explain(
    error: ValidationError,
    model: type[BaseModel],
    *,
    source: str,
    place: str = "",
    kind: type[RotatumError] = DeviceError,
) -> RotatumError:
    """Turn pydantic's findings into one error about the first of them.

    Parameters
    ----------
    error : what pydantic raised.
    model : the model that was validated.
    source : the file.
    place : dotted prefix of the validated table in the file, such as "joint[2].".
    kind : class of the error.
    """
    details = error.errors(include_url=False)
    # A key that is misspelt is also missing: the misspelling says more.
    first = next((each for each in details if each["type"] == "extra_forbidden"), details[0])
    location, inner = _follow(model, first["loc"])
    key = place + _dotted(location)
    context = first.get("ctx", {})
    hint = _others(place, model, [each for each in details if each is not first])
    if first["type"] in ("extra_forbidden", "unknown_key"):
        below = context.get("key")
        allowed = context.get("allowed") or key_names(inner)
        name = below.rpartition(".")[2] if below else str(first["loc"][-1])
        hint = _joined(_suggestion(name, allowed), hint)
        what = f'unknown key "{_below(key, below)}"'
        return kind(what, where=source, allowed=allowed, hint=hint)
    if first["type"] == "bad_choice":
        value, allowed = context["value"], context["allowed"]
        hint = _joined(_suggestion(value, allowed), hint)
        what = f"{_below(key, context['key'])}: {context['what']}"
        return kind(what, where=source, value=value, allowed=allowed, hint=hint)
    if first["type"] == "bad_value":
        what = f"{_below(key, context['key'])} {context['rule']}"
        return kind(what, where=source, value=context["value"], hint=hint)
    if first["type"] == "missing":
        return kind(f'the key "{key}" is missing', where=source, hint=hint)
    if first["type"] == "union_tag_not_found":
        what = f'the key "{key}.{_unquoted(context["discriminator"])[0]}" is missing'
        return kind(what, where=source, hint=hint)
    if first["type"] in ("literal_error", "union_tag_invalid"):
        value, said = first["input"], context.get("expected")
        if said is None:
            value, said = context["tag"], context["expected_tags"]
            key += "." + _unquoted(context["discriminator"])[0]
        allowed = _unquoted(said.replace(" or ", ", "))
        hint = _joined(_suggestion(str(value), allowed), hint)
        what = f"{key} is none of the known values"
        return kind(what, where=source, value=value, allowed=allowed, hint=hint)
    value = first["input"] if not isinstance(first["input"], dict) else None
    return kind(f"{key or 'joint'}{_rule(first)}", where=source, value=value, hint=hint)


def key_names(model: type[BaseModel] | None) -> tuple[str, ...]:
    """Return the keys a table of the file may have."""
    return tuple(_file_name(model, name) for name in model.model_fields) if model else ()


def _dotted(location: Sequence[str | int]) -> str:
    """Write a location as a dotted key."""
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f"{'.' if text else ''}{part}"
    return text


def _file_name(model: type[BaseModel], name: str) -> str:
    """Return the key of a field in the file."""
    field = model.model_fields.get(name)
    several = field is not None and get_origin(field.annotation) is tuple
    return _FILE_NAMES.get(name, name) if several else name


def _below(key: str, below: str | None) -> str:
    """Join a table's key and what is below it."""
    return ".".join(part for part in (key, below) if part).replace("..", ".")


def _rule(detail: ErrorDetails) -> str:
    """Say the broken rule so that it follows the key."""
    text = detail["msg"].removeprefix("Value error, ")
    for pydantic_says, ours in (
        ("Input should be a valid integer", "must be an integer"),
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


def _unquoted(names: str) -> tuple[str, ...]:
    """Split pydantic's list of quoted names."""
    return tuple(names.replace("'", "").split(", "))


def _others(place: str, model: type[BaseModel], details: list[ErrorDetails]) -> str | None:
    """List the further keys that are wrong."""
    keys = sorted({place + _dotted(_follow(model, each["loc"])[0]) for each in details})
    return f"Also wrong: {', '.join(keys)}." if keys else None


def _joined(*sentences: str | None) -> str | None:
    """Join what there is to say."""
    return " ".join(sentence for sentence in sentences if sentence) or None


def _follow(
    model: type[BaseModel], location: Sequence[str | int]
) -> tuple[tuple[str | int, ...], type[BaseModel] | None]:
    """Return a location as the file has it, and the model of the table its last key is in.

    Where one of several tables was chosen by its `kind`, pydantic's location names the kind too.
    """
    kept: list[str | int] = []
    models: tuple[type[BaseModel], ...] = (model,)
    inside: type[BaseModel] | None = None
    for part in location:
        chosen = [m for m in models if len(models) > 1 and _tag_of(m) == part]
        if chosen:
            models = (chosen[0],)
        elif isinstance(part, int):
            # The only motor has no number.
            if part > 0 or kept[-1] not in _FILE_NAMES.values():
                kept.append(part)
        else:
            inside = models[0] if len(models) == 1 else None
            kept.append(_file_name(inside, part) if inside else part)
            field = inside.model_fields.get(part) if inside else None
            models = _models_in(field.annotation) if field else models
    return tuple(kept), inside


def _tag_of(model: type[BaseModel]) -> str | None:
    """Return the name by which a table is chosen, the value of its key `kind`."""
    field = model.model_fields.get("kind")
    known = get_args(field.annotation) if field and get_origin(field.annotation) is Literal else ()
    return known[0] if len(known) == 1 else None


def _models_in(annotation: Any) -> tuple[type[BaseModel], ...]:
    """Find the models in an annotation such as `Link | None` or `tuple[Motor, ...]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return (annotation,)
    found = (_models_in(inner) for inner in get_args(annotation))
    return tuple(dict.fromkeys(model for models in found for model in models))
