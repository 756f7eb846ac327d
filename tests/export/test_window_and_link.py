"""Exported C of windows, observers and the link side is Python's, whatever is wrong with a log."""

from __future__ import annotations

import subprocess
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from rotatum.estimators.registry import Example, example_stages
from rotatum.export import build_shared, export_c
from rotatum.kernels.status import (
    BACKWARDS,
    BRIDGED,
    DISABLED,
    GAP,
    JUMP,
    NOT_FINITE,
    REPEATED,
    SETTLING,
    VERDICTS,
)
from rotatum.runtime.bank import Bank
from rotatum.testing.compare import differences

SAMPLES = 100_000
EXPORTED = 5_000  # of the test vector: a window is filled, emptied by a gap and filled again
STAGES = (
    "algebraic_estimated_2of2_window128_ud_shrunk_guarded",
    "weak_link_2of3_ud_shrunk_guarded",
    "both_weak_link_4of5_window128_ud_shrunk_guarded",
    "rotatum_link_6of6_observer512_ud_shrunk_selective_guarded",
)
# Where in the log something is wrong.
LOST, TWICE, SENT_BACK, MOVED = slice(1500, 1503), 2000, 2500, 3000
OFF, LATE = slice(3500, 3700), 4000

pytestmark = pytest.mark.usefixtures("c_compiler")


@lru_cache(maxsize=1)
def examples() -> dict[str, Example]:
    return {e.stage.name: e for e in example_stages(SAMPLES)}


@pytest.fixture(scope="module", params=STAGES)
def case(request: pytest.FixtureRequest) -> Example:
    """An example of the registry: its stage is compiled for other tests too."""
    example = examples()[request.param]
    u = example.inputs.copy()
    u["q"][LOST] = np.nan
    u["time"][TWICE] = u["time"][TWICE - 1]
    u["time"][LATE:] += 0.06
    u["time"][SENT_BACK] = 0.0
    u["enable"][OFF] = 0
    u["theta" if "theta" in u.dtype.names else "theta2"][MOVED] += 1.0
    return example._replace(inputs=u)


def test_every_number_is_the_same(case: Example) -> None:
    stage, params, u = case
    bank = Bank(stage, params)
    out = bank.run(u)
    # Worth comparing: samples of every kind are in it, and the estimate lives through them.
    seen = np.bitwise_or.reduce(out["status"].ravel())
    for bit in (NOT_FINITE, REPEATED, BACKWARDS, BRIDGED, GAP, JUMP, DISABLED, SETTLING):
        assert seen & bit
    assert np.all(out["verdict"][-1] != VERDICTS.index("starved"))
    state_c, out_c = stage.state.zeros(len(params)), stage.output.zeros(*u.shape)
    loops = build_shared(stage)
    loops.start(params, state_c)
    loops.run(params, state_c, u, out_c)
    assert list(differences(out, out_c, stage.output, ("Python", "C"))) == []
    assert list(differences(bank.state, state_c, stage.state, ("Python", "C"))) == []


def test_the_projects_own_test_passes(case: Example, tmp_path: Path, c_compiler: str) -> None:
    stage, params, u = case
    done = export_c(stage, params, tmp_path / "out", inputs=u[:EXPORTED], joints=["a", "b"])
    assert done.samples == EXPORTED
    made = subprocess.run(
        ["make", "-C", str(done.directory), "test", f"CC={c_compiler}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    numbers = EXPORTED * len(params) * (stage.output.dtype.itemsize // 8)
    assert f"all {numbers} values compared bit for bit" in made.stdout
