"""`rotatum estimate`: the stiffness of every joint over a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import (
    Cutoff,
    DeviceName,
    Fit,
    Forgetting,
    Joints,
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

__all__ = ["estimate", "names"]


def estimate(
    log: Annotated[
        Path, typer.Argument(help="CSV, NPZ, MAT, HDF5 or Parquet.", show_default=False)
    ],
    device: DeviceName,
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
    joint: Joints = None,
    start: Annotated[
        float | None,
        typer.Option(
            "--from", help="Score from this many seconds into the log; else once converged."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Every sample's result: .csv, .npz or .parquet."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="One HTML page with every plot and setting.")
    ] = None,
    json: Json = False,
) -> int:
    """Estimate the stiffness of every joint over a log.

    Prints stiffness, interval and verdict per joint, and why. Exit code 0: a joint is informative;
    1: none is (everything is printed all the same); 2: bad input.
    """
    from rotatum.cli.places import check_places
    from rotatum.cli.printing import print_json, stdout
    from rotatum.cli.progress import progress

    check_places((output, report), inputs=(log, Path(device)))

    from rotatum import evaluation
    from rotatum.logs import open_log
    from rotatum.models import load_device

    robot = load_device(device)
    with progress("estimating") as shown:
        found = evaluation.estimate(
            open_log(log, robot, inertial=False),
            robot,
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
            joints=joint or None,
            start=start,
            output=output,
            progress=shown,
        )
    for warning in found.warnings:
        say(f"warning: {warning}")
    if json:
        print_json(found.to_json())
    else:
        from rotatum.cli.tables import print_estimate

        print_estimate(stdout(), found)
    if report is not None:
        from rotatum.report import write_report

        write_report(found, report)
    return DONE if found.informative else NO_ANSWER


def names(text: str | None) -> tuple[str, ...] | None:
    """Split a list with commas; "none" is the empty one.

    Parameters
    ----------
    text : as typed; None: nothing was.
    """
    if text is None:
        return None
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    return () if names == ("none",) else names
