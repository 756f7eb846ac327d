"""`rotatum export c`: the estimator of a device as C99 with a test vector."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rotatum.cli.failures import DONE
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

__all__ = ["app", "c"]

app = typer.Typer(no_args_is_help=True, help="Write the estimator as code for another machine.")


@app.callback()
def _targets() -> None:
    """Write the estimator as code for another machine."""


@app.command()
def c(
    device: DeviceName,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="A new or empty folder, or an earlier export.")
    ],
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
    period: Annotated[
        float | None,
        typer.Option(help="Sample period, s; else the log's, else the device file's."),
    ] = None,
    log: Annotated[
        Path | None, typer.Option(help="Log for the test vector; else one is made up.")
    ] = None,
    json: Json = False,
) -> int:
    """Write C99 without allocation, and a test that compares it with Python bit for bit.

    `make -C FOLDER test` runs the test.
    """
    from rotatum.cli.estimate import names
    from rotatum.cli.places import check_folder
    from rotatum.cli.printing import print_json
    from rotatum.cli.progress import progress

    check_folder(output)

    from rotatum.cli.vector import check_side, group_of, holds_of, period_of, records, zeros_of
    from rotatum.estimators import Estimator
    from rotatum.export import export_c
    from rotatum.logs import open_log
    from rotatum.models import load_device

    robot = load_device(device).only(joint)
    check_side(robot, side)
    opened = open_log(log, robot, inertial=False) if log is not None else None
    with progress("exporting") as shown:
        loop = Estimator(
            robot,
            period=period_of(robot, period, opened),
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
            holds=holds_of(robot, opened),
            zeros=zeros_of(robot, opened),
        )
        group = group_of(loop)
        shown(0, None)
        written = export_c(
            group.bank.stage,
            group.bank.params,
            output,
            inputs=records(loop, group, opened),
            joints=[prepared.joint.name for prepared in group.prepared],
        )
    if json:
        print_json(
            {
                "directory": str(written.directory),
                "files": list(written.files),
                "samples": written.samples,
                "joints": list(written.joints),
            }
        )
    else:
        print(f"{written.directory}: {', '.join(written.files)}")
        print(f"{written.samples:,} samples of {', '.join(written.joints)} to compare with Python:")
        print(f"  make -C {written.directory} test")
    return DONE
