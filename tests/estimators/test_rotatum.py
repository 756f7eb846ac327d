"""Method `rotatum` and selective updates: noise, and joints and arms of known stiffness."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rotatum as rt
from rotatum.estimators import Estimator
from rotatum.estimators.measured import JERK, Measured
from rotatum.estimators.noise import column_noise
from rotatum.estimators.registry import Example, example_stages
from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import prepare
from rotatum.kernels.status import BRIDGED, GAP, HELD, NOT_FINITE, STILL, VERDICTS
from rotatum.models import Encoders, device_from_tables
from rotatum.models.robot.planar import Planar
from rotatum.runtime.bank import Bank
from tests.estimators.test_rotatum_settings import M, T, device
from tests.kernels.driven import drive, starts
from tests.kernels.make import Sines
from tests.report.scenes import STIFFNESS, small_device, small_log

# --- noise ----------------------------------------------------------------------------------------

LINK, MOTOR = 3e-4, 1e-4  # rad


@pytest.mark.parametrize(("cutoff", "order"), [(math.inf, 2), (1000.0, 8)])
def test_rows_of_noise_have_the_variances_that_are_predicted(cutoff: float, order: int) -> None:
    one = device()
    request = Request("rotatum", cutoff=cutoff, order=order, measured=Measured(LINK, MOTOR))
    chosen = settle(one.joints[0], one, T, request)
    made = prepare(one.joints[0], chosen, period=T, holds={}, zeros=[0.0])
    told = column_noise(made.joint, made.settings, made.powers, M, False)
    rng = np.random.default_rng(480)
    n = 6000
    q, theta = LINK * rng.standard_normal(n), MOTOR * rng.standard_normal(n)
    stage = rows_stage(made.shape)
    out = drive(stage, made.parts[0]["rows"], q=q, theta=theta, enable=1, fresh=starts(n))
    out = out[out["valid"] == 1]
    # 6000 rows, correlated over five: variances are known to 4 %. Three of it.
    assert out["y"].var() == pytest.approx(M**2 * told.acceleration, rel=0.12)
    assert out["suspect"].var() == pytest.approx(told.acceleration, rel=0.12)
    assert out["R"][:, 0].var() == pytest.approx(told.columns[0], rel=0.12)
    assert told.columns[1] == 0.0
    shared = np.cov(out["y"], out["R"][:, 0])[0, 1]
    size = out["y"].std() * out["R"][:, 0].std()
    assert told.common[0] == pytest.approx(shared, abs=0.06 * size)
    # Jerk and rate pull against each other, and no little.
    assert told.common[0] > 0.3 * size


# --- joints of known stiffness --------------------------------------------------------------------


def test_a_simulated_joint_is_found_from_its_positions_alone() -> None:
    log = small_log()
    log = rt.Log(log.source, log.time, {"elbow": {
        role: x for role, x in log.joints["elbow"].items() if not role.startswith("torque_m")
        and role != "tau"
    }}, log.holds, log.clock)  # fmt: skip
    (joint,) = rt.estimate(log, small_device(), method="rotatum").joints.values()
    assert joint.verdict == "informative"
    assert joint.stiffness["final"] == pytest.approx(STIFFNESS, rel=0.01)
    # Noise of a hundredth of the jerk's, and the lag's: what it says of itself holds.
    assert abs(joint.stiffness["final"] - STIFFNESS) <= 3.0 * joint.stiffness_std
    assert joint.delay == pytest.approx(20.0 / 153.6, abs=T)
    assert "noise of the jerk" in joint.settings["cutoff"]


def exact(seed: int, seconds: float = 3.0) -> tuple[Any, Any, Any]:
    """Time and positions of the small joint, its motion slow beside the observer's cutoff."""
    link = small_device().joints[0].link
    assert link is not None
    assert link.inertia is not None
    q = Sines(np.random.default_rng(seed), 0.4, 6.0, 15.0)
    t = T * np.arange(round(seconds / T))
    torque = -(link.inertia.value * q(t, 2) + link.damping.value * q(t, 1))
    return t, q(t), q(t) - torque / STIFFNESS


@pytest.mark.parametrize(
    ("cutoff", "order", "error"),
    [
        # (w T)^2 / 4 of the jerk's stencil at 15 rad/s: 6e-5.
        (math.inf, None, 6e-5),
        # What a lag of L time constants leaves between rate and jerk falls as exp(-0.38 L), by the
        # slowest of Butterworth's poles: the default of 10 has to do for noisy logs, 20 has 1 / 45.
        (200.0, None, 5e-4),
        (200.0, 100, 5e-4 / 45.0),
    ],
)
def test_without_noise_the_stiffness_is_exact(
    cutoff: float, order: int | None, error: float
) -> None:
    bare = small_device()
    joint = bare.joints[0].model_copy(update={"encoders": Encoders()})
    one = Estimator(
        replace(bare, joints=(joint,)), period=T, method="rotatum", cutoff=cutoff, order=order,
        zeros={"elbow": [0.0]},
    )  # fmt: skip
    t, q, theta = exact(481)
    (out,) = one.run(t, [{"q": q, "theta": theta}])
    assert out["stiffness"][-1, 0] == pytest.approx(STIFFNESS, rel=error)
    assert VERDICTS[out["verdict"][-1, 0]] == "informative"


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_deadbeat_on_counted_positions_does_not_call_itself_informative(seed: int) -> None:
    """Its jerk's noise, 1.6 counts / T^3, is hundreds of times the jerk: the number is wrong."""
    t, q, theta = exact(seed)
    step = 2.0 * math.pi / 65536.0
    q, theta = step * np.round(q / step), step * np.round(theta / step)
    one = Estimator(
        small_device(), period=T, method="rotatum", cutoff=math.inf, zeros={"elbow": [0.0]}
    )
    (out,) = one.run(t, [{"q": q, "theta": theta}])
    wrong = np.abs(out["stiffness"][:, 0] / STIFFNESS - 1.0) > 0.1
    assert wrong[1500:].mean() > 0.5
    told = np.array(VERDICTS)[out["verdict"][:, 0]]
    assert set(told[wrong]) <= {"starved", "inconsistent", "converging"}
    assert told[-1] in ("starved", "inconsistent")


