"""A case's work: simulate, estimate, score. The result is plain values, for JSON and pickles."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import rotatum
from rotatum.errors import ExtraError, OutputError, RotatumError, SimulationError
from rotatum.evaluation.run import estimate
from rotatum.evaluation.sweep.case import Case
from rotatum.evaluation.sweep.choices import Choices
from rotatum.evaluation.sweep.cluster import SchedulerError
from rotatum.evaluation.sweep.score import joint_values
from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["FAILED", "OK", "REFUSED", "STOPPED", "Build", "Job", "Scenario", "run_case"]

OK, REFUSED, STOPPED, FAILED = "ok", "refused", "stopped", "failed"

# What another machine, an installed package or more room would change is no result of a case.
_NOT_A_RESULT = (ExtraError, OutputError, OSError, MemoryError, ImportError)


class Scenario(Protocol):
    """What a sweep needs of ``rotatum.simulation.scenario.Scenario``."""

    @property
    def seed(self) -> int:
        """Of its faults and drives."""

    @property
    def device(self) -> Device:
        """What the estimator is told."""

    @property
    def log_period(self) -> float | None:
        """Sample period of its log, s; None: that of its torques."""

    @property
    def period(self) -> float:
        """Period of its torques, s."""

    @property
    def estimate(self) -> object:
        """Settings of the estimate, by the names of ``Choices``."""

    def with_values(self, values: Mapping[str, Any], /) -> Scenario:
        """Return the scenario with these dotted keys."""

    def run(self, seed: int | None = None) -> Log:
        """Simulate."""


Build = Callable[[Mapping[str, Any], str], Scenario]
"""Makes a scenario of the tables of its file and their source; of a module, for other processes."""


@dataclass(frozen=True)
class Job:
    """All a process needs for a case.

    Args:
        case: which.
        build: makes the scenario.
        tables: of the scenario's file, before the case's values.
        source: the file.
        choices: the command line's.
        version: of this package, where the sweep was planned.
    """

    case: Case
    build: Build
    tables: Mapping[str, Any]
    source: str
    choices: Choices
    version: str

    def __str__(self) -> str:
        values = "".join(f", {key} = {value}" for key, value in self.case.values.items())
        return f"case {self.case.number}{values}, seed {self.case.seed}"


def run_case(job: Job) -> dict[str, Any]:
    """Simulate, estimate and score one case; what goes wrong with it is its result.

    Returns:
        ``case``, ``values``, ``seed``, ``status`` (ok, refused by the scenario or the estimator,
        stopped in the simulation, failed for a reason nobody expected), ``message``,
        ``simulate_seconds``, ``estimate_seconds`` (None: not reached) and ``joints``: joint to
        what ``joint_values`` gives, nothing where the status is not ok.

    Raises:
        ExtraError, OutputError, OSError, MemoryError, ImportError: of this machine, not of the
            case, which can be run again.
        SchedulerError: this process has another version of the package.
    """
    if job.version != rotatum.__version__:
        what = f"a worker has rotatum {rotatum.__version__}, the sweep {job.version}"
        raise SchedulerError(what, hint="Install the same version everywhere.")
    case = job.case
    spent: dict[str, float | None] = {"simulate_seconds": None, "estimate_seconds": None}
    joints: dict[str, dict[str, Any]] = {}
    status, message = OK, ""
    try:
        scenario = job.build(job.tables, job.source).with_values(case.values)
        device = scenario.device
        joints = {joint.name: {} for joint in device.joints}
        begin = time.perf_counter()
        log = scenario.run(case.seed)
        spent["simulate_seconds"] = time.perf_counter() - begin
        begin = time.perf_counter()
        joints = _scored(log, device, job.choices.over(scenario.estimate))
        spent["estimate_seconds"] = time.perf_counter() - begin
    except _NOT_A_RESULT:
        raise
    except SimulationError as error:
        status, message = STOPPED, str(error)
    except RotatumError as error:
        status, message = REFUSED, str(error)
    except Exception as error:
        # A night's sweep must not end with the first error nobody thought of.
        status, message = FAILED, f"unexpected {type(error).__name__}: {error}"
    return {
        "case": case.number,
        "values": dict(case.values),
        "seed": case.seed,
        "status": status,
        "message": " ".join(message.split()),
        **spent,
        "joints": joints,
    }


def _scored(log: Log, device: Device, choices: Choices) -> dict[str, dict[str, Any]]:
    found = estimate(
        log,
        device,
        method=choices.method,
        side=choices.side,
        torque=choices.torque,
        cutoff=choices.cutoff,
        window=choices.window,
        order=choices.order,
        stride=choices.stride,
        fit=choices.fit,
        forgetting=choices.forgetting,
        solver=choices.solver,
        shrinkage=choices.shrinkage,
        selective=choices.selective,
        start=choices.start,
    )
    return {name: joint_values(joint, log) for name, joint in found.joints.items()}
