"""The command line as a user meets it, each verb in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks import large, scenario
from benchmarks.table import Figure
from benchmarks.timing import say
from rotatum.logs import TableWriter

PROGRAM = (sys.executable, "-c", "import sys; from rotatum.cli import main; sys.exit(main())")
PEAK = Path(__file__).with_name("peak.py")


def _measured(*arguments: str) -> dict[str, float]:
    """Return what ``benchmarks.peak`` does of ``rotatum ARGUMENTS``."""
    command = [sys.executable, str(PEAK), *PROGRAM, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    found = json.loads(done.stdout)
    if found["code"] != 0:
        say(done.stderr.strip())
    return {key: float(value) for key, value in found.items()}


def _figure(what: str, target: float, repetitions: int, *arguments: str) -> Figure:
    runs = [_measured(*arguments) for _ in range(repetitions)]
    codes = {run["code"] for run in runs}
    if codes != {0.0}:
        return Figure(what, None, "s", target, note=f"exit codes {sorted(map(int, codes))}")
    best = min(run["seconds"] for run in runs)
    cpu = min(run["cpu"] for run in runs)
    note = f"best of {repetitions}; processor time {cpu:.2f} s"
    return Figure(what, best, "s", target, note=note)


def figures(directory: Path) -> list[Figure]:
    """Measure ``--help`` and a warm ``estimate`` with its report."""
    say("timing rotatum --help ...")
    found = [_figure("rotatum --help", 0.6, 7, "--help")]
    device, log = directory / "arm.toml", directory / "log.csv"
    device.write_text(scenario.device_text())
    with TableWriter(log) as table:
        columns = scenario.channels()
        table.write({"time": columns.pop("time")} | {f"arm.{k}": v for k, v in columns.items()})
    estimate = ("estimate", str(log), "--device", str(device))
    say("timing rotatum estimate ...")
    _measured(*estimate)  # compiles the stage if nothing has yet
    what = "rotatum estimate, 50,000 samples from CSV"
    return [
        *found,
        _figure(what, 4.0, 3, *estimate),
        _figure(f"{what}, with report", 4.0, 3, *estimate, "--report", str(directory / "r.html")),
    ]


def large_figures(directory: Path) -> list[Figure]:
    """Measure seconds and peak memory of ``estimate`` on 25 million joint-samples in Parquet."""
    device, log = directory / "large.toml", directory / "large.parquet"
    device.write_text(scenario.device_text(large.JOINTS, hold="sampled"))
    say("writing 25 million joint-samples ...")
    with TableWriter(log) as table:
        for columns in _told(large.pieces()):
            table.write(columns)
    arguments = ("estimate", str(log), "--device", str(device))
    say("timing rotatum estimate on them ...")
    run = _measured(*arguments)
    what = f"{large.JOINTS * large.ROWS / 1e6:.1f} million joint-samples from Parquet"
    if run["code"] != 0:
        note = f"exit code {int(run['code'])}"
        return [Figure(what, None, "s", 60.0, note=note)]
    note = f"processor time {run['cpu']:.0f} s; {log.stat().st_size / 1e6:.0f} MB on disk"
    return [
        Figure(what, run["seconds"], "s", 60.0, note=note),
        Figure(f"{what}, peak memory", run["megabytes"], "MB", 1000.0),
    ]


def _told(
    pieces: Iterator[dict[str, NDArray[np.float64]]],
) -> Iterator[dict[str, NDArray[np.float64]]]:
    for columns in pieces:
        yield columns
        say(f"  {columns['time'][-1]:.0f} s of signals")
