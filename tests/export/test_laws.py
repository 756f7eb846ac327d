"""Elastic laws inside a stage: interpreted, compiled and as C they are the same bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.export import build_shared
from rotatum.export.subset import in_stage
from rotatum.models import Law
from rotatum.record import Layout, Record, number, vector
from rotatum.runtime.bank import Bank
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.stage import Stage
from rotatum.testing.compare import differences
from tests.models.law_cases import CASES, Case

FUNCTIONS = (
    "energy",
    "torque",
    "stiffness",
    "slope",
    "curvature",
    "energy_setpoint",
    "torque_setpoint",
    "stiffness_setpoint",
)


class Constants(Record):
    """Packed constants of a law."""

    c = vector("n", "constants")


class Memory(Record):
    """Nothing to remember, and no record is empty."""

    count = number("samples")


class Point(Record):
    """Where a law is evaluated."""

    phi = number("deflection", unit="rad")
    s = number("set-point")


OUTPUT = Layout("Values", "All a law gives.", {name: number(name) for name in FUNCTIONS})


def stage_of(law: Law, size: int) -> Stage:
    """Return a stage that outputs all eight functions of a law."""
    lines = [f"out.{name} = {name}(params.c, u.phi, u.s)" for name in FUNCTIONS]
    kernels = {name: getattr(law, name) for name in FUNCTIONS}
    name = f"law_{law.name}"
    init, step = write_kernels(name, "A law.", ["state.count = 0.0"], lines, kernels)
    layouts = (Constants.layout(n=size), Memory.layout(), Point.layout(), OUTPUT)
    return Stage(name, *layouts, init, step)


@pytest.mark.usefixtures("c_compiler")
@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_python_numba_and_c_agree(case: Case) -> None:
    transmission = case.transmission
    law, constants = transmission.model, transmission.constants
    stage = stage_of(law, len(constants))
    assert in_stage(stage) == []
    params = stage.params.zeros(1)
    params["c"] = constants
    rng = np.random.default_rng(11)
    u = stage.input.zeros(400, 1)
    inside = rng.uniform(-case.reach, case.reach, (200, 1))
    # Outside: up to three times the reach, and a few places far away.
    u["phi"] = np.concatenate([inside, 3.0 * inside[:150], rng.normal(size=(50, 1)) * 300.0])
    u["phi"][:3] = [[0.0], [-0.0], [case.rest]]
    u["s"] = rng.choice([*case.setpoints, 0.0, -0.3, 2.0], u.shape)

    python = Bank(stage, params, compile=False).run(u)
    compiled = Bank(stage, params, compile=True).run(u)
    c = stage.output.zeros(400, 1)
    loops, state = build_shared(stage), stage.state.zeros(1)
    loops.start(params, state)
    loops.run(params, state, u.reshape(-1), c.reshape(-1))

    assert list(differences(python, compiled, OUTPUT, ("Python", "numba"))) == []
    assert list(differences(python, c, OUTPUT, ("Python", "C"))) == []
    for name in FUNCTIONS:
        assert np.all(np.isfinite(python[name]))
        # What a transmission says of arrays is the same text once more.
        told = getattr(transmission, name)(u["phi"], u["s"])
        assert np.array_equal(told, python[name]), name
