"""Every ready-made stage passes the contract."""

from __future__ import annotations

import importlib
import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

from rotatum.record import Records
from rotatum.runtime.stage import Stage
from rotatum.testing import check_stage, random_inputs
from tests.export.stages import LOWPASS

Example = tuple[Stage, Records, Records]

# Long enough for a covariance to wind up many times over at the forgetting factors of the
# examples; the full 10^7 of the contract is run on the first of them.
ENDURANCE = 300_000


def lowpass_example() -> Example:
    params = LOWPASS.params.zeros(2)
    params["pole"], params["order"] = np.array([0.5, 0.99]), np.array([1, 2])
    return LOWPASS, params, random_inputs(LOWPASS, 100_000, 2)


def examples() -> list[Example]:
    """Return the low-pass and the stages of the registry, if there is one."""
    name = "rotatum.estimators.registry"
    found = [lowpass_example()]
    if importlib.util.find_spec(name) is not None:
        found += importlib.import_module(name).example_stages()
    return found


EXAMPLES = examples()


@pytest.mark.parametrize("example", EXAMPLES, ids=[stage.name for stage, *_ in EXAMPLES])
def test_a_ready_made_stage_passes(example: Example, project: Path) -> None:
    stage, params, inputs = example
    report = check_stage(
        stage,
        params=params,
        inputs=inputs,
        endurance=ENDURANCE,
        references=references(project),
    )
    assert {v.clause for v in report.skipped} <= {"compiled = C", "units only scale"} | (
        {"cites known work"} if references(project) is None else set()
    )


def test_the_full_contract_of_the_low_pass() -> None:
    stage, params, inputs = lowpass_example()
    check_stage(stage, params=params, inputs=inputs, scale={"u.x": 1.0, "out.x": 1.0})


def references(project: Path) -> frozenset[str] | None:
    """Return the citation keys of the list of references, if the checkout has one."""
    path = project / "docs" / "reference" / "references.md"
    if not path.exists():
        return None
    return frozenset(re.findall(r"[a-z]+(?:19|20)\d\d[a-z]?", path.read_text()))
