"""Which papers are reproduced, and the cases a request names."""

from __future__ import annotations

from typing import NamedTuple

from rotatum.errors import MethodError, nearest
from rotatum.evaluation.papers import deluca2007, flacco2012, menard2013, trumic2022
from rotatum.evaluation.papers.case import Case

__all__ = ["PAPERS", "Paper", "asked_for"]


class Paper(NamedTuple):
    """A paper and its cases.

    Args:
        key: as it is cited.
        title: of the paper.
        cases: in its order.
    """

    key: str
    title: str
    cases: tuple[Case, ...]


PAPERS: dict[str, Paper] = {
    paper.key: paper
    for paper in (
        Paper("deluca2007", deluca2007.TITLE, deluca2007.CASES),
        Paper("flacco2012", flacco2012.TITLE, flacco2012.CASES),
        Paper("menard2013", menard2013.TITLE, menard2013.CASES),
        Paper("trumic2022", trumic2022.TITLE, trumic2022.CASES),
    )
}


def asked_for(request: str) -> tuple[Paper, tuple[Case, ...]]:
    """Return the paper and the cases that ``PAPER`` or ``PAPER:CASE`` names.

    Raises:
        MethodError: there is no such paper or case; it names the nearest.
    """
    key, colon, name = request.partition(":")
    if key not in PAPERS:
        raise _unknown("no such paper", key, tuple(PAPERS))
    paper = PAPERS[key]
    if not colon:
        return paper, paper.cases
    cases = {case.name: case for case in paper.cases}
    if name not in cases:
        raise _unknown(f"no such case of {key}", name, tuple(cases))
    return paper, (cases[name],)


def _unknown(what: str, value: str, allowed: tuple[str, ...]) -> MethodError:
    close = nearest(value, allowed)
    hint = f'Did you mean "{close}"?' if close else None
    return MethodError(what, value=value, allowed=allowed, hint=hint)
