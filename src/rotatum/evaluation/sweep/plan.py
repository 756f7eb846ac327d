"""A sweep before it runs: every combination checked, every case named."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rotatum
from rotatum.errors import RotatumError, ScenarioError
from rotatum.estimators.settings import Request, settle
from rotatum.evaluation.sweep.case import Case, cases, combinations
from rotatum.evaluation.sweep.choices import Choices
from rotatum.evaluation.sweep.vary import Vary
from rotatum.evaluation.sweep.work import Build, Job, Scenario

__all__ = ["Plan", "plan_of"]


@dataclass(frozen=True)
class Plan:
    """A checked sweep.

    Args:
        jobs: one per case, in order.
        varied: keys and their values.
        header: all that decides the results, as plain values; another header is another sweep.
    """

    jobs: tuple[Job, ...]
    varied: tuple[Vary, ...]
    header: Mapping[str, Any]

    @property
    def cases(self) -> tuple[Case, ...]:
        """The cases, in order."""
        return tuple(job.case for job in self.jobs)


def plan_of(
    tables: Mapping[str, Any],
    source: str,
    varied: Sequence[Vary] = (),
    *,
    seeds: int = 1,
    choices: Choices | None = None,
    build: Build | None = None,
) -> Plan:
    """Check every combination of a sweep and name its cases.

    Case numbers follow the product of ``varied`` in the order given, its last key changing
    faster, the seed fastest; seed ``k`` is the combination's own plus ``k``.

    Args:
        tables: of the scenario's file.
        source: where they came from; paths in them are relative to it.
        varied: keys of the scenario and their values.
        seeds: simulations per combination.
        choices: settings of the estimate, before those of the scenario.
        build: makes a scenario of tables and source; ``None``: ``scenario_from_tables``.

    Raises:
        ScenarioError: a combination that is no scenario, a key that is given twice, no seed.
        MethodError: settings of the estimate that fit no combination.
    """
    if build is None:
        from rotatum.simulation.scenario import scenario_from_tables

        build = scenario_from_tables
    choices = choices or Choices()
    _check(varied, seeds, choices)
    base = build(tables, source)
    scenarios = [base.with_values(values) for values in combinations(varied)]
    devices = [scenario.device for scenario in scenarios]
    _check_choices(scenarios, choices)
    named = cases(varied, [scenario.seed for scenario in scenarios], seeds)
    texts = [*_texts(tables), *(text for vary in varied for text in _texts(vary.values))]
    header = {
        "rotatum": rotatum.__version__,
        "scenario": dict(tables),
        "files": _digests([*texts, *(device.source for device in devices)], source),
        "vary": {vary.key: list(vary.values) for vary in varied},
        "seeds": seeds,
        "estimate": {k: list(v) if k == "fit" else v for k, v in choices.chosen().items()},
    }
    version = rotatum.__version__
    jobs = (Job(case, build, dict(tables), source, choices, version) for case in named)
    return Plan(tuple(jobs), tuple(varied), header)


def _check(varied: Sequence[Vary], seeds: int, choices: Choices) -> None:
    if seeds < 1:
        raise ScenarioError("a sweep needs a seed", where="--seeds", value=seeds, allowed="1, 2 ..")
    keys = [vary.key for vary in varied]
    for place, key in enumerate(keys):
        where = f"--vary {key}"
        if key == "seed":
            hint = "Give --seeds N: the scenario's own seed and those after it."
            raise ScenarioError("seeds are not varied like this", where=where, hint=hint)
        if key in keys[:place]:
            hint = "Give its values in one list."
            raise ScenarioError("the key is varied twice", where=where, hint=hint)
        table, _, name = key.partition(".")
        if table == "estimate" and name in choices.chosen():
            what = f"is varied, but --{name} sets it for all cases"
            raise ScenarioError(what, where=where, hint="Leave one of the two out.")


def _check_choices(scenarios: Sequence[Scenario], choices: Choices) -> None:
    """Raise what the first combination's settings lack if none of them can be estimated.

    Some that cannot are results of the sweep: refused.
    """
    errors: list[RotatumError] = []
    for scenario in scenarios:
        told = choices.over(scenario.estimate)
        asked = Request(
            method=told.method,
            side=told.side,
            torque=told.torque,
            cutoff=told.cutoff,
            window=told.window,
            order=told.order,
            stride=told.stride,
            fit=told.fit,
            forgetting=told.forgetting,
            solver=told.solver,
            shrinkage=told.shrinkage,
            selective=told.selective,
        )
        try:
            for joint in scenario.device.joints:
                period = scenario.log_period or scenario.period
                settle(joint, scenario.device, period, asked)
        except RotatumError as error:
            errors.append(error)
        else:
            return
    raise errors[0]


def _texts(value: Any) -> Iterator[str]:
    """Give every text in tables and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from _texts(inner)
    elif isinstance(value, Sequence):
        for inner in value:
            yield from _texts(inner)


def _digests(texts: Sequence[str], source: str) -> dict[str, str]:
    """Return the SHA-256 of every file that the texts name, beside the scenario or as they are."""
    found: dict[str, str] = {}
    for text in dict.fromkeys(texts):
        for path in (Path(source).parent / text, Path(text)):
            if _is_file(path):
                found[text] = hashlib.sha256(path.read_bytes()).hexdigest()
                break
    return found


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a text too long for a name, or with a zero in it
        return False
