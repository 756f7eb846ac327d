"""The constants of a transmission's law, as its table in the file gives them."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

from rotatum.models.laws import LAWS, Constant, Law
from rotatum.models.table import bad_choice, bad_value, unknown_key

__all__ = ["split_constants"]


def split_constants(
    raw: Mapping[str, object], keys: tuple[str, ...]
) -> tuple[dict[str, object], dict[str, tuple[float, ...]]]:
    """Take the constants of the law out of a transmission's table.

    Parameters
    ----------
    raw : the table.
    keys : what the table may hold beside the constants.

    Returns
    -------
    the rest of the table; the constants by name in the law's order, each a tuple of numbers.

    Raises
    ------
    PydanticCustomError or ValueError, naming the constant that is missing, wrong or unknown.
    """
    law = _law(raw.get("law"))
    own = {constant.name: constant for constant in law.constants} if law is not None else {}
    for key in raw:
        if key not in keys and key not in own:
            _refuse(key, law, (*keys, *own))
    for name in own:
        if name not in raw:
            raise ValueError(f'law "{raw["law"]}" needs the constant {name}')
    given = {name: _numbers(constant, raw[name]) for name, constant in own.items()}
    fault = law.wrong(given) if law is not None else None
    if fault is not None:
        raise ValueError(fault)
    return {key: value for key, value in raw.items() if key not in own}, given


def _law(name: object) -> Law | None:
    """Find the law of that name."""
    if name is None:
        return None
    if not isinstance(name, str) or name not in LAWS:
        raise bad_choice("is none of the known laws", "law", str(name), tuple(LAWS))
    return LAWS[name]


def _refuse(key: str, law: Law | None, allowed: tuple[str, ...]) -> None:
    """Say whether the key is another law's constant, or nobody's."""
    if any(key == constant.name for other in LAWS.values() for constant in other.constants):
        owner = f'law "{law.name}"' if law is not None else "a transmission without a law"
        told = ", ".join(constant.name for constant in law.constants) if law is not None else ""
        raise ValueError(f"{owner} has no constant {key}" + (f"; it has {told}" if told else ""))
    raise unknown_key(key, allowed)


def _numbers(constant: Constant, raw: object) -> tuple[float, ...]:
    """Return a constant's number, or all of them."""
    if not constant.many:
        return (_number(constant, raw),)
    if not isinstance(raw, list | tuple) or not raw:
        raise bad_value("must be a list of numbers", constant.name, raw)
    return tuple(_number(constant, each) for each in raw)


def _number(constant: Constant, raw: object) -> float:
    """Return a finite number of the constant's sign."""
    if isinstance(raw, bool) or not isinstance(raw, int | float) or not isfinite(raw):
        raise bad_value("must be a number", constant.name, raw)
    if constant.positive and raw <= 0.0:
        raise bad_value("must be greater than 0", constant.name, raw)
    return float(raw)
