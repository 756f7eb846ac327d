"""Each clause of the contract fails for a stage made to break it, and says how."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from rotatum.record import Field, Layout, Records, integer, number
from rotatum.runtime import jit
from rotatum.runtime.bank import Bank
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage
from rotatum.testing import check_stage, endurance, equality, random_inputs
from rotatum.testing.case import Case
from tests.contracts import broken

PARAMS = Layout("Params", "Constants.", {"a": number("weight of a new sample")})
STATE = Layout("State", "Memory.", {"x": number("filtered", unit="m"), "n": integer("samples")})
INPUT = Layout("Input", "A sample.", {"x": number("signal", unit="m")})
OUTPUT = Layout("Output", "A result.", {"x": number("result", unit="m"), "status": integer("why")})


def stage_of(step: Callable[..., None], **changes: Any) -> Stage:
    return Stage("example", PARAMS, STATE, INPUT, OUTPUT, broken.init, step)._replace(**changes)


def clauses_broken_by(stage: Stage, **options: Any) -> str:
    """Return the message of the check, for a short input and a short run."""
    inputs = random_inputs(stage, 1200, 3)
    options = {"inputs": inputs, "params": params_of(stage), "settle": 200} | options
    with pytest.raises(AssertionError) as caught:
        check_stage(stage, **{"endurance": 4000, **options})
    return str(caught.value)


def params_of(stage: Stage) -> Records:
    params = stage.params.zeros(3)
    params["a"] = [0.1, 0.2, 0.3]
    return params


def test_a_good_stage_passes_and_reports() -> None:
    stage = stage_of(broken.good, cites=("known",))
    scale = {"u.x": 1.0, "out.x": 1.0}
    report = check_stage(stage, scale=scale, references={"known"}, endurance=200_000)
    assert report.failed == ()
    assert report.skipped == () or "compiler" in str(report.skipped)
    assert "passed   interpreted = compiled" in str(report)


@pytest.mark.parametrize(
    ("step", "clause", "detail"),
    [
        (broken.with_power, "is in the exportable subset", "broken.py"),
        (broken.undocumented, "is documented", "undocumented has no docstring"),
        (broken.sticking, "recovers from bad samples", "after x = nan: Output.x not finite"),
        (broken.silent, "status says why", "x = nan changes the output and status stays 0"),
        (broken.raising, "interpreted = compiled", "OverflowError"),
        (broken.partial, "output is written in full", "Output.status at (0, 0)"),
        (broken.writing, "inputs and params stay", "Input.x at (0, 0)"),
        (broken.growing, "stays finite", "Output.x lost after"),
        (broken.with_list, "step allocates nothing", "allocations more"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_clause_fails(step: Callable[..., None], clause: str, detail: str) -> None:
    options = {"endurance": 1_000_000} if step is broken.growing else {}
    message = clauses_broken_by(stage_of(step), **options)
    assert f"failed   {clause}" in message
    assert detail in message


def test_units_names_and_docs_are_checked() -> None:
    odd = {"x": number("signal", unit="Nm"), "größe": number("a total"), "z": number("")}
    message = clauses_broken_by(stage_of(broken.good, input=Layout("Input", "", odd)))
    assert "Input.x: unit 'Nm' is not SI" in message
    assert "Input.größe: no identifier in C" in message
    assert "Input.z has no documentation" in message
    assert "record Input has no docstring" in message
    counted = {"x": INPUT.fields["x"], "n": Field("int", (), "a count", "m")}
    stage = stage_of(broken.good, input=Layout("Input", "A sample.", counted))
    assert "an integer counts or selects" in clauses_broken_by(stage)


def test_an_unknown_citation_and_a_bad_name_fail() -> None:
    stage = stage_of(broken.good, cites=("nobody1900",))
    message = clauses_broken_by(stage, references={"somebody1901"})
    assert "nobody1900 is not in the list" in message
    message = clauses_broken_by(stage_of(broken.good, name="two words"))
    assert "no identifier" in message


def test_a_forgotten_unit_fails() -> None:
    scale = {"u.x": 1.0, "out.x": 1.0}
    message = clauses_broken_by(stage_of(broken.unscaled), scale=scale)
    assert "failed   units only scale" in message
    message = clauses_broken_by(stage_of(broken.good), scale={"u.nothing": 1.0})
    assert "u.nothing" in message


def case_of(step: Callable[..., None]) -> Case:
    stage = stage_of(step)
    inputs = random_inputs(stage, 1200, 3)
    return Case(stage, params_of(stage), inputs, 0, 200, 4000, None, None)


class Twisted(Case):
    """A case whose banks and C are not what they should be."""

    twist: Callable[[Bank], Bank] = staticmethod(lambda bank: bank)

    def bank(self, *, compile: bool = True) -> Bank:
        return type(self).twist(super().bank(compile=compile))

    def run_c(self, inputs: Records) -> tuple[Records, Records]:
        out, state = super().run_c(inputs)
        out["x"][5, 1] = np.nextafter(out["x"][5, 1], 9.0)
        return out, state


def twisted(twist: Callable[[Bank], Bank]) -> Case:
    """Return a case of the good stage whose banks go through ``twist``."""
    plain = case_of(broken.good)
    kind = type("Kind", (Twisted,), {"twist": staticmethod(twist)})
    made: Case = kind(**{name: getattr(plain, name) for name in plain.__dataclass_fields__})
    return made


@pytest.mark.usefixtures("c_compiler")
def test_one_bit_between_compiled_and_c_is_seen() -> None:
    found = list(equality.compiled_is_c(twisted(lambda bank: bank)))
    assert len(found) == 2
    assert found[0].startswith("Output.x at (5, 1): on good samples compiled")


class Forgetful(Bank):
    """Keeps memory outside its state: the number of calls."""

    calls = 0

    def run(self, u: Records, out: Records | None = None) -> Records:
        done = super().run(u, out)
        self.calls += 1
        done["x"] += self.calls - 1
        return done


class Leaking(Bank):
    """Lets joint 0 see joint 1."""

    def run(self, u: Records, out: Records | None = None) -> Records:
        done = super().run(u, out)
        if len(self) > 1:
            done["x"][:, 0] += done["x"][:, 1]
        return done


class Hoarding(Bank):
    """Keeps every output of ``update``."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.kept: list[Records] = []

    def update(self, u: Records, out: Records | None = None) -> Records:
        done = super().update(u, out)
        self.kept.append(done.copy())
        return done


