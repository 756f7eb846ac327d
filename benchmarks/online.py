"""``Bank.update``, the call of a control loop: seven series joints or one of two transmissions.

Seven joints with windows also with and without their rows one after the other.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import scenario
from benchmarks.python_stack import Pipeline
from benchmarks.scenario import Case
from benchmarks.table import Figure
from benchmarks.timing import Runner, interleaved, ratio, say, worst_case
from rotatum.record import Records
from rotatum.runtime import Bank, Stage

JOINTS = 7
SAMPLES = 300
STACK_SAMPLES = 50
WINDOW_SAMPLES = 2000  # a hundred rows of each window, a dozen evaluations


def figures(repetitions: int) -> list[Figure]:
    """Measure updates against an empty compiled call and against padasip with filterpy."""
    case = scenario.series()
    seven = Loop(case, JOINTS)
    stack = Pipeline(case.params[0])
    rows: list[tuple[float, float, float]] = case.inputs[:STACK_SAMPLES, 0][
        ["q", "theta", "tau"]
    ].tolist()
    say("timing Bank.update ...")
    runners = seven.runners() | {"stack": Runner(stack.reset, lambda: _stack(stack, rows))}
    seconds = interleaved(runners, repetitions)
    update = 1e9 * float(np.median(seconds["bank"])) / SAMPLES
    rival = 1e9 * float(np.median(seconds["stack"])) / STACK_SAMPLES
    faster = Figure(
        "padasip + filterpy / Bank.update, a joint-sample",
        rival / (update / JOINTS),
        "x",
        30.0,
        at_least=True,
        note=f"{rival / 1e3:.1f} us / {update / JOINTS:.0f} ns",
    )
    pair = Loop(scenario.pair(), 1)
    return [
        _figure("7 joints", seconds, 3.0),
        faster,
        seven.worst("7 joints"),
        _figure("a pair", interleaved(pair.runners(), 10 * repetitions), 6.0),
        pair.worst("a pair"),
        *_staggered(),
    ]


def _staggered() -> list[Figure]:
    """Measure the worst update of seven joints with windows, rows together and one by one."""
    say("timing seven windows ...")
    case = scenario.window8()
    apart = np.repeat(case.params, JOINTS)
    operator = apart["inner"]["rows"]["operator"]
    operator["phase"] = np.arange(JOINTS) * operator["stride"][0] // JOINTS
    together = Loop(case, JOINTS, WINDOW_SAMPLES).worst("7 windows together")
    staggered = Loop(case, JOINTS, WINDOW_SAMPLES, apart).worst("7 windows")
    assert staggered.value is not None
    assert together.value is not None
    gained = staggered.value / together.value
    return [staggered, together, Figure("worst update, staggered / together", gained, "x")]


def _figure(what: str, seconds: dict[str, list[float]], target: float) -> Figure:
    median, best = (
        {name: 1e9 * float(choose(seconds[name])) / SAMPLES for name in ("bank", "empty")}
        for choose in (np.median, np.min)
    )
    note = f"{median['bank']:.0f} / {median['empty']:.0f} ns; at their best "
    note += f"{best['bank']:.0f} / {best['empty']:.0f} ns = {best['bank'] / best['empty']:.2f} x"
    what = f"Bank.update, {what} / empty compiled call"
    return Figure(what, ratio(seconds, "bank", "empty"), "x", target, note=note)


class Loop:
    """A control loop's bank and an empty one beside it.

    Args:
        case: what runs.
        joints: how many of it.
        samples: how many of its log.
        params: of each; None: the case's.
    """

    def __init__(
        self, case: Case, joints: int, samples: int = SAMPLES, params: Records | None = None
    ) -> None:
        if params is None:
            params = np.repeat(case.params, joints)
        self.bank, self.empty = Bank(case.stage, params), Bank(_empty(case.stage), params)
        # Rows as a loop has them: taking them out of an array is not what is timed.
        self.u = list(np.repeat(case.inputs[:samples], joints, axis=1))
        self.out = case.stage.output.zeros(joints)

    def runners(self) -> dict[str, Runner]:
        """Return what is timed: ``bank`` and ``empty``."""
        return {
            name: Runner(bank.reset, partial(_updates, bank, self.u, self.out))
            for name, bank in (("bank", self.bank), ("empty", self.empty))
        }

    def worst(self, what: str) -> Figure:
        """Return the figure of the slowest update."""
        worst = worst_case(lambda: _timed(self.bank, self.u, self.out), 20)
        return Figure(f"worst Bank.update, {what}", worst.worst, "ns", note=str(worst))


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
