"""The program: its verbs, `--version`, and nothing that takes time to import."""

from __future__ import annotations

from typing import Annotated

import typer

from rotatum.cli import (
    characterise,
    compare,
    demo,
    devices,
    estimate,
    export,
    observe,
    reproduce,
    simulate,
    sweep,
)
from rotatum.cli.failures import Verbs

__all__ = ["app", "main"]

app = typer.Typer(
    name="rotatum",
    cls=Verbs,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the program; the exit code is 0 done, 1 the data cannot answer, 2 bad input."""
    app(prog_name="rotatum")


def _version(asked: bool) -> None:
    if asked:
        from rotatum import __version__

        typer.echo(f"rotatum {__version__}")
        raise typer.Exit


@app.callback()
def _program(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Stiffness of elastic robot joints, with its standard deviation and a verdict.

    Results go to standard output, progress and warnings to standard error.
    Exit codes: 0 done, 1 the data cannot answer, 2 bad input.
    """


app.command("estimate")(estimate.estimate)
app.command("compare")(compare.compare)
app.command("characterise")(characterise.characterise)
app.command("observe")(observe.observe)
app.command("demo")(demo.demo)
app.command("simulate")(simulate.simulate)
app.command("sweep")(sweep.sweep)
app.command("devices")(devices.devices)
app.command("reproduce")(reproduce.reproduce)
app.add_typer(export.app, name="export")
