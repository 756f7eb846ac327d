"""The unknown-input observer passes the contract: its smallest size reaches every line."""

from __future__ import annotations

import numpy as np

from rotatum.estimators.observers.decoupled import exact_observer
from rotatum.estimators.observers.stage import observer_params, observer_stage
from rotatum.estimators.observers.system import system
from rotatum.report.references import REFERENCES
from rotatum.testing import check_stage


def test_the_unknown_input_observer_passes() -> None:
    given = system([[0.9]], [[0.1]], [[1.0]])
    recursion = exact_observer(given, 1, [0.5]).recursion
    stage = observer_stage(recursion, 1)
    inputs = stage.input.zeros(6000, 1)
    k = np.arange(len(inputs))
    inputs["y"][:, 0, 0] = np.sin(0.01 * k) + 0.3 * np.cos(0.07 * k)
    inputs["fresh"][5000] = 1
    report = check_stage(
        stage,
        params=observer_params(stage, recursion),
        inputs=inputs,
        settle=500,
        endurance=300_000,
        scale={"u.y": 1.0, "out.x": 1.0, "out.u": 1.0},
        references=frozenset(REFERENCES),
    )
    assert {v.clause for v in report.skipped} <= {"compiled = C"}
