"""Every ready-made stage passes the contract."""

from __future__ import annotations

import pytest

from rotatum.estimators.registry import Example, example_stages
from rotatum.report.references import REFERENCES
from rotatum.testing import check_stage

# Long enough for a covariance to wind up many times over; the low-pass has the full 10^7.
ENDURANCE = 300_000
SAMPLES = 100_000  # compiled and C are compared on all of them

EXAMPLES = example_stages(SAMPLES)


@pytest.mark.parametrize("example", EXAMPLES, ids=[stage.name for stage, *_ in EXAMPLES])
def test_a_ready_made_stage_passes(example: Example) -> None:
    stage, params, inputs = example
    report = check_stage(
        stage,
        params=params,
        inputs=inputs,
        endurance=ENDURANCE,
        references=frozenset(REFERENCES),
    )
    assert {v.clause for v in report.skipped} <= {"compiled = C", "units only scale"}


def test_the_full_contract_of_the_low_pass() -> None:
    stage, params, inputs = EXAMPLES[0]
    assert stage.name == "lowpass"
    check_stage(stage, params=params, inputs=inputs, scale={"u.x": 1.0, "out.x": 1.0})
