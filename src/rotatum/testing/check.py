"""The contract every stage must pass."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from rotatum.record import Records
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage
from rotatum.testing import endurance as lasting
from rotatum.testing import equality, faults, form, scaling
from rotatum.testing.case import Case, several
from rotatum.testing.report import Clause, Report, judge
from rotatum.testing.signals import random_inputs, random_params

CONTRACT: Mapping[str, Clause] = {
    "is in the exportable subset": form.is_in_subset,
    "is documented": form.is_documented,
    "names its fields": form.names_its_fields,
    "has SI units": form.has_units,
    "prints itself": form.prints_itself,
    "cites known work": form.cites_known_work,
    "interpreted = compiled": equality.interpreted_is_compiled,
    "compiled = C": equality.compiled_is_c,
    "online = batch": equality.online_is_batch,
    "n joints = n times one": equality.joints_are_apart,
    "snapshot restores": equality.snapshot_restores,
    "output is written in full": equality.output_is_whole,
    "inputs and params stay": equality.inputs_stay,
    "recovers from bad samples": faults.recovers,
    "status says why": faults.status_says_why,
    "step allocates nothing": lasting.step_allocates_nothing,
    "update allocates nothing": lasting.update_allocates_nothing,
    "stays finite": lasting.stays_finite,
    "units only scale": scaling.units_only_scale,
}
"""Every clause by the words it is reported in."""

_SAMPLES = 100_000


def check_stage(
    stage: Stage,
    *,
    params: Records | None = None,
    inputs: Records | None = None,
    seed: int = 0,
    settle: int = 5000,
    endurance: int = 10_000_000,
    scale: Mapping[str, float] | None = None,
    references: Collection[str] | None = None,
) -> Report:
    """Run the contract on a stage: whatever is a stage can be composed, compiled and exported.

    Args:
        stage: what to check.
        params: ``(n,)`` records; one joint is made several. Random ones if not given.
        inputs: ``(N, n)`` or, for one joint, ``(N,)`` good samples; 100,000 random ones if not
            given. A field ``time`` is taken for the clock.
        seed: of everything random.
        settle: good samples after a bad one until the stage must have recovered.
        endurance: samples after which everything must still be finite.
        scale: a change of unit, as the exponent of each field that changes:
            ``{"u.tau": 1, "params.inertia": 1, "out.stiffness": 1}`` is N m to another unit.
        references: all citation keys there are; without, keys are not looked up.

    Returns:
        Report: printable; ``skipped`` holds what could not be checked, with the reason.

    Raises:
        AssertionError: a clause does not hold; lists every such clause with details.
        StageError: params or inputs are not the stage's.
    """
    if params is None:
        params = random_params(stage, seed=seed)
    if inputs is None:
        inputs = random_inputs(stage, _SAMPLES, 3 if len(params) == 1 else len(params), seed)
        params = params.repeat(3) if len(params) == 1 else params
    if params.dtype != stage.params.dtype or inputs.dtype != stage.input.dtype:
        raise StageError(f"params or inputs are not the records of {stage.name}")
    params, inputs = several(params, inputs)
    if inputs.ndim != 2 or inputs.shape[1] != len(params) or len(inputs) < 1000:
        raise StageError(f"inputs must be (N, {len(params)}), N >= 1000", value=inputs.shape)
    known = None if references is None else frozenset(references)
    case = Case(stage, params, inputs, seed, settle, endurance, scale, known)
    verdicts = tuple(judge(case, words, clause) for words, clause in CONTRACT.items())
    report = Report(stage.name, verdicts)
    if report.failed:
        failed = "\n".join(map(str, report.failed))
        raise AssertionError(f"stage {stage.name} breaks the contract\n{failed}")
    return report
