"""Options that more than one verb takes, each said once."""

from __future__ import annotations

from typing import Annotated

import typer

__all__ = [
    "Cutoff",
    "DeviceName",
    "Fit",
    "Forgetting",
    "Joints",
    "Json",
    "Method",
    "Shrinkage",
    "Solver",
    "Torque",
]

DeviceName = Annotated[
    str,
    typer.Option("--device", "-d", help="Device file (TOML), or a name of `rotatum devices`."),
]
Method = Annotated[
    str | None, typer.Option(help="weak or residual; else the device file's, else weak.")
]
Torque = Annotated[
    str | None,
    typer.Option(help="estimated (from the motor), sensor, or model (the device's own law)."),
]
Cutoff = Annotated[float | None, typer.Option(help="Bandwidth of the rows, rad/s.")]
Fit = Annotated[
    str | None,
    typer.Option(
        help="Quantities fitted beside the stiffness, with commas: inertia, damping, coulomb, "
        "skew, transmission_damping, offset; or none."
    ),
]
Forgetting = Annotated[
    float | None, typer.Option(help="Weight of a row relative to the next one, 0.998 to 1.")
]
Solver = Annotated[str | None, typer.Option(help="ud or covariance.")]
Shrinkage = Annotated[
    bool | None,
    typer.Option(
        help="Shrink high orders of the law as far as the data do not ask for them; else the "
        "device file's, else yes with solver ud."
    ),
]
Joints = Annotated[
    list[str] | None,
    typer.Option(help="Only this joint; give it again for more.", metavar="NAME"),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")]
