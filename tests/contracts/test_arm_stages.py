"""The two halves of an arm's estimator: neither sees bad samples on its own, but for the guard."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.armfront import arm_stage
from rotatum.estimators.armterms import load_provider
from rotatum.estimators.estimator import Estimator
from rotatum.kernels.status import NOT_FINITE, REJECTED
from rotatum.models import device_from_tables
from rotatum.record import Records
from rotatum.report.references import REFERENCES
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage
from rotatum.testing.case import Case
from rotatum.testing.check import CONTRACT
from rotatum.testing.compare import differences
from rotatum.testing.report import judge

T = 1e-3
SAMPLES = 20_000
JOINTS = 2

# What each half leaves to the other, and is tested below.
ARM = {"output is written in full"}  # steps beyond the last are room, not output
# The arm's guard stands before it: it sees nothing that is not finite.
JOINT = {"recovers from bad samples", "status says why", "interpreted = compiled"}


def arm_case() -> Case:
    stage = arm_stage(JOINTS)
    params = stage.params.zeros(2)
    params["guard"]["period"] = params["arm"]["period"] = T
    params["guard"]["missing"], params["guard"]["jump"] = 8, 1.0
    inputs = stage.input.zeros(SAMPLES, 2)
    t = T * np.arange(SAMPLES)
    inputs["time"] = t[:, None]
    for i, name in enumerate(("q", "theta", "theta2", "setpoint")):
        for joint in range(JOINTS):
            inputs[name][:, 0, joint] = np.sin((3.0 + i + joint) * t)
            inputs[name][:, 1, joint] = np.cos((2.0 + i + joint) * t)
    return case(stage, params, inputs)


def joint_case() -> Case:
    """A pendulum as an arm of one joint, estimated behind the arm's guard."""
    tables = {
        "name": "one",
        "link": {"damping": 0.05},
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.1, "orders": 1},
        "robot": {"model": "pendulum", "lengths": [0.3], "masses": [1.5]},
        "estimator": {"side": "link", "fit": ["link_damping"], "cutoff": 100.0},
    }
    device = device_from_tables(tables, "test")
    (prepared,) = Estimator(device, period=T).prepared
    stage, robot = prepared.stage, device.build_robot()
    assert robot is not None
    inputs = stage.input.zeros(SAMPLES, 2)
    t = T * np.arange(SAMPLES)
    inputs["time"], inputs["enable"], inputs["fresh"][0] = t[:, None], 1, 1
    load = load_provider(robot, None)
    for j, w in enumerate((5.0, 8.0)):
        q, dq, ddq = (0.4 * w**n * np.sin(w * t + 0.5 * n * np.pi)[:, None] for n in range(3))
        for k in range(SAMPLES):
            torque = robot.inverse_dynamics(q[k], dq[k], ddq[k]) + 0.08 * dq[k]
            inputs["theta"][k, j] = (q[k] + torque / 150.0)[0]
            said = load(q[max(0, k - 2)], dq[max(0, k - 2)])
            inputs["momentum"][k, j], inputs["force"][k, j] = said.momentum[0], said.force[0]
        inputs["q"][:, j] = q[:, 0]
    return case(stage, np.concatenate([prepared.params] * 2), inputs)


def case(stage: Stage, params: Records, inputs: Records) -> Case:
    return Case(stage, params, inputs, 0, 2000, 100_000, None, frozenset(REFERENCES))


@pytest.fixture(scope="module")
def arm() -> Case:
    return arm_case()


@pytest.fixture(scope="module")
def joint() -> Case:
    return joint_case()


@pytest.mark.parametrize(("half", "left"), [("arm", ARM), ("joint", JOINT)])
def test_a_half_passes_what_is_its_own(
    half: str, left: set[str], request: pytest.FixtureRequest
) -> None:
    found = request.getfixturevalue(half)
    assert left < set(CONTRACT)
    verdicts = [judge(found, words, clause) for words, clause in CONTRACT.items()]
    broken = [str(v) for v in verdicts if v.clause not in left and v.outcome == "failed"]
    assert broken == []


def test_what_is_left_unwritten_is_beyond_the_last_step(arm: Case) -> None:
    out = arm.stage.output.zeros(100, 2)
    used = np.full_like(out.view(np.uint8), 0x41).view(out.dtype).reshape(out.shape)
    inputs = arm.inputs[:100].copy()
    inputs["q"][50:53, 0] = np.nan  # three refused, then four steps at once
    arm.bank().run(inputs, out)
    arm.bank().run(inputs, used)
    assert out["steps"][50:54, 0].tolist() == [0, 0, 0, 4]
    for k in range(100):
        for j in range(2):
            one, other = out[k, j], used[k, j]
            steps = int(one["steps"])
            for name in ("steps", "status", "fresh"):
                assert one[name] == other[name]
            for name in ("time", "known", "q", "theta", "theta2", "setpoint"):
                assert one[name][:steps].tobytes() == other[name][:steps].tobytes()
            known = one["known"][:steps] == 1
            for name in ("q_past", "dq_past"):
                assert (one[name][:steps][known] == other[name][:steps][known]).all()


def test_a_joint_is_the_same_interpreted_and_compiled(joint: Case) -> None:
    inputs = joint.inputs[:300]
    interpreted, compiled = joint.run(inputs, compile=False), joint.run(inputs)
    labels = ("interpreted", "compiled")
    for records, other, layout in zip(
        interpreted, compiled, (joint.stage.output, joint.stage.state), strict=True
    ):
        assert list(differences(records, other, layout, labels)) == []


def test_a_refused_sample_leaves_a_joint_as_it_was(joint: Case) -> None:
    bank, clean = joint.bank(), Bank(joint.stage, joint.params)
    before = bank.run(joint.inputs[:5000])
    clean.run(joint.inputs[:5000])
    refused = joint.inputs[5000].copy()
    for name in ("q", "theta", "momentum", "force"):
        refused[name] = np.nan
    refused["hold"], refused["status"] = 1, NOT_FINITE
    held = bank.update(refused)
    assert (held["status"] & REJECTED == NOT_FINITE).all()
    for name in joint.stage.output.fields:
        if name not in ("time", "status", "verdict", "converged", "converged_at"):
            assert held[name].tobytes() == before[name][-1].tobytes()
    rest = np.ascontiguousarray(joint.inputs[5000:5100])
    assert bank.run(rest).tobytes() == clean.run(rest).tobytes()


def test_the_joint_of_the_case_is_found(joint: Case) -> None:
    """What is compared bit for bit is an estimate that works: 150 N m/rad, damping 0.08 - 0.05."""
    out = joint.bank().run(joint.inputs)[-1]
    # T^4 of the arm's differences; a prior of 1e-8 of a row.
    np.testing.assert_allclose(out["stiffness"], 150.0, rtol=1e-4)
    np.testing.assert_allclose(out["coefficients"][:, 0], 0.03, rtol=1e-2)
