"""Times on a machine that also does other things."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Task = Callable[[], None]


class Runner(NamedTuple):
    """What is timed, and what has to happen before each time.

    Args:
        ready: puts everything in its initial state.
        run: is timed.
    """

    ready: Task
    run: Task


def interleaved(runners: Mapping[str, Runner], repetitions: int) -> dict[str, list[float]]:
    """Run all in turn, again and again; return the seconds of each.

    What slows the machine down for a while slows all of them: compare one's time with another's of
    the same turn.
    """
    seconds: dict[str, list[float]] = {name: [] for name in runners}
    for turn in range(-1, repetitions):  # the first turn warms caches and is not counted
        for name, runner in runners.items():
            runner.ready()
            begin = time.perf_counter()
            runner.run()
            spent = time.perf_counter() - begin
            if turn >= 0:
                seconds[name].append(spent)
    return seconds


def ratio(seconds: Mapping[str, list[float]], top: str, bottom: str) -> float:
    """Return the median over the turns of one time over another."""
    return median(a / b for a, b in zip(seconds[top], seconds[bottom], strict=True))


class Worst(NamedTuple):
    """Times per sample, ns.

    Args:
        median: over samples.
        worst: the sample that takes longest, each at its best of several repetitions: what the
            algorithm does, without interruptions by the machine.
        raw: the longest time seen at all.
        due: median over the samples with a row, where not all have one.
    """

    median: float
    worst: float
    raw: float
    due: float | None = None

    def __str__(self) -> str:
        due = "" if self.due is None else f"with a row {self.due:.0f} ns, "
        text = f"median {self.median:.0f} ns, {due}worst {self.worst:.0f} ns"
        return f"{text} ({self.raw:.0f} ns raw)"


def worst_case(
    repeat: Callable[[], NDArray[np.int64]],
    repetitions: int,
    due: NDArray[np.bool_] | None = None,
) -> Worst:
    """Repeat a run that returns ns per sample ``(N,)``; the same samples every time.

    Args:
        repeat: the run.
        repetitions: how often.
        due: ``(N,)`` samples with a row.
    """
    best = repeat()
    raw = int(best.max())
    for _ in range(repetitions - 1):
        times = repeat()
        raw = max(raw, int(times.max()))
        best = np.minimum(best, times)
    clock = clock_cost()
    rows = None if due is None else float(np.median(best[due])) - clock
    return Worst(float(np.median(best)) - clock, float(best.max()) - clock, raw - clock, rows)


def clock_cost() -> float:
    """Return what reading the clock twice takes, ns: half of it is in every time per sample."""
    times = [-time.perf_counter_ns() + time.perf_counter_ns() for _ in range(1000)]
    return float(min(times)) / 2.0


def say(text: str) -> None:
    """Tell how far the benchmarks are."""
    print(text, file=sys.stderr, flush=True)