# --- an arm ---------------------------------------------------------------------------------------

SPRINGS = np.array([120.0, 60.0])


def arm(**settings: Any) -> Estimator:
    """A planar arm, its joints run interpreted: no stage is compiled for it."""
    joint = {
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.1, "orders": 1},
        "estimator": {"method": "rotatum"},
    }
    tables = {
        "name": "arm",
        "joint": [{"name": "one", **joint}, {"name": "two", **joint}],
        "robot": {"model": "planar", "lengths": [0.4, 0.3], "masses": [1.2, 0.8]},
    }
    made = Estimator(device_from_tables(tables, "test"), period=T, **settings)
    for group in made.groups:
        group.bank = Bank(group.bank.stage, group.bank.params, compile=False)
    return made


def arm_motion(samples: int) -> tuple[Any, Any, Any]:
    robot = Planar((0.4, 0.3), (1.2, 0.8))
    rng = np.random.default_rng(482)
    joints = [Sines(rng, 0.8, 3.0, 20.0) for _ in range(2)]
    t = T * np.arange(samples)
    q, dq, ddq = (np.stack([s(t, n) for s in joints], axis=1) for n in range(3))
    torque = -np.array([robot.inverse_dynamics(*one) for one in zip(q, dq, ddq, strict=True)])
    return t, q, q - torque / SPRINGS


def test_an_arm_is_found_and_its_loop_gives_what_its_batch_gives() -> None:
    t, q, theta = arm_motion(350)
    q[200, 1] = np.nan  # of one joint: a bad sample of the arm
    kept = np.r_[0:230, 233:350]  # three samples lost
    t, q, theta = t[kept], q[kept], theta[kept]
    t[280:] += 0.5  # a gap too long to bridge
    channels = [{"q": q[:, i].copy(), "theta": theta[:, i].copy()} for i in range(2)]
    (batch,) = arm(cutoff=math.inf).run(t, channels)
    # (w T)^2 / 4 of the stencil at 20 rad/s.
    np.testing.assert_allclose(batch["stiffness"][199], SPRINGS, rtol=1e-4)
    one, online = arm(cutoff=math.inf), []
    for k in range(len(t)):
        one.update(q=q[k], theta=theta[k], time=float(t[k]))
        online.append(one.groups[0].out.copy())
    assert np.stack(online).tobytes() == batch.tobytes()
    assert (batch["status"][200] & NOT_FINITE).all()
    assert (batch["status"][230] & BRIDGED).all()
    assert (batch["status"][280] & GAP).all()
    rows = batch["rows"][:, 0]
    assert rows[279] == 283 - 4, "what is lost is bridged, and the first four fill the window"
    assert rows[-1] == rows[279] + len(t) - 284, "after a gap it is filled anew"


def test_an_arms_joints_share_the_slowest_observer() -> None:
    made = arm(measured={
        "one": Measured(0.0, 0.0, {("link", JERK): 120.0}),
        "two": Measured(0.0, 0.0, {("link", JERK): 80.0}),
    })  # fmt: skip
    assert [p.settings.operator.width for p in made.prepared] == [80.0, 80.0]
    assert "slowest of the arm's" in made.prepared[0].notes["cutoff"]
    assert "noise of the jerk" in made.prepared[1].notes["cutoff"]


# --- selective updates ----------------------------------------------------------------------------


def selective_example() -> Example:
    return next(e for e in example_stages(6000) if "selective" in e.stage.name)


def test_what_stands_still_is_starved_however_narrow_its_interval() -> None:
    stage, params, u = selective_example()
    first = Bank(stage, params).run(u)
    assert (first["verdict"][-1] == VERDICTS.index("informative")).all()
    still = u.copy()
    for name in ("q", "theta"):
        still[name][3000:] = still[name][2999]
    out = Bank(stage, params).run(still)
    told = out["status"]
    assert out[:3000].tobytes() == first[:3000].tobytes()
    assert (told[3200:] & HELD).all()
    assert (out["rows"][3200:] == out["rows"][3200]).all()
    # A second after the gate has closed, not before.
    closed = np.argmax((told[3000:, 0] & HELD) != 0) + 3000
    assert not (told[3000 : closed + 900] & STILL).any()
    assert (told[closed + 1300 :] & STILL).all()
    assert (out["verdict"][-1] == VERDICTS.index("starved")).all()
    # Neither coefficients nor stiffness move meanwhile but by the set-point's way.
    assert out["coefficients"][-1].tobytes() == out["coefficients"][3200].tobytes()
