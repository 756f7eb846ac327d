"""What values sensors can have: checks that name the fault, the channel and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from rotatum.errors import RotatumError, check_names


@dataclass(frozen=True)
class Rule:
    """What a value must be.

    Parameters
    ----------
    holds
        Whether a finite value is possible.
    allowed
        The same in words.
    """

    holds: Callable[[float], bool]
    allowed: str


NOT_NEGATIVE = Rule(lambda x: x >= 0.0, "a finite number, 0 or more")
POSITIVE = Rule(lambda x: x > 0.0, "a finite number above 0")
COUNTS = Rule(lambda x: x >= 1.0, "a finite number, 1 or more")
NOT_ZERO = Rule(lambda x: x != 0.0, "a finite number other than 0")
FINITE = Rule(lambda x: True, "a finite number")
# a clock at half or double speed is not skewed but another clock
RATE = Rule(lambda x: abs(x) < 0.5, "a number between -0.5 and 0.5")


def check_value(where: str, value: float, rule: Rule) -> None:
    """Raise `RotatumError` unless a value is finite and follows the rule."""
    if not (math.isfinite(value) and rule.holds(value)):
        raise impossible(where, value, rule.allowed)


def check_roles(where: str, roles_given: Iterable[str], roles: Sequence[str]) -> None:
    """Raise `RotatumError` for a channel that is none of `roles`; it suggests the nearest."""
    check_names(roles_given, roles, what="sensors have no such channel", where=where)


def check_map(where: str, values: Mapping[str, float], roles: Sequence[str], rule: Rule) -> None:
    """Raise `RotatumError` for an unknown channel or an impossible value of one."""
    check_roles(where, values, roles)
    for role, value in values.items():
        check_value(f"{where}.{role}", value, rule)


def check_vector(where: str, values: Sequence[float]) -> None:
    """Raise `RotatumError` unless there are three finite numbers."""
    if len(values) != 3 or not all(math.isfinite(x) for x in values):
        raise impossible(where, values, "three finite numbers")


def impossible(where: str, value: object, allowed: str) -> RotatumError:
    """Return the error of a value that no sensor can have."""
    return RotatumError("no sensor can have this value", where=where, value=value, allowed=allowed)
