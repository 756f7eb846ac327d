"""`rotatum compare`: every method a log and a device allow, on both sides, in one table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import Cutoff, DeviceName, Fit, Joints, Json, Window

if TYPE_CHECKING:
    from rotatum.evaluation import Comparison

__all__ = ["compare"]


def compare(
    log: Annotated[
        Path, typer.Argument(help="CSV, NPZ, MAT, HDF5 or Parquet.", show_default=False)
    ],
    device: DeviceName,
    cutoff: Cutoff = None,
    window: Window = None,
    fit: Fit = None,
    joint: Joints = None,
    start: Annotated[
        float | None,
        typer.Option(
            "--from",
            help="Score from this many seconds into the log; else from when the last of the "
            "methods has converged.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The table: .csv, .npz or .parquet."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="One HTML page with the table and all curves.")
    ] = None,
    json: Json = False,
) -> int:
    """Estimate with every method the log and the device allow, on both sides.

    Prints one table: stiffness, interval and verdict, scores against the log's truth or, where
    there is none, against one of the methods; what each method that is left out lacks; and which
    method is recommended. Exit code 0: a method is informative; 1: none is (everything is printed
    all the same); 2: bad input, or no method can run.
    """
    from rotatum.cli.estimate import names
    from rotatum.cli.places import check_places
    from rotatum.cli.printing import print_json

    check_places((output, report), inputs=(log, Path(device)))

    from rotatum import evaluation
    from rotatum.logs import TableWriter, open_log
    from rotatum.models import load_device

    if output is not None:
        TableWriter(output)  # says now, not after the work, whether it knows the ending
    robot = load_device(device)
    with _progress() as shown:
        found = evaluation.compare(
            open_log(log, robot, inertial=False),
            robot,
            cutoff=cutoff,
            window=window,
            fit=names(fit),
            joints=joint or None,
            start=start,
            progress=shown,
        )
    for warning in found.warnings:
        say(f"warning: {warning}")
    if json:
        print_json(found.to_json())
    else:
        _print(found)
    if output is not None:
        found.write(output)
    if report is not None:
        from rotatum.report import write_comparison

        write_comparison(found, report)
    return DONE if found.informative else NO_ANSWER


@contextmanager
def _progress() -> Iterator[Callable[[str, int, int | None], None]]:
    """Show each method's progress after the other's."""
    from rotatum.cli.progress import progress

    with ExitStack() as stack:
        now: dict[str, Callable[[int, int | None], None]] = {}

        def report(label: str, done: int, expected: int | None) -> None:
            if label not in now:
                now.clear()
                stack.close()
                now[label] = stack.enter_context(progress(f"estimating: {label}"))
            if done:
                now[label](done, expected)

        yield report


def _print(found: Comparison) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of, verdict_text
    from rotatum.report.comparison_lines import (
        NUMBERS,
        VERDICT,
        comparison_cells,
        comparison_notes,
        left_out_lines,
        outcome,
    )

    head, rows = comparison_cells(found)
    numbers = tuple(place for place, title in enumerate(head) if title in NUMBERS)
    title = f"{found.device.name}: {found.samples:,} samples, {found.seconds:.4g} s"
    table = table_of(*head, title=title, numbers=numbers)
    table.padding = (0, 1, 0, 0)
    verdict = head.index(VERDICT)
    # A narrow terminal folds the other columns, but no word of their titles.
    for place, column in enumerate(table.columns):
        column.no_wrap = place <= verdict
        column.min_width = max(map(len, head[place].split()))
    for row in rows:
        table.add_row(*row[:verdict], verdict_text(row[verdict]), *row[verdict + 1 :])
    console = stdout()
    console.print(table)
    for told in comparison_notes(found):
        console.print(told)
    left = left_out_lines(found)
    if left:
        console.print("\nLeft out", style="bold")
    for told in left:
        console.print(told)
    console.print("\nRecommended", style="bold")
    for advice in found.recommendation.joints.values():
        console.print("\n".join(filter(None, [str(advice), outcome(found, advice)])))
