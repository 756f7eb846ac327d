"""Figures beside their targets."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, NamedTuple


class Figure(NamedTuple):
    """One line of the table.

    Args:
        what: what was measured.
        value: the figure, None: it could not be measured.
        unit: ``"x"`` for a ratio.
        target: what it should be.
        at_least: the target is a lower bound.
        note: more about it, or why there is no figure.
    """

    what: str
    value: float | None
    unit: str
    target: float | None = None
    at_least: bool = False
    note: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None: there is no target or no figure."""
        if self.target is None or self.value is None:
            return None
        return self.value >= self.target if self.at_least else self.value <= self.target

    def record(self) -> dict[str, Any]:
        """Return the line for JSON."""
        return self._asdict() | {"met": self.met}

    def cells(self) -> tuple[str, str, str, str, str]:
        """Return the line for the table."""
        sign = ">=" if self.at_least else "<="
        target = "" if self.target is None else f"{sign} {self.target:g} {self.unit}"
        value = "-" if self.value is None else f"{self.value:.3g} {self.unit}"
        verdict = {True: "met", False: "NOT MET", None: ""}[self.met]
        return self.what, value, target, verdict, self.note


def as_text(figures: Sequence[Figure]) -> str:
    """Return the table."""
    rows = [("what", "figure", "target", "", "note"), *(f.cells() for f in figures)]
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    lines = [
        "  ".join([*(cell.ljust(w) for cell, w in zip(row, widths, strict=False)), row[4]]).rstrip()
        for row in rows
    ]
    lines.insert(1, "  ".join("-" * w for w in widths))
    return "\n".join(lines)


def as_json(figures: Sequence[Figure], about: dict[str, Any]) -> str:
    """Return one JSON object: about the machine, and a list of figures."""
    return json.dumps({**about, "figures": [f.record() for f in figures]}, indent=2)
