"""The cases of a sweep, in their fixed order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rotatum.evaluation.sweep.vary import Value, Vary

__all__ = ["Case", "cases", "combinations"]


@dataclass(frozen=True)
class Case:
    """One simulation with its estimate.

    Args:
        number: its place in the sweep, from 0.
        values: varied key to value.
        seed: of the simulation.
    """

    number: int
    values: Mapping[str, Value]
    seed: int


def combinations(varied: Sequence[Vary]) -> Iterator[dict[str, Value]]:
    """Give every combination of values, the key given last changing fastest.

    >>> list(combinations([Vary("a", (1, 2)), Vary("b", (3, 4))]))[1]
    {'a': 1, 'b': 4}
    """
    for values in product(*(vary.values for vary in varied)):
        yield dict(zip((vary.key for vary in varied), values, strict=True))


def cases(varied: Sequence[Vary], first_seeds: Sequence[int], seeds: int) -> list[Case]:
    """Return all cases, the seed changing fastest.

    Args:
        varied: what is varied.
        first_seeds: each combination's own seed, in the order of ``combinations``.
        seeds: how many seeds from there on.
    """
    return [
        Case(place * seeds + k, values, first + k)
        for place, (values, first) in enumerate(zip(combinations(varied), first_seeds, strict=True))
        for k in range(seeds)
    ]
