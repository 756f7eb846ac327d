"""Exported C of a pair of transmissions and of a joint with a set-point equals Python."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.estimators.groups import batch_records
from rotatum.export import build_shared, export_c
from rotatum.export.vector import HEAD
from rotatum.kernels.status import (
    BACKWARDS,
    BRIDGED,
    DISABLED,
    GAP,
    JUMP,
    NOT_FINITE,
    REPEATED,
    VERDICTS,
)
from rotatum.models import load_device
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage
from rotatum.testing.compare import differences
from tests.estimators.motions import motion_log

SAMPLES = 100_000
PERIOD = 1e-3
# Where in the log something is wrong.
LOST, TWICE, OFF, LATE = slice(7000, 7003), 9000, slice(30_000, 31_000), 20_000
MOVED, MOVED_BACK, SENT_BACK = 40_000, 80_000, 50_000
DEVICES = ("vsa-ii", "awas")

pytestmark = pytest.mark.usefixtures("c_compiler")


def made(name: str) -> tuple[Stage, Records, Records]:
    """Stage, constants and a motion with everything that a log can have wrong."""
    device = load_device(name)
    (joint,) = device.joints
    log = motion_log(joint, seed=5, seconds=SAMPLES * PERIOD)
    (group,) = Estimator(device, period=PERIOD).groups
    u = batch_records(group, SAMPLES)
    u["time"] = log.time[:, None]
    for role in group.roles:
        u[role][:, 0] = log.joints[joint.name][role]
    angle, torque = group.roles[1], group.roles[-1]
    u[torque][LOST] = np.nan
    u["time"][TWICE] = u["time"][TWICE - 1]
    u["time"][LATE:] += 60.0 * PERIOD
    u["enable"][OFF] = 0
    u["time"][SENT_BACK] = 0.0
    u[angle][MOVED:MOVED_BACK] += 1.0
    return group.bank.stage, group.bank.params, u


@pytest.fixture(scope="module", params=DEVICES)
def case(request: pytest.FixtureRequest) -> tuple[Stage, Records, Records]:
    return made(request.param)


def test_every_number_is_the_same(case: tuple[Stage, Records, Records]) -> None:
    stage, params, u = case
    bank = Bank(stage, params)
    out = bank.run(u)
    # Worth comparing: samples of every kind are in it, and the estimate lives through them.
    seen = np.bitwise_or.reduce(out["status"].ravel())
    for bit in (NOT_FINITE, REPEATED, BACKWARDS, BRIDGED, GAP, JUMP, DISABLED):
        assert seen & bit
    assert out["verdict"][-1, 0] == VERDICTS.index("informative")
    state_c, out_c = stage.state.zeros(len(params)), stage.output.zeros(*u.shape)
    loops = build_shared(stage)
    loops.start(params, state_c)
    loops.run(params, state_c, u, out_c)
    assert list(differences(out, out_c, stage.output, ("Python", "C"))) == []
    assert list(differences(bank.state, state_c, stage.state, ("Python", "C"))) == []


def test_the_projects_own_test_passes(
    case: tuple[Stage, Records, Records], tmp_path: Path, c_compiler: str
) -> None:
    stage, params, u = case
    done = export_c(stage, params, tmp_path / "out", inputs=u, joints=["joint"])
    assert done.samples == SAMPLES
    made = subprocess.run(
        ["make", "-C", str(done.directory), "test", f"CC={c_compiler}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    numbers = SAMPLES * (stage.output.dtype.itemsize // 8)
    # The first HEAD samples and every hundredth after them are compared one by one.
    stored = (HEAD + (SAMPLES - HEAD) // 100) * (stage.output.dtype.itemsize // 8)
    assert f"all {numbers} values compared bit for bit ({stored} one by one)" in made.stdout
