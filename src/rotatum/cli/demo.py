"""`rotatum demo`: a log with known truth, both methods, a table, a report to open."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say

if TYPE_CHECKING:
    from rotatum.evaluation import Estimate

__all__ = ["demo"]

_METHODS = ("weak", "residual")
_SCORED_FROM = 5.0  # seconds; every method on the same samples, also one that never converges


def demo(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for log, device file and report.")
    ] = Path("rotatum-demo"),
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object: method to its estimate.")
    ] = False,
) -> int:
    """Simulate a joint with known truth and estimate it with every method.

    Writes the log, the device file and a report, and prints truth and estimates.
    """
    from rotatum.cli.places import check_folder
    from rotatum.cli.printing import print_json

    check_folder(output)
    say("simulating a series-elastic joint: 20 s at 1 kHz")
    log, device, report = _simulated(output)
    found = {method: _estimate(log, device, method) for method in _METHODS}
    for warning in dict.fromkeys(w for estimate in found.values() for w in estimate.warnings):
        say(f"warning: {warning}")
    best = found[_METHODS[0]]
    if json:
        print_json({method: estimate.to_json() for method, estimate in found.items()})
    else:
        _print(found)

    from rotatum.report import write_report

    write_report(best, report)
    if not json:
        _print_next(log, device, report)
    return DONE if best.informative else NO_ANSWER


def _simulated(folder: Path) -> tuple[Path, Path, Path]:
    """Write log and device file; return them and where the report goes."""
    from rotatum.logs import beside, write_table
    from rotatum.simulation.demo import DEVICE, demo_log

    log, device, report = folder / "demo.csv", folder / "demo.toml", folder / "report.html"
    _, simulated = demo_log()
    folder.mkdir(parents=True, exist_ok=True)
    with beside(device) as new:
        new.write_text(DEVICE, encoding="utf-8")
    write_table(log, simulated.columns())
    return log, device, report


def _estimate(log: Path, device: Path, method: str) -> Estimate:
    from rotatum.cli.progress import progress
    from rotatum.evaluation import estimate
    from rotatum.logs import open_log
    from rotatum.models import load_device

    robot = load_device(device)
    with progress(f"estimating with {method}") as shown:
        return estimate(
            open_log(log, robot), robot, method=method, start=_SCORED_FROM, progress=shown
        )


def _print(found: Mapping[str, Estimate]) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of, verdict_text
    from rotatum.report.words import number

    table = table_of(
        "method",
        "truth",
        "estimate",
        "std",
        "MSREP %",
        "truth in interval %",
        "verdict",
        title=f"Stiffness at the last sample, N m/rad, and scores from {_SCORED_FROM:g} s on",
        numbers=(1, 2, 3, 4, 5),
    )
    console = stdout()
    for method, estimate in found.items():
        (joint,) = estimate.joints.values()
        truth = joint.truth or {}
        cells = [
            number(float(joint.truth_records["stiffness"][-1]), 5),
            number(joint.stiffness["final"], 5),
            number(joint.stiffness_std, 2),
            number(truth.get("msrep_percent"), 3),
            number(truth.get("coverage_percent"), 3),
        ]
        table.add_row(method, *cells, verdict_text(joint.verdict))
    console.print(table)
    for method, estimate in found.items():
        for joint in estimate.joints.values():
            console.print(f"{method}: {joint.reason}")


def _print_next(log: Path, device: Path, report: Path) -> None:
    command = ["rotatum", "estimate", str(log), "--device", str(device), "--report", str(report)]
    print(f"\nThe report: {report}")
    print("The same from the files, and how to go on with your own:")
    print(f"  {shlex.join(command)}")
