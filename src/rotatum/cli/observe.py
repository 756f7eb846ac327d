"""`rotatum observe`: the full state of every joint over a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import DeviceName, Json

__all__ = ["observe"]


def observe(
    log: Annotated[
        Path, typer.Argument(help="CSV, NPZ, MAT, HDF5 or Parquet.", show_default=False)
    ],
    device: DeviceName,
    frequency: Annotated[
        float | None,
        typer.Option(help="Of the observer's poles, rad/s; else 250, or as fast as samples allow."),
    ] = None,
    damping: Annotated[float, typer.Option(help="Of the observer's poles.")] = 0.8,
    gyro: Annotated[
        float | None,
        typer.Option(help="Gain of the gyroscopes, 1/s; 0: not used; else half the frequency."),
    ] = None,
    accelerations: Annotated[
        str | None,
        typer.Option(help="accelerometers of the arm, or joints: a channel acc of each."),
    ] = None,
    calibrate: Annotated[
        bool,
        typer.Option(
            "--calibrate",
            help="First find bias, misalignment and delay of each accelerometer in this log, and "
            "take them off.",
        ),
    ] = False,
    start: Annotated[
        float | None,
        typer.Option(
            "--from", help="Score from this many seconds into the log; else once settled."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Every sample's state: .csv, .npz or .parquet."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="One HTML page with every joint's state in time.")
    ] = None,
    json: Json = False,
) -> int:
    """Observe positions and velocities of links and motors, beyond the elasticity.

    From motor positions, motor torques and the links' accelerations; nothing of the links' dynamics
    is needed. Exit code 0: the sensors told some link's acceleration; 1: none, or never (everything
    is printed all the same); 2: bad input.
    """
    from rotatum.cli.places import check_places
    from rotatum.cli.printing import print_json, stdout
    from rotatum.cli.progress import progress

    check_places((output, report), inputs=(log, Path(device)))

    from rotatum import evaluation
    from rotatum.logs import open_log, read_log
    from rotatum.models import load_device

    robot = load_device(device)
    better = None
    if calibrate:
        better = evaluation.calibrate(read_log(log, robot, true_states=True), robot)
    with progress("observing") as shown:
        found = evaluation.observe(
            better.log if better else open_log(log, robot, true_states=True),
            better.device if better else robot,
            frequency=frequency,
            damping=damping,
            gyro=gyro,
            accelerations=accelerations,
            start=start,
            output=output,
            progress=shown,
        )
    for warning in found.warnings:
        say(f"warning: {warning}")
    if report is not None:
        from rotatum.report import write_observation

        write_observation(found, report)
    sensors = better.found if better else {}
    if json:
        told = {name: own.to_json() for name, own in sensors.items()}
        print_json(found.to_json() | ({"calibration": told} if better else {}))
    else:
        from rotatum.cli.observation_table import print_observation

        print_observation(stdout(), found)
        for own in sensors.values():
            stdout().print(own.text())
    return DONE if found.observed else NO_ANSWER
