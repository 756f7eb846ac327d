"""``python -m benchmarks``: every figure beside its target. Exit code 1 only if results differ."""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks import arm, batch, commands, native, observer, online, scenario, simulation
from benchmarks.table import Figure, as_json, as_text
from benchmarks.timing import say


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmarks asked for and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Speed, as ratios within one run. Progress on standard error. The exit code is "
        "0 whatever the figures, 1 if the C versions and the bank disagree.",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--large", action="store_true", help="also 25 million joint-samples (minutes, 1 GB of disk)"
    )
    parser.add_argument(
        "--only",
        choices=("batch", "observer", "online", "arm", "simulation", "commands"),
        help="only this group of figures",
    )
    parser.add_argument(
        "--repetitions", type=int, default=200, metavar="N", help="turns of short runs (200)"
    )
    options = parser.parse_args(arguments)
    try:
        with tempfile.TemporaryDirectory(prefix="rotatum-benchmarks-") as directory:
            found = _figures(options, Path(directory))
    except batch.Disagreement as error:
        say(f"error: {error}")
        return 1
    about = {
        "machine": platform.machine(),
        "system": platform.system(),
        "python": platform.python_version(),
    }
    print(as_json(found, about) if options.json else as_text(found))
    return 0


def _figures(options: argparse.Namespace, directory: Path) -> list[Figure]:
    only = options.only
    found: list[Figure] = []
    if only in (None, "batch"):
        if native.compiler() is None:
            say("no C compiler: nothing to compare Bank.run with")
        else:
            for case, joint, targets in (
                (scenario.series(), "", batch.FEW),
                (scenario.pair(), "pair: ", batch.FEW),
                (scenario.series8(), "8 columns: ", batch.Targets(1.5)),
                (scenario.window8(), "8 columns, window: ", batch.Targets(2.0)),
            ):
                found += batch.figures(case, joint, directory, options.repetitions, targets)
    if only in (None, "observer"):
        if native.compiler() is None:
            say("no C compiler: nothing to compare the observer with")
        else:
            found += observer.figures(directory, options.repetitions)
    if only in (None, "online"):
        found += online.figures(max(1, options.repetitions // 10))
    if only in (None, "arm"):
        found += arm.figures(directory, max(1, options.repetitions // 10))
    if only in (None, "simulation"):
        found += simulation.figures(directory, max(1, options.repetitions // 20))
    if only in (None, "commands"):
        found += commands.figures(directory)
    if options.large:
        found += commands.large_figures(directory)
    return found


if __name__ == "__main__":
    sys.exit(main())
