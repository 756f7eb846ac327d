"""`rotatum characterise`: an elastic law fitted to a torque sensor over stiffness presets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import DeviceName, Joints, Json

if TYPE_CHECKING:
    from rotatum.evaluation.statics.result import Characterisation

__all__ = ["characterise"]


def characterise(
    log: Annotated[
        Path, typer.Argument(help="CSV, NPZ, MAT, HDF5 or Parquet.", show_default=False)
    ],
    device: DeviceName,
    law: Annotated[str, typer.Option(help="Elastic law to fit, any but table.")] = "sinh",
    tied: Annotated[
        bool,
        typer.Option("--tied", help="One set of constants for both transmissions of a joint."),
    ] = False,
    fit: Annotated[
        str | None,
        typer.Option(
            help="Fitted beside the constants, with commas: offset (of the sensor), zero (of the "
            "deflection); or none. Else the offset, and the zero of a single spring whose file "
            "gives no number."
        ),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(help="A constant that is known; again for more.", metavar="NAME=VALUE"),
    ] = None,
    terms: Annotated[int, typer.Option(help="Coefficients of a polynomial law.")] = 3,
    max_speed: Annotated[
        float | None,
        typer.Option(
            help="Leave out samples whose link or motor is faster, rad/s; else four times the "
            "median."
        ),
    ] = None,
    floor: Annotated[
        float | None,
        typer.Option(
            help="Leave torques below out of the relative error, N m; else three deviations of "
            "the sensor's noise."
        ),
    ] = None,
    joint: Joints = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The device file with the fitted constants, .toml."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="One HTML page with the fit over the data.")
    ] = None,
    json: Json = False,
) -> int:
    """Fit an elastic law to a torque sensor, quasi-statically, over stiffness presets.

    Prints constants with their intervals, the relative rms error c of each preset, and what the
    data cannot tell. Exit code 0: every constant is told; 1: some cannot be (everything is printed
    all the same, and no device file is written); 2: bad input.
    """
    from rotatum.cli.estimate import names
    from rotatum.cli.places import check_places
    from rotatum.cli.printing import print_json

    check_places((output, report), inputs=(log, Path(device)))
    fixed = dict(_constant(text) for text in fix or ())

    from rotatum import evaluation
    from rotatum.logs import open_log
    from rotatum.models import load_device

    robot = load_device(device)
    found = evaluation.characterise(
        open_log(log, robot, inertial=False),
        robot,
        law=law,
        tied=tied,
        fit=names(fit),
        fixed=fixed,
        terms=terms,
        max_speed=max_speed,
        floor=floor,
        joints=joint or None,
    )
    for warning in found.warnings:
        say(f"warning: {warning}")
    if report is not None:
        from rotatum.report import write_characterisation

        write_characterisation(found, report)
    if output is not None and found.answered:
        found.write(output)
    elif output is not None:
        say(f"{output} is not written: the data do not tell every constant")
    if json:
        print_json(found.to_json())
    else:
        _print(found)
    return DONE if found.answered else NO_ANSWER


def _constant(text: str) -> tuple[str, float]:
    """Split NAME=VALUE."""
    from rotatum.errors import MethodError

    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        what = "must be the name of a constant and a number"
        raise MethodError(what, where="--fix", value=text, allowed="NAME=VALUE") from None


def _print(found: Characterisation) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of
    from rotatum.report.statics_lines import (
        CONSTANTS,
        PRESETS,
        constant_rows,
        preset_rows,
        sentences,
    )

    one = len(found.joints) == 1
    console = stdout()
    title = f"{found.device.name}: law {found.law}" + (", tied" if found.tied else "")
    for head, rows, title_of, right in (
        (CONSTANTS, constant_rows(found), title, (2,)),
        (PRESETS, preset_rows(found), None, tuple(range(1, len(PRESETS)))),
    ):
        skip = 1 if one else 0
        numbers = tuple(place - skip for place in right)
        table = table_of(*head[skip:], title=title_of, numbers=numbers)
        for row in rows:
            table.add_row(*row[skip:])
        console.print(table)
    for joint in found.joints.values():
        for sentence in sentences(joint):
            console.print(f"{joint.name}: {sentence}")
