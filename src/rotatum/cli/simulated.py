"""What `rotatum simulate` does and says: the run, its two files, its summary."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

if TYPE_CHECKING:
    from rich.console import Console

    from rotatum.logs import Log
    from rotatum.simulation.scenario import Scenario

__all__ = ["Simulated", "device_place", "plain", "print_simulated", "ran", "stopped_place", "write"]

_ENDINGS = (".csv.gz", ".csv", ".tsv", ".npz", ".parquet")


class Simulated(NamedTuple):
    """A simulation that came to its end.

    Parameters
    ----------
    log : with its truth.
    speed : simulated seconds in a second of the clock, without compilation.
    """

    log: Log
    speed: float


def ran(scenario: Scenario) -> Simulated:
    """Simulate under a progress bar.

    Parameters
    ----------
    scenario : as it is.

    Raises
    ------
    RotatumError as `Scenario.run` does.
    """
    from rotatum.cli.progress import progress

    with progress("simulating") as shown:
        _compile(scenario)
        began = time.perf_counter()
        log = scenario.run(progress=shown)
        spent = time.perf_counter() - began
    return Simulated(log, scenario.seconds / spent)


def _compile(scenario: Scenario) -> None:
    """Simulate a few samples, so that compilation does not count as simulation.

    What is wrong with the scenario is said by its own run.
    """
    few = 4 * max(scenario.period, scenario.log_period or 0.0)
    with suppress(RotatumError):
        scenario.with_values({"seconds": few}).run()


def device_place(log: Path) -> Path:
    """Return where the device file of a log is written.

    >>> device_place(Path("run.csv.gz")).name
    'run.toml'
    """
    return log.with_name(f"{_stem(log)[0]}.toml")


def stopped_place(log: Path, ran: Log) -> Path:
    """Return where what was simulated of a motion that stopped is written."""
    stem, ending = _stem(log)
    return log.with_name(f"{stem}.stopped-at-{float(ran.time[-1]):.3f}s{ending}")


def write(scenario: Scenario, log: Log, place: Path) -> None:
    """Write a log, and the device file that reads it."""
    from rotatum.logs import beside, write_table

    write_table(place, log.columns())
    with beside(device_place(place)) as new:
        new.write_text(scenario.device_text(), encoding="utf-8")


def plain(scenario: Scenario, done: Simulated, place: Path) -> dict[str, Any]:
    """Return what was simulated as JSON has it."""
    log = done.log
    return {
        "scenario": scenario.name,
        "source": scenario.source,
        "log": str(place),
        "device": str(device_place(place)),
        "seed": scenario.seed,
        "samples": log.samples,
        "seconds": scenario.seconds,
        "period": log.period,
        "times_real_time": float(f"{done.speed:.3g}"),
        "joints": {
            name: {
                "deflection": [list(span) for span in _deflections(channels)],
                "stiffness": list(_span(channels["stiffness_true"])),
            }
            for name, channels in log.joints.items()
        },
        "estimate": scenario.estimate.model_dump(exclude_none=True),
        "warnings": list(log.warnings),
    }


def print_simulated(console: Console, scenario: Scenario, done: Simulated) -> None:
    """Print a table: joint, deflections, stiffness.

    Parameters
    ----------
    console : standard output.
    scenario, done : what was simulated.
    """
    from rotatum.cli.tables import table_of

    log = done.log
    title = (
        f"{scenario.name}: seed {scenario.seed}; {log.samples:,} samples, "
        f"{scenario.seconds:.4g} s, {done.speed:.3g} times real time"
    )
    table = table_of("joint", "deflection rad", "true stiffness N m/rad", title=title)
    for name, channels in log.joints.items():
        spans = [_words(*span) for span in _deflections(channels)]
        table.add_row(name, "; ".join(spans), _words(*_span(channels["stiffness_true"])))
    console.print(table)


def _deflections(channels: Mapping[str, NDArray[np.float64]]) -> list[tuple[float, float]]:
    """Return lowest and highest measured deflection of each transmission [rad]."""
    motors = [role for role in ("theta", "theta1", "theta2") if role in channels]
    return [_span(channels["q"] - channels[role]) for role in motors]


def _span(values: NDArray[np.float64]) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)


def _words(low: float, high: float) -> str:
    return f"{low:.4g} to {high:.4g}"


def _stem(log: Path) -> tuple[str, str]:
    name = log.name
    ending = next((e for e in _ENDINGS if name.lower().endswith(e)), log.suffix)
    return name[: len(name) - len(ending)] if ending else name, name[len(name) - len(ending) :]
