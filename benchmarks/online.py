"""``Bank.update``, the call of a control loop: seven joints, one sample."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import scenario
from benchmarks.python_stack import Pipeline
from benchmarks.table import Figure
from benchmarks.timing import Runner, interleaved, ratio, say, worst_case
from rotatum.record import Records
from rotatum.runtime import Bank, Stage

JOINTS = 7
SAMPLES = 300
STACK_SAMPLES = 50


def figures(repetitions: int) -> list[Figure]:
    """Measure updates against an empty compiled call and against padasip with filterpy."""
    case = scenario.case()
    params = np.repeat(case.params, JOINTS)
    bank, empty = Bank(case.stage, params), Bank(_empty(case.stage), params)
    # Rows as a loop has them: taking them out of an array is not what is timed.
    u = list(np.repeat(case.inputs[:SAMPLES], JOINTS, axis=1))
    out = case.stage.output.zeros(JOINTS)
    say("timing Bank.update ...")
    runners = {
        "bank": Runner(bank.reset, lambda: _updates(bank, u, out)),
        "empty": Runner(empty.reset, lambda: _updates(empty, u, out)),
    }
    stack = Pipeline(case.params[0])
    rows: list[tuple[float, float, float]] = case.inputs[:STACK_SAMPLES, 0][
        ["q", "theta", "tau"]
    ].tolist()
    runners["stack"] = Runner(stack.reset, lambda: _stack(stack, rows))
    seconds = interleaved(runners, repetitions)
    each = {name: 1e9 * float(np.median(times)) for name, times in seconds.items()}
    update, nothing = each["bank"] / len(u), each["empty"] / len(u)
    rival = each["stack"] / STACK_SAMPLES
    faster = rival / (update / JOINTS)
    worst = worst_case(lambda: _timed(bank, u, out), 20)
    return [
        Figure(
            "Bank.update, 7 joints / empty compiled call",
            ratio(seconds, "bank", "empty"),
            "x",
            3.0,
            note=f"{update:.0f} / {nothing:.0f} ns",
        ),
        Figure(
            "padasip + filterpy / Bank.update, a joint-sample",
            faster,
            "x",
            30.0,
            at_least=True,
            note=f"{rival / 1e3:.1f} us / {update / JOINTS:.0f} ns",
        ),
        Figure("worst Bank.update, 7 joints", worst.worst, "ns", note=str(worst)),
    ]


def _nothing_init(params: Any, state: Any) -> None:
    pass


def _nothing_step(params: Any, state: Any, u: Any, out: Any) -> None:
    pass


def _empty(stage: Stage) -> Stage:
    return stage._replace(name="empty", init=_nothing_init, step=_nothing_step)


def _updates(bank: Bank, u: list[Records], out: Records) -> None:
    update = bank.update
    for row in u:
        update(row, out)


def _stack(stack: Pipeline, rows: list[tuple[float, float, float]]) -> None:
    for q, theta, tau in rows:
        stack.update(q, theta, tau)


def _timed(bank: Bank, u: list[Records], out: Records) -> NDArray[np.int64]:
    nanoseconds = np.zeros(len(u), np.int64)
    update, clock = bank.update, time.perf_counter_ns
    bank.reset()
    for k, row in enumerate(u):
        begin = clock()
        update(row, out)
        nanoseconds[k] = clock() - begin
    return nanoseconds
