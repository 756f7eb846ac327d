"""``Bank.run`` and exported C against C written by hand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks import native
from benchmarks.hand_config import hand_version
from benchmarks.native import NATIVE_FLAGS, SAME_FLAGS, Native
from benchmarks.scenario import Case
from benchmarks.table import Figure
from benchmarks.timing import Runner, Worst, interleaved, ratio, say, worst_case
from rotatum.record import Records
from rotatum.runtime import Bank

TOLERANCE = 1e-9  # relative: rounding of reciprocals and contractions, over 50,000 rows
SLICE = slice(10_000, 12_500)  # of the log: short runs, so that interruptions hit few of them


class Targets(NamedTuple):
    """What ratios to C written by hand should be at most; None: they are published only.

    Args:
        bank: ``Bank.run`` to C for this machine.
        same: exported C to C with the same flags.
        portable: exported C to C for this machine.
        native: both for this machine.
    """

    bank: float
    same: float | None = None
    portable: float | None = None
    native: float | None = None


FEW = Targets(1.5, 1.2, 1.5, 1.5)


class Disagreement(Exception):
    """The hand-written C does not compute what the bank does: ratios would mean nothing."""


def figures(
    case: Case, joint: str, directory: Path, repetitions: int, targets: Targets = FEW
) -> list[Figure]:
    """Measure ratios, medians over turns; raise ``Disagreement`` first if results differ.

    Args:
        case: what runs.
        joint: what the table calls it, ``""``: the usual one.
        directory: for the C.
        repetitions: turns.
        targets: for the ratios.
    """
    say(f"{case.name}: compiling the bank and the C versions ...")
    versions = _versions(case, directory)
    bank = Bank(case.stage, case.params)
    expected = bank.run(case.inputs)
    for name, version in versions.items():
        _check(f"{case.name}, {name}", version, case.inputs, expected)
    say(f"{case.name}: timing Bank.run and C ...")
    seconds = interleaved(_runners(bank, versions, case.inputs), repetitions)
    best = {name: 1e9 * min(times) / (SLICE.stop - SLICE.start) for name, times in seconds.items()}

    def figure(what: str, top: str, bottom: str, target: float | None) -> Figure:
        quiet = best[top] / best[bottom]
        note = f"at their best {best[top]:.0f} / {best[bottom]:.0f} ns a sample = {quiet:.2f} x"
        return Figure(f"{joint}{what}", ratio(seconds, top, bottom), "x", target, note=note)

    found = [
        figure("Bank.run / C by hand, native", "bank", "hand native", targets.bank),
        figure("exported C / C by hand, same flags", "exported same", "hand same", targets.same),
        figure("exported C / C by hand, native", "exported same", "hand native", targets.portable),
        figure(
            "exported C native / C by hand native", "exported native", "hand native", targets.native
        ),
    ]
    say(f"{case.name}: timing every sample in C ...")
    return found + _worst(case, joint, versions, expected)


def _versions(case: Case, directory: Path) -> dict[str, Native]:
    exported = native.exported_code(case.stage, directory)
    flags = {"same": SAME_FLAGS, "native": NATIVE_FLAGS}
    found = {f"hand {k}": hand_version(case, f, directory) for k, f in flags.items()}
    constants = case.params.view(np.uint8)
    return found | {
        f"exported {k}": Native(exported, f, directory, constants) for k, f in flags.items()
    }


def _check(name: str, version: Native, inputs: Records, expected: Records) -> None:
    """Compare the last sample's numbers, and every sample's verdict and status."""
    out = np.zeros(expected.shape, expected.dtype)
    version.start()
    version.run(inputs[:, 0].copy(), out[:, 0])
    for field in ("stiffness", "stiffness_std", "torque", "torque_std", "coefficients"):
        a, b = out[-1, 0][field], expected[-1, 0][field]
        # Coefficients, in normalised coordinates, against the largest: orders that are shrunk to
        # nothing have no digits of their own.
        worst = float(np.max(np.abs(a - b)) / np.max(np.abs(b)))
        if not worst <= TOLERANCE:
            raise Disagreement(f"{field} of {name}: C differs from the bank's by {worst:.2g} of it")
    for field in ("verdict", "status", "rows"):
        count = int(np.count_nonzero(out[field] != expected[field]))
        if count:
            raise Disagreement(f"{field} of {name}: C differs from the bank's at {count} samples")


def _runners(bank: Bank, versions: dict[str, Native], inputs: Records) -> dict[str, Runner]:
    u = np.ascontiguousarray(inputs[SLICE])
    out = bank.stage.output.zeros(*u.shape)
    runners = {"bank": Runner(bank.reset, lambda: _discard(bank.run(u, out)))}
    for name, version in versions.items():
        runners[name] = Runner(version.start, _run(version, u.reshape(-1), out.reshape(-1)))
    return runners


def _discard(out: Any) -> None:
    """Make a task of a function that returns something."""


def _run(version: Native, u: Records, out: Records) -> Callable[[], None]:
    return lambda: version.run(u, out)


def _worst(case: Case, joint: str, versions: dict[str, Native], expected: Records) -> list[Figure]:
    u = case.inputs[:, 0].copy()
    due = np.diff(expected["rows"][:, 0], prepend=0) > 0
    few = due if due.mean() < 0.5 else None
    out = np.zeros(len(u), case.stage.output.dtype)

    def times(version: Native) -> Worst:
        def once() -> NDArray[np.int64]:
            nanoseconds = np.zeros(len(u), np.int64)
            version.start()
            version.run_timed(u, out, nanoseconds)
            return nanoseconds

        return worst_case(once, 10, few)

    found = {name: times(version) for name, version in versions.items() if "native" not in name}
    return [
        Figure(f"{joint}worst sample of {name.split()[0]} C", worst.worst, "ns", note=str(worst))
        for name, worst in found.items()
    ]
