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
    "Order",
    "Selective",
    "Shrinkage",
    "Side",
    "Solver",
    "Stride",
    "Torque",
    "Window",
]

DeviceName = Annotated[
    str,
    typer.Option("--device", "-d", help="Device file (TOML), or a name of `rotatum devices`."),
]
Method = Annotated[
    str | None,
    typer.Option(help="weak, algebraic, residual or rotatum; else the device file's, else weak."),
]
Side = Annotated[
    str | None,
    typer.Option(
        help="Side of the torque balance: motor, or link, which reads no torque (weak, rotatum); "
        "else the device file's, else motor, of rotatum link."
    ),
]
Torque = Annotated[
    str | None,
    typer.Option(help="estimated (from the motor), sensor, or model (the device's own law)."),
]
Cutoff = Annotated[
    float | None,
    typer.Option(
        help="Bandwidth of the low-pass rows go through, rad/s (rotatum: of its observer, inf is "
        "deadbeat); or"
    ),
]
Window = Annotated[
    float | None,
    typer.Option(
        help="seconds that a row looks back, through a window in place of the low-pass (weak and "
        "algebraic)."
    ),
]
Order = Annotated[
    int | None,
    typer.Option(
        help="Poles of the low-pass, 2 or 3 (else 2, on the link side 3); power of the window, "
        "2 to 5 (else 3); samples by which the observer of rotatum is late."
    ),
]
Stride = Annotated[
    int | None,
    typer.Option(help="Samples from one row of a window to the next; else a tenth of it."),
]
Fit = Annotated[
    str | None,
    typer.Option(
        help="Quantities fitted beside the stiffness, with commas; or none. Motor side: inertia, "
        "damping, coulomb, skew, transmission_damping, offset. Link side: link_damping, "
        "link_coulomb, gravity_torque (of an arm payload), skew, transmission_damping, offset."
    ),
]
Forgetting = Annotated[
    float | None, typer.Option(help="Weight of a row relative to the next one, 0.998 to 1.")
]
Solver = Annotated[str | None, typer.Option(help="ud, covariance or continuous.")]
Shrinkage = Annotated[
    bool | None,
    typer.Option(
        help="Shrink high orders of the law as far as the data do not ask for them; else the "
        "device file's, else yes with solver ud."
    ),
]
Selective = Annotated[
    float | None,
    typer.Option(
        help="Learn nothing while the link is slower than this, rad/s: static friction, "
        "co-contraction; else the device file's, else 0."
    ),
]
Joints = Annotated[
    list[str] | None,
    typer.Option(help="Only this joint; give it again for more.", metavar="NAME"),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")]
