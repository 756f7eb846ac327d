"""Results as tables for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rotatum.evaluation import Estimate
from rotatum.report.results import FITTED, TITLES, Line, cells, fitted_lines, lines

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

__all__ = ["print_estimate", "table_of", "verdict_text"]

_STYLES = {
    "starved": "dim",
    "converging": "yellow",
    "informative": "bold green",
    "inconsistent": "bold red",
}

# What stands below the tables; the report has all of them.
_SETTINGS = (
    "cutoff",
    "window",
    "bandwidth",
    "fit",
    "forgetting",
    "solver",
    "shrinkage",
    "selective",
)


def print_estimate(console: Console, estimate: Estimate) -> None:
    """Print stiffness and verdict per joint and transmission, what was fitted, the truth, reasons.

    Below stand the settings used and why.

    Parameters
    ----------
    console : where to.
    estimate : what to tell.
    """
    told = lines(estimate)
    console.print(_results(estimate, told))
    if any(found.fitted for found in estimate.joints.values()):
        console.print(_fitted(estimate))
    if any(line.mse for line in told):
        console.print(_truth(told))
    for found in estimate.joints.values():
        console.print(f"{found.name}: {found.reason}")
    for settings in _settings(estimate):
        console.print(settings, style="dim")


def table_of(*columns: str, title: str | None = None, numbers: tuple[int, ...] = ()) -> Table:
    """Return an empty table.

    Parameters
    ----------
    columns : their titles.
    title : above the table.
    numbers : which columns stand to the right.
    """
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
    for place, name in enumerate(columns):
        table.add_column(name, justify="right" if place in numbers else "left", overflow="fold")
    return table


def verdict_text(verdict: str) -> Text:
    """Return a verdict in its colour.

    Parameters
    ----------
    verdict : one of the four words.
    """
    from rich.text import Text

    return Text(verdict, style=_STYLES.get(verdict, ""))


def _results(estimate: Estimate, told: Sequence[Line]) -> Table:
    title = (
        f"{estimate.device.name}: {estimate.method}, {estimate.side} side, torque "
        f"{estimate.torque}; {estimate.samples:,} samples, {estimate.seconds:.4g} s"
    )
    head, rows = cells(told, TITLES)
    table = table_of(*head, title=title)
    table.padding = (0, 1, 0, 0)
    verdict = head.index(TITLES["verdict"])
    # A narrow terminal folds the other columns.
    for place in (0, verdict):
        table.columns[place].no_wrap = True
    for row in rows:
        table.add_row(*row[:verdict], verdict_text(row[verdict]), *row[verdict + 1 :])
    return table


def _fitted(estimate: Estimate) -> Table:
    table = table_of(*FITTED)
    for found in estimate.joints.values():
        for row in fitted_lines(estimate, found):
            table.add_row(*row)
    return table


def _truth(told: Sequence[Line]) -> Table:
    titles = {
        "name": "joint",
        "mse": "mean square error",
        "msrep": "MSREP %",
        "covered": "truth in interval %",
        "scored": "scored from s",
    }
    head, rows = cells([line for line in told if line.mse], titles)
    table = table_of(*head, numbers=(1, 2, 3, 4))
    table.columns[0].no_wrap = True
    for row in rows:
        table.add_row(*row)
    return table


def _settings(estimate: Estimate) -> list[str]:
    """Say the settings a reader may want to change; joints that share them are told at once."""
    shared: dict[str, list[str]] = {}
    for found in estimate.joints.values():
        words = [f"{name} {found.settings[name]}" for name in _SETTINGS if name in found.settings]
        shared.setdefault("; ".join(words), []).append(found.name)
    return [f"{', '.join(names)}: {told}" for told, names in shared.items()]
