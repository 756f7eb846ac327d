"""What a paper's table or figure is here: a runnable case, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Case", "Curve", "Figure", "Map", "Outcome", "Plot", "Progress", "Value"]

Array = NDArray[np.float64]

Progress = Callable[[int, int | None], None]
"""Called with pieces of work done and pieces expected."""


class Value(NamedTuple):
    """One line of a case's table; what there is not is None.

    Args:
        label: what the numbers are.
        unit: of all of them.
        paper: as the paper prints it.
        own: ours with the paper's settings.
        weak: ours with method ``weak``; with defaults unless the label says otherwise.
        algebraic: ours with method ``algebraic``, likewise.
        rotatum: ours with method ``rotatum``, likewise.
        without: without an observer: a joint taken for rigid, or a law of the motors alone.
        observed: with the observer.
        true: with the true state in its place.
    """

    label: str
    unit: str
    paper: float | None = None
    own: float | None = None
    weak: float | None = None
    algebraic: float | None = None
    rotatum: float | None = None
    without: float | None = None
    observed: float | None = None
    true: float | None = None

    def to_json(self) -> dict[str, Any]:
        """The line's object in ``--json``; JSON has no infinity, which becomes null.

        Of what an observer is compared with it has what there is.
        """
        numbers = {
            "paper": self.paper,
            "paper_settings": self.own,
            "algebraic": self.algebraic,
            "rotatum": self.rotatum,
            "weak": self.weak,
        }
        states = {
            "without_observer": self.without,
            "observer": self.observed,
            "true_state": self.true,
        }
        numbers |= {k: x for k, x in states.items() if x is not None}
        told = {k: x if x is not None and isfinite(x) else None for k, x in numbers.items()}
        return {"label": self.label, "unit": self.unit, **told}


class Curve(NamedTuple):
    """A curve or cloud of points.

    Args:
        name: in the legend; the same name has the same colour in all plots of a case.
        x, y: (N,); NaN in y is a gap.
        style: ``"line"``, ``"dashed"``, ``"dotted"`` or ``"points"``.
    """

    name: str
    x: Array
    y: Array
    style: str = "line"


class Map(NamedTuple):
    """Values over a plane.

    Args:
        name: of the values, with their unit.
        x, y: (M,), (N,) where they are.
        values: (N, M).
    """

    name: str
    x: Array
    y: Array
    values: Array


class Plot(NamedTuple):
    """One vertical axis.

    Args:
        title: what it shows, with its unit.
        curves: drawn in order.
        map: drawn below them.
        logarithmic: whether the axis is.
        limits: lowest and highest value shown; None: as the curves ask for.
    """

    title: str
    curves: tuple[Curve, ...]
    map: Map | None = None
    logarithmic: bool = False
    limits: tuple[float, float] | None = None


class Figure(NamedTuple):
    """Plots over one horizontal axis.

    Args:
        key: short name.
        title: its heading; the figures of the paper it stands for.
        note: how to read it.
        x: title of the horizontal axis, with its unit.
        plots: from top to bottom.
        logarithmic: whether the horizontal axis is.
    """

    key: str
    title: str
    note: str
    x: str
    plots: tuple[Plot, ...]
    logarithmic: bool = False


class Outcome(NamedTuple):
    """What a case gives back.

    Args:
        values: lines of its table.
        figures: what it draws.
        findings: sentences about what came out.
    """

    values: tuple[Value, ...]
    figures: tuple[Figure, ...] = ()
    findings: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """The case's object in ``--json``: its lines and findings."""
        return {
            "values": [value.to_json() for value in self.values],
            "findings": list(self.findings),
        }

    def value(self, label: str) -> Value:
        """Return the line of that label.

        Raises:
            KeyError: there is none.
        """
        for value in self.values:
            if value.label == label:
                return value
        raise KeyError(label)


class Case(NamedTuple):
    """A table or figure of a paper as a program.

    Args:
        name: as on the command line.
        title: what it is.
        prints: what the paper prints.
        assumed: sentences: what the paper does not give, and what was taken instead.
        run: ``run(progress, quick)``; ``quick`` takes fewer seeds and sparser sweeps.
        waits: why it is not reproduced yet; empty: it is.
    """

    name: str
    title: str
    prints: str
    assumed: tuple[str, ...]
    run: Callable[[Progress, bool], Outcome]
    waits: str = ""
