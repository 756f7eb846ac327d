"""`rotatum simulate`: a log with known truth, and the device file that reads it."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rotatum.cli.failures import BAD_INPUT, DONE, say
from rotatum.cli.options import Json

if TYPE_CHECKING:
    from rotatum.cli.simulated import Simulated
    from rotatum.simulation.scenario import Scenario

__all__ = ["settings", "simulate"]


def simulate(
    scenario: Annotated[
        str | None,
        typer.Argument(
            help="Scenario file (TOML) or ready scenario; left out: lists the ready ones.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="The log: .csv, .npz or .parquet. Its device file is written beside it.",
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Of all random faults and drives; else the scenario's.")
    ] = None,
    seconds: Annotated[float | None, typer.Option(help="Duration, in place of its own.")] = None,
    change: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="Another value, such as sensors.encoders.link=1024; give it again for more.",
            metavar="KEY=VALUE",
        ),
    ] = None,
    show: Annotated[
        bool, typer.Option("--show", help="Print the scenario's text instead.")
    ] = False,
    json: Json = False,
) -> int:
    """Simulate a scenario into a log with known truth.

    Writes the log and, beside it, the device file that reads it (the log's name, ending in .toml).
    Without a scenario it lists the ready ones; with --show it prints one, to be copied and changed.
    A motion that leaves a spring's range or runs away stops there: what was simulated is written
    under a name that says so, and the exit code is 2.
    """
    from rotatum.cli.places import check_places
    from rotatum.errors import OutputError, SimulationError

    if scenario is None:
        return _list(json)
    if show:
        from rotatum.simulation.scenario import scenario_text

        print(scenario_text(scenario)[0], end="")
        return DONE
    if output is None:
        what = (
            "a simulation needs a file for its log: --output LOG, or --show to print the scenario"
        )
        raise OutputError(what)

    from rotatum.cli.simulated import device_place, ran, stopped_place, write
    from rotatum.logs import Log, TableWriter

    TableWriter(output)  # says now, not after the work, whether it knows the ending
    device = device_place(output)
    check_places((output, device), inputs=(Path(scenario),))
    chosen = _chosen(scenario, seed, seconds, change or [])
    try:
        done = ran(chosen)
    except SimulationError as error:
        if not isinstance(error.log, Log):
            raise
        place = stopped_place(output, error.log)
        write(chosen, error.log, place)
        say(f"error: {error}")
        say(f"what was simulated until then: {place}, {device_place(place)}")
        return BAD_INPUT
    write(chosen, done.log, output)
    _tell(chosen, done, output, json)
    return DONE


def settings(texts: list[str]) -> dict[str, Any]:
    """Read KEY=VALUE; a value that is not TOML is a text.

    Parameters
    ----------
    texts : as typed.

    Raises
    ------
    ScenarioError for one without "=".

    >>> settings(["seconds=5", "device=awas", "sensors.counts={}"])
    {'seconds': 5, 'device': 'awas', 'sensors.counts': {}}
    """
    from rotatum.errors import ScenarioError

    found: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise ScenarioError("must be KEY=VALUE", where="--set", value=text)
        try:
            found[key.strip()] = tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            found[key.strip()] = value.strip()
    return found


def _chosen(scenario: str, seed: int | None, seconds: float | None, change: list[str]) -> Scenario:
    """Load the scenario, with what the command line changes."""
    from rotatum.simulation.scenario import load_scenario

    values = settings(change)
    values |= {} if seed is None else {"seed": seed}
    values |= {} if seconds is None else {"seconds": seconds}
    loaded = load_scenario(scenario)
    return loaded.with_values(values) if values else loaded


def _list(json: bool) -> int:
    """List the ready scenarios in their groups."""
    from rotatum.cli.printing import print_json, stdout
    from rotatum.cli.tables import table_of
    from rotatum.simulation.scenario import ready_abouts

    abouts = ready_abouts()
    if json:
        print_json([{"name": name, "about": about} for name, about in abouts.items()])
        return DONE
    console = stdout()
    for group in dict.fromkeys(name.partition("/")[0] for name in abouts):
        table = table_of(group, "")
        for name, about in abouts.items():
            if name.partition("/")[0] == group:
                table.add_row(name, about)
        console.print(table)
    console.print("rotatum simulate NAME -o LOG.csv simulates one; --show prints it for a copy.")
    return DONE


def _tell(scenario: Scenario, done: Simulated, output: Path, json: bool) -> None:
    """Print what was simulated."""
    from rotatum.cli.printing import print_json, stdout
    from rotatum.cli.simulated import device_place, plain, print_simulated

    for warning in done.log.warnings:
        say(f"warning: {warning}")
    if json:
        print_json(plain(scenario, done, output))
        return
    print_simulated(stdout(), scenario, done)
    told = scenario.estimate.options()
    command = ["rotatum estimate", str(output), "--device", str(device_place(output)), *told]
    print(f"\nThe log with its truth: {output}\nTo estimate it:\n  {' '.join(command)}")
