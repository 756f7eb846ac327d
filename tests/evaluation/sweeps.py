"""Sweeps that the tests share: of a scenario that costs milliseconds, in a process to kill.

The scenario stands in for one of a file: a linear joint with known truth and coarse encoders,
and troubles on demand: some for every third seed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rotatum.errors import ScenarioError, SimulationError
from rotatum.evaluation.sweep import TIMINGS, Choices, Plan, parse_vary, plan_of, sweep
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.simulation import Sensors, multisine, simulate_joint
from tests.report.scenes import small_device

TABLES = {
    "name": "small",
    "seed": 7,
    "seconds": 0.5,
    "period": 1e-3,
    "encoders": 65536.0,
    "trouble": "none",
    "process": 0,  # the one that does not die
    "device": "",
    "estimate": {"method": "weak", "cutoff": 300.0},
}


@dataclass(frozen=True)
class Settings:
    """The scenario's [estimate]; a setting may be absent."""

    method: str | None = None
    cutoff: float | None = None
    fit: list[str] | None = None


@dataclass(frozen=True)
class Small:
    """A scenario of one joint."""

    tables: Mapping[str, Any]
    source: str

    @property
    def seed(self) -> int:
        return int(self.tables["seed"])

    @property
    def period(self) -> float:
        return float(self.tables["period"])

    log_period = None

    @property
    def device(self) -> Device:
        return small_device()

    @property
    def estimate(self) -> Settings:
        return Settings(**self.tables["estimate"])

    def with_values(self, values: Mapping[str, Any], /) -> Small:
        tables = {**self.tables, "estimate": dict(self.tables["estimate"])}
        for key, value in values.items():
            table, _, name = key.rpartition(".")
            inner = tables["estimate"] if table == "estimate" else tables
            if name not in inner and table != "estimate":
                raise ScenarioError("unknown key", where=self.source, value=key)
            inner[name] = value
        return replace(self, tables=tables)

    def run(self, seed: int | None = None) -> Log:
        told = self.tables
        seed = self.seed if seed is None else seed
        if seed % 3 == 1:
            if told["trouble"] == "stop":
                raise SimulationError("the spring left its range", value=seed)
            if told["trouble"] == "crash":
                raise ZeroDivisionError("nobody thought\nof this")
            if told["trouble"] == "memory":
                raise MemoryError
        if told["trouble"] == "die" and os.getpid() != told["process"]:
            os._exit(1)
        return simulate_joint(
            self.device.joints[0],
            seconds=told["seconds"],
            period=told["period"],
            drives={"tau": multisine(rms=4.0, low=2.0, high=20.0, count=5, seed=seed)},
            sensors=Sensors(counts={"q": told["encoders"]}, noise={"tau": 0.05}),
            seed=seed,
        )


def small(tables: Mapping[str, Any], source: str) -> Small:
    """Make the scenario, as ``scenario_from_tables`` would."""
    return Small(tables, source)


def plan(*varied: str, seeds: int = 1, choices: Choices | None = None, **changed: object) -> Plan:
    """Plan a sweep of the small scenario with some of its tables changed."""
    return plan_of(
        {**TABLES, **changed},
        "small.toml",
        [parse_vary(text) for text in varied],
        seeds=seeds,
        choices=choices,
        build=small,
    )


def without_timings(table: Mapping[str, Sequence[Any]]) -> dict[str, list[str]]:
    """Return what two runs of a sweep must share, as texts that tell every double from another."""
    return {name: [*map(repr, values)] for name, values in table.items() if name not in TIMINGS}


def many() -> Plan:
    """200 cases, some of which stop."""
    return plan("encoders=4096.0,65536.0", seeds=100, trouble="stop")


def main(arguments: Sequence[str]) -> None:
    """Run the 200 cases in this process: what a test starts, to kill it."""
    output, workers = arguments

    def say(done: int, failures: int, expected: int) -> None:
        print(done, failures, expected, flush=True)

    sweep(many(), Path(output), workers=int(workers), progress=say)


if __name__ == "__main__":
    main(sys.argv[1:])
