"""Results as tables for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rotatum.evaluation import Estimate
from rotatum.report.words import fitted_unit, lines, measure, number

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


def print_estimate(console: Console, estimate: Estimate) -> None:
    """Print stiffness and verdict per joint, what was fitted, the truth, and the reasons.

    Parameters
    ----------
    console : where to.
    estimate : what to tell.
    """
    console.print(_results(estimate))
    if any(found.fitted for found in estimate.joints.values()):
        console.print(_fitted(estimate))
    if any(found.truth for found in estimate.joints.values()):
        console.print(_truth(estimate))
    for found in estimate.joints.values():
        console.print(f"{found.name}: {found.reason}")


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


def _results(estimate: Estimate) -> Table:
    title = (
        f"{estimate.device.name}: {estimate.method}, {estimate.side} side, torque "
        f"{estimate.torque}; {estimate.samples:,} samples, {estimate.seconds:.4g} s"
    )
    table = table_of(
        "joint", "stiffness", "interval", "verdict", "first informative", "torque rms", title=title
    )
    for told in lines(estimate):
        verdict = verdict_text(told.verdict)
        table.add_row(told.joint, told.stiffness, told.relative, verdict, told.since, told.torque)
    return table


def _fitted(estimate: Estimate) -> Table:
    table = table_of("joint", "fitted", "value")
    for joint in estimate.device.joints:
        for name, (value, std) in estimate.joints[joint.name].fitted.items():
            unit = fitted_unit(name, estimate, joint)
            table.add_row(joint.name, name, measure(value, std, unit))
    return table


def _truth(estimate: Estimate) -> Table:
    table = table_of(
        "joint",
        "mean square error",
        "MSREP %",
        "truth in interval %",
        "scored from s",
        numbers=(1, 2, 3, 4),
    )
    for found in estimate.joints.values():
        if found.truth:
            keys = ("mse", "msrep_percent", "coverage_percent")
            scores = [number(found.truth[key]) for key in keys]
            table.add_row(found.name, *scores, number(found.score_from))
    return table
