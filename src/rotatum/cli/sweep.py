"""`rotatum sweep`: a scenario simulated, estimated and scored for every combination of values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rotatum.cli.estimate import names
from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import (
    Cutoff,
    Fit,
    Forgetting,
    Json,
    Method,
    Order,
    Selective,
    Shrinkage,
    Side,
    Solver,
    Stride,
    Torque,
    Window,
)

if TYPE_CHECKING:
    from rotatum.evaluation.sweep import Group

__all__ = ["sweep"]

_LINES = 10  # of progress where there is no terminal


def sweep(
    scenario: Annotated[
        str, typer.Argument(help="Scenario file (TOML), or a name of the ready ones.")
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="Table, a row per case and joint: .parquet, .csv or .npz."
        ),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=A,B,C",
            help="Dotted key of the scenario and its values in TOML; give it again for more keys.",
        ),
    ] = None,
    seeds: Annotated[
        int, typer.Option(metavar="N", help="Simulations per combination: seed, seed + 1, ...")
    ] = 1,
    method: Method = None,
    side: Side = None,
    torque: Torque = None,
    cutoff: Cutoff = None,
    window: Window = None,
    order: Order = None,
    stride: Stride = None,
    fit: Fit = None,
    forgetting: Forgetting = None,
    solver: Solver = None,
    shrinkage: Shrinkage = None,
    selective: Selective = None,
    start: Annotated[
        float | None,
        typer.Option("--from", help="Score from this many seconds on; else once converged."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes; else one per processor.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Do the work on the Dask cluster of this scheduler."),
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Forget what an interrupted sweep left.")
    ] = False,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep the folder TABLE.cases of finished cases.")
    ] = False,
    json: Json = False,
) -> int:
    """Simulate, estimate and score a scenario for every combination of values.

    A sweep that was interrupted goes on with the same command. Settings of the estimate are the
    scenario's unless given here.

    Exit code 0: a joint of a case is informative; 1: none is (the table is written all the same);
    2: bad input.
    """
    from rotatum.cli.places import check_places
    from rotatum.cli.printing import print_json

    check_places((output,), inputs=(Path(scenario),))

    from rotatum.evaluation import sweep as sweeps
    from rotatum.simulation.scenario import load_scenario

    loaded = load_scenario(scenario)
    choices = sweeps.Choices(
        method=method,
        side=side,
        torque=torque,
        cutoff=cutoff,
        window=window,
        order=order,
        stride=stride,
        fit=names(fit),
        forgetting=forgetting,
        solver=solver,
        shrinkage=shrinkage,
        selective=selective,
        start=start,
    )
    varied = [sweeps.parse_vary(text) for text in vary or ()]
    plan = sweeps.plan_of(loaded.tables, loaded.source, varied, seeds=seeds, choices=choices)
    with _progress() as shown:
        results = sweeps.sweep(
            plan,
            output,
            workers=workers,
            scheduler=scheduler,
            restart=restart,
            keep=keep,
            progress=shown,
        )
    _warn(results, [str(job) for job in plan.jobs])
    groups = sweeps.summary(results)
    if json:
        told = {"table": str(output), "cases": len(results)}
        print_json({**told, "groups": [group.to_json() for group in groups]})
    else:
        _print(groups, len(results), output)
    return DONE if any(group.informative for group in groups) else NO_ANSWER


def _warn(results: Sequence[Mapping[str, Any]], names: Sequence[str]) -> None:
    """Say of each way to have no result how often it came, and the first reason."""
    by_status: dict[str, list[Mapping[str, Any]]] = {}
    for result in results:
        by_status.setdefault(result["status"], []).append(result)
    for status, found in by_status.items():
        if status != "ok":
            first = f"the first: {names[found[0]['case']]}: {found[0]['message']}"
            say(f"warning: {len(found)} of {len(results)} cases {status}, {first}")


def _print(groups: Sequence[Group], cases: int, output: Path) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of

    keys = list(groups[0].values)
    joints = len({group.joint for group in groups}) > 1
    heads = ["cases", "informative", "no result", "|error| %", "90 %", "MSREP %", "90 %"]
    first = [*keys, *(["joint"] if joints else [])]
    table = table_of(
        *first,
        *heads,
        title="Median and 90th percentile per combination",
        numbers=tuple(range(len(first), len(first) + len(heads))),
    )
    for group in groups:
        table.add_row(
            *(str(value) for value in group.values.values()),
            *([group.joint] if joints else []),
            str(group.cases),
            f"{100.0 * group.informative:.3g} %",
            f"{100.0 * group.not_ok:.3g} %",
            *(
                _number(value)
                for value in (
                    group.error_percent,
                    group.error_percent_90,
                    group.msrep_percent,
                    group.msrep_percent_90,
                )
            ),
        )
    console = stdout()
    console.print(table)
    console.print(f"{cases} cases: {output}")


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else ""


@contextmanager
def _progress() -> Iterator[Callable[[int, int, int], None]]:
    """Show cases done and failures: a bar on a terminal, some lines where there is none."""
    from rich.console import Console

    console = Console(stderr=True, markup=False)
    if not console.is_terminal:
        yield _lines()
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    text = TextColumn("{task.description}", markup=False)
    columns = (text, BarColumn(), MofNCompleteColumn(), Remaining())
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task("sweeping", total=None)

        def report(done: int, failures: int, expected: int) -> None:
            shown.update(
                task, description=_words(failures), completed=done, total=expected, refresh=True
            )

        yield report


def _lines() -> Callable[[int, int, int], None]:
    told = -1

    def report(done: int, failures: int, expected: int) -> None:
        nonlocal told
        tenth = done * _LINES // expected
        if tenth > told:
            told = tenth
            say(f"{_words(failures)}: {done} of {expected} cases")

    return report


def _words(failures: int) -> str:
    return f"sweeping ({failures} without result)" if failures else "sweeping"