@pytest.mark.parametrize(
    ("kind", "clause"),
    [
        (Forgetful, equality.online_is_batch),
        (Forgetful, equality.snapshot_restores),
        (Leaking, equality.joints_are_apart),
        (Hoarding, endurance.update_allocates_nothing),
    ],
)
def test_a_bank_that_breaks_the_clause_is_seen(kind: type[Bank], clause: Any) -> None:
    def twist(bank: Bank) -> Bank:
        return kind(bank.stage, bank.params)

    assert list(clause(twisted(twist)))
    assert not list(clause(case_of(broken.good)))


def test_without_a_compiler_the_clause_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    report = check_stage(stage_of(broken.good), endurance=1000)
    reasons = {v.clause: v.details[0] for v in report.skipped}
    assert "no C compiler" in reasons["compiled = C"]


def test_without_compilation_allocations_are_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit, "enabled", lambda: False)
    report = check_stage(stage_of(broken.good), endurance=1000)
    assert "step allocates nothing" in [v.clause for v in report.skipped]


def test_records_of_another_stage_are_refused() -> None:
    stage = stage_of(broken.good)
    with pytest.raises(StageError, match="not the records"):
        check_stage(stage, params=INPUT.zeros(1))
    with pytest.raises(StageError, match="N >= 1000"):
        check_stage(stage, params=params_of(stage), inputs=random_inputs(stage, 999, 3))


def test_one_joint_is_made_several() -> None:
    stage = stage_of(broken.good)
    report = check_stage(
        stage, params=params_of(stage)[:1], inputs=random_inputs(stage, 2000), endurance=1000
    )
    assert report.failed == ()
