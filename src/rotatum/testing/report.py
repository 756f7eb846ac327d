"""What a check of a stage found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from rotatum.testing.case import Case

Clause = Callable[[Case], Iterator[str]]
"""One demand of the contract: yields a sentence per way in which a case fails it."""


class SkippedError(Exception):
    """Raised by a clause that cannot be checked here; says why."""


@dataclass(frozen=True)
class Verdict:
    """The outcome of one clause.

    Args:
        clause: what is demanded.
        outcome: ``"passed"``, ``"failed"`` or ``"skipped"``.
        details: what failed, or why it was skipped.
    """

    clause: str
    outcome: Literal["passed", "failed", "skipped"]
    details: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Print one clause to a line, details below it."""
        return "\n    ".join([f"{self.outcome:7}  {self.clause}", *self.details])


@dataclass(frozen=True)
class Report:
    """The outcome of every clause for one stage."""

    stage: str
    verdicts: tuple[Verdict, ...]

    @property
    def failed(self) -> tuple[Verdict, ...]:
        """The clauses that do not hold."""
        return tuple(v for v in self.verdicts if v.outcome == "failed")

    @property
    def skipped(self) -> tuple[Verdict, ...]:
        """The clauses that were not checked."""
        return tuple(v for v in self.verdicts if v.outcome == "skipped")

    def __str__(self) -> str:
        """Print one clause to a line, details below it."""
        return "\n".join([f"stage {self.stage}", *map(str, self.verdicts)])


def judge(case: Case, clause: str, check: Clause) -> Verdict:
    """Run one clause; an exception that escapes it is a failure too."""
    try:
        details = tuple(check(case))
    except SkippedError as why:
        return Verdict(clause, "skipped", (str(why),))
    except Exception as error:  # whatever a stage under test may raise
        return Verdict(clause, "failed", (f"raised {_story(error)}",))
    return Verdict(clause, "failed" if details else "passed", details)


def _story(error: BaseException) -> str:
    """Return an exception with what caused it."""
    first = str(error).strip().partition("\n\n")[0]
    cause = f" (from {_story(error.__cause__)})" if error.__cause__ is not None else ""
    return f"{type(error).__name__}: {first}{cause}"
