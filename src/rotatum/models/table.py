"""What all tables of a device file share: frozen, no unknown keys, strict numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from rotatum.models.quantity import Uncertain

__all__ = [
    "NonNegative",
    "NonNegativeQuantity",
    "NonZero",
    "Positive",
    "PositiveQuantity",
    "Real",
    "Table",
    "bad_choice",
    "bad_value",
    "unknown_key",
]


class Table(BaseModel):
    """A table of a device file."""

    model_config = ConfigDict(frozen=True, extra="forbid")


# Strict: the text "50" is not a number, and true is not 1.
Real = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
NonNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0)]


def bad_choice(what: str, key: str, value: str, allowed: Sequence[str]) -> PydanticCustomError:
    """Return the error of a name that is not among those allowed.

    Parameters
    ----------
    what : what is wrong.
    key : dotted key below the table that is being validated.
    value : the name given.
    allowed : the names there are.
    """
    context = {"what": what, "key": key, "value": value, "allowed": tuple(allowed)}
    return PydanticCustomError("bad_choice", "{what}", context)


def bad_value(rule: str, key: str, value: object) -> PydanticCustomError:
    """Return the error of a value that breaks a rule, such as "must be a number".

    Parameters
    ----------
    rule : the rule, so that it can follow the key.
    key : dotted key below the table that is being validated.
    value : the value given.
    """
    return PydanticCustomError("bad_value", "{rule}", {"rule": rule, "key": key, "value": value})


def unknown_key(key: str, allowed: Sequence[str]) -> PydanticCustomError:
    """Return the error of a key that a table does not have.

    Parameters
    ----------
    key : dotted key below the table that is being validated.
    allowed : the keys there are.
    """
    return PydanticCustomError(
        "unknown_key", "unknown key", {"key": key, "allowed": tuple(allowed)}
    )


def _quantity(raw: object) -> object:
    """Turn a number or {value, std} into an Uncertain."""
    if isinstance(raw, Uncertain):
        return raw
    if isinstance(raw, Mapping):
        unknown = sorted(set(raw) - {"value", "std"})
        if unknown:
            raise ValueError(f'holds the unknown key "{unknown[0]}"; allowed: value, std')
        if "value" not in raw:
            raise ValueError("needs the key value; allowed: value, std")
        std = raw.get("std")
        return Uncertain(_number(raw["value"]), None if std is None else _number(std))
    return Uncertain(_number(raw))


def _number(raw: object) -> float:
    """Return a number, refusing texts and truth values."""
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise ValueError("must be a number or { value = ..., std = ... }")
    return float(raw)


def _above_zero(quantity: Uncertain) -> Uncertain:
    """Refuse a value that is not positive."""
    if quantity.value <= 0.0:
        raise ValueError("must be greater than 0")
    return quantity


def _not_below_zero(quantity: Uncertain) -> Uncertain:
    """Refuse a negative value."""
    if quantity.value < 0.0:
        raise ValueError("must be at least 0")
    return quantity


def _not_zero(number: float) -> float:
    """Refuse zero."""
    if number == 0.0:
        raise ValueError("must not be 0")
    return number


NonZero = Annotated[float, Field(strict=True, allow_inf_nan=False), AfterValidator(_not_zero)]
PositiveQuantity = Annotated[Uncertain, BeforeValidator(_quantity), AfterValidator(_above_zero)]
NonNegativeQuantity = Annotated[
    Uncertain, BeforeValidator(_quantity), AfterValidator(_not_below_zero)
]
