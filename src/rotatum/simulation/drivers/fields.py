"""Checks of a driver's own numbers, with errors that name the field."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from rotatum.errors import RotatumError

__all__ = ["refuse_infinite", "refuse_not_growing", "refuse_not_positive"]


def refuse_infinite(kind: str, **fields: float | Sequence[float]) -> None:
    """Raise `RotatumError` unless every field, or every number of a list, is finite.

    Parameters
    ----------
    kind
        What the fields belong to, for the message: "chirp".
    fields
        Field -> its number or numbers.
    """
    for name, given in fields.items():
        numbers = given if isinstance(given, Sequence) else (given,)
        if not all(math.isfinite(number) for number in numbers):
            raise RotatumError("must be finite", where=f"{kind}.{name}", value=given)


def refuse_not_positive(kind: str, **fields: float) -> None:
    """Raise `RotatumError` unless every field is finite and greater than zero."""
    for name, number in fields.items():
        if not (math.isfinite(number) and number > 0.0):
            raise RotatumError("must be greater than zero", where=f"{kind}.{name}", value=number)


def refuse_not_growing(kind: str, name: str, times: Sequence[float]) -> None:
    """Raise `RotatumError` unless a list of times grows from each to the next."""
    if any(not later > earlier for earlier, later in pairwise(times)):
        raise RotatumError("must grow from each to the next", where=f"{kind}.{name}", value=times)
