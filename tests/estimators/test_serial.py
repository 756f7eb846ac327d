"""A joint whose second motor sets the lever arm: its law, its units, and arms it has not seen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotatum as rt
from rotatum.estimators.groups import batch_records
from rotatum.evaluation import JointEstimate, msrep_percent
from rotatum.evaluation.papers.flacco2012 import awas
from rotatum.kernels.status import PRIOR, VERDICTS
from rotatum.models import Device, Setpoint
from rotatum.models.channel import Channel
from rotatum.record import Records
from rotatum.simulation import simulate_joint, sine

START = 2.0  # s
SEEDS = (10, 11, 12)  # the paper's own test takes 0 to 9
GRAVITY = 20.0  # N m, 7 to 11 % of the passive stiffness


def single(found: rt.Estimate) -> JointEstimate:
    (joint,) = found.joints.values()
    return joint


def law_stiffness(found: JointEstimate, phi: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Stiffness of the final law, ``s`` being the set-point less the middle of its range."""
    sigma = np.zeros_like(phi)
    for a, (i, j) in zip(found.law_coefficients, found.powers, strict=True):
        sigma += a * i * phi ** (i - 1) * s**j
    return sigma


def with_setpoint(device: Device, unit: float, channel: dict[str, Any] | None = None) -> Device:
    """A device whose set-point is logged directly, with the range in that unit (m times it)."""
    (joint,) = device.joints
    low, high = joint.basis.setpoint_range or (0.0, 0.0)
    basis = joint.basis.model_copy(update={"setpoint_range": (unit * low, unit * high)})
    told: dict[str, Any] = {"setpoint": Setpoint(law="direct"), "basis": basis}
    if channel is not None:
        told["channels"] = {"setpoint": Channel(**channel)}
    return replace(device, joints=(joint.model_copy(update=told),))


def with_arm(log: rt.Log, device: Device, unit: float) -> rt.Log:
    """The log with the lever arm in place of its motor's angle."""
    ((name, roles),) = log.joints.items()
    setpoint = device.joints[0].setpoint
    assert setpoint is not None
    arm = unit * setpoint.value(roles["setpoint"])
    return replace(log, joints={name: {**roles, "setpoint": arm}})


@pytest.fixture(scope="module")
def device() -> Device:
    return awas.device()


@pytest.fixture(scope="module")
def log(device: Device) -> rt.Log:
    return awas.motion(device, SEEDS[0])


@pytest.fixture(scope="module")
def found(device: Device, log: rt.Log) -> JointEstimate:
    return single(rt.estimate(log, device, start=START))


def test_the_final_law_holds_over_the_whole_motion(device: Device) -> None:
    (joint,) = device.joints
    spring, setpoint = joint.transmission, joint.setpoint
    assert setpoint is not None
    errors = []
    for seed in SEEDS:
        log = awas.motion(device, seed)
        done = single(rt.estimate(log, device, start=START))
        assert done.verdict == "informative"
        assert done.truth is not None
        # 95 % nominal; neighbouring samples share their error, so one motion's share scatters.
        assert done.truth["coverage_percent"] >= 85.0
        roles = log.joints[joint.name]
        phi, arm = roles["q"] - roles["theta"], setpoint.value(roles["setpoint"])
        law = law_stiffness(done, phi, arm - 0.09)
        errors.append(msrep_percent(law, roles["stiffness_true"]))
        # The same from the law's own file: the truth of the log is the joint's.
        assert msrep_percent(spring.stiffness(phi, arm), roles["stiffness_true"]) < 1e-6
    # What is promised; without shrinkage it is 0.23 %.
    assert np.median(errors) <= 0.003
    assert max(errors) <= 0.03


def test_the_last_reading_is_the_final_law(
    device: Device, log: rt.Log, found: JointEstimate
) -> None:
    roles = log.joints[device.joints[0].name]
    setpoint = device.joints[0].setpoint
    assert setpoint is not None
    # The transmission's zero is that of the device file, 0; rows end one sample after the reading.
    phi, arm = roles["q"] - roles["theta"], setpoint.value(roles["setpoint"])
    law = law_stiffness(found, phi[-1:], arm[-1:] - 0.09)
    # Ten terms, the largest a few times the sum.
    assert law[0] == pytest.approx(found.records["stiffness"][-1], rel=1e-11)


@pytest.mark.parametrize("unit", [1.0, 1000.0], ids=["m", "mm"])
def test_a_direct_set_point_gives_the_same_stiffness(
    device: Device, log: rt.Log, found: JointEstimate, unit: float
) -> None:
    """The lever arm itself, its range in the same unit: of the log, without any unit told."""
    arms = with_arm(log, device, unit)
    done = single(rt.estimate(arms, with_setpoint(device, unit), start=START))
    same(done, found)


def test_a_unit_of_the_channel_gives_the_same_stiffness(
    device: Device, log: rt.Log, found: JointEstimate, tmp_path: Path
) -> None:
    path = tmp_path / "awas.npz"
    rt.write_table(path, with_arm(log, device, 1000.0).columns())
    told = with_setpoint(device, 1.0, {"unit": "mm"})
    done = single(rt.estimate(replace_holds(rt.read_log(path, told), log), told, start=START))
    same(done, found)


def replace_holds(log: rt.Log, other: rt.Log) -> rt.Log:
    """A file does not say which channels are held; the simulation does."""
    return replace(log, holds=other.holds)


def same(done: JointEstimate, found: JointEstimate) -> None:
    """Set-points that are normalised alike: what differs is rounding, which columns enlarge."""
    for field, begin, tolerance in (
        ("stiffness", 1000, 1e-9),
        # Until the lever arm has swung, intervals rest on differences of nearly equal columns.
        ("stiffness_std", 1000, 1e-6),
        ("stiffness_std", 20_000, 1e-9),
    ):
        a, b = done.records[field][begin:], found.records[field][begin:]
        np.testing.assert_allclose(a, b, rtol=tolerance)
    assert done.verdict == found.verdict


def in_turn(
    device: Device, learnt: rt.Log, seen: rt.Log, **options: Any
) -> tuple[Records, Records]:
    """Readings while learning from one log, then over another without learning from it."""
    name = device.joints[0].name
    loop = rt.Estimator(device, period=learnt.period, holds=learnt.holds)
    (group,) = loop.groups
    found = []
    for log, begin, enable in ((learnt, 0.0, 1), (seen, learnt.time[-1] + 1.0, 0)):
        u = batch_records(group, log.samples)
        u["time"] = begin + log.time[:, None]
        u["enable"] = enable
        for role in group.roles:
            u[role][:, 0] = log.joints[name][role]
        found.append(group.bank.run(u)[:, 0])
    return found[0], found[1]


def test_a_still_set_point_tells_of_its_own_arm_only(device: Device) -> None:
    still = awas.motion(device, SEEDS[0], lever=lambda t: np.full_like(t, 0.1))
    other = awas.motion(device, SEEDS[1], lever=lambda t: np.full_like(t, 0.07))
    own, elsewhere = in_turn(device, still, other)
    truth = still.joints[device.joints[0].name]["stiffness_true"]
    last = own[-1]
    assert VERDICTS[last["verdict"]] == "informative"
    # Noise of 0.3 N m on torques of 1 N m rms leaves 0.3 % after 40 s; 1 % is three of these.
    assert last["stiffness"] == pytest.approx(truth[-1], rel=0.01)
    assert abs(last["stiffness"] - truth[-1]) <= 3.0 * last["stiffness_std"]
    # At 70 mm it is half of that, and nothing has been seen of it.
    assert np.all(elsewhere["verdict"][100:] == VERDICTS.index("starved"))
    assert np.all(elsewhere["status"][100:] & PRIOR)


def test_an_arm_hardly_moved_does_not_tell_of_a_far_one(device: Device) -> None:
    little = awas.motion(device, SEEDS[0], lever=awas.Sweep(0.1, 0.097))
    other = awas.motion(device, SEEDS[1], lever=lambda t: np.full_like(t, 0.07))
    own, elsewhere = in_turn(device, little, other)
    truth = other.joints[device.joints[0].name]["stiffness_true"]
    assert VERDICTS[own["verdict"][-1]] == "informative"
    assert np.all(elsewhere["verdict"][100:] == VERDICTS.index("starved"))
    assert np.all(abs(elsewhere["stiffness"] - truth) <= 1.96 * elsewhere["stiffness_std"])


def test_gravity_is_added_to_what_the_link_feels(device: Device, tmp_path: Path) -> None:
    (joint,) = device.joints
    assert joint.link is not None
    link = joint.link.model_copy(update={"gravity_torque": GRAVITY})
    heavy = replace(device, joints=(joint.model_copy(update={"link": link}),))
    log = simulate_joint(
        heavy.joints[0],
        seconds=20.0,
        period=1e-3,
        drives={"tau": sine(15.0, 0.4), "setpoint": lambda t: np.full_like(t, 0.1)},
        seed=SEEDS[0],
    )
    found = rt.estimate(log, heavy, start=START)
    done = single(found)
    roles = log.joints[joint.name]
    found.write(tmp_path / "out.npz")
    with np.load(tmp_path / "out.npz") as table:
        passive = table[f"{joint.name}.stiffness"]
        external = table[f"{joint.name}.external_stiffness"]
    np.testing.assert_allclose(external - passive, GRAVITY * np.cos(roles["q"]), atol=1e-11)
    assert done.external_stiffness == external[-1]
    # What it stands for: d tau_ext / dq with the motor held, of tau_ext = G sin q + tau_e(q - th).
    q, theta, dq = roles["q"][-1], roles["theta"][-1], 1e-5
    felt = [
        GRAVITY * np.sin(x) + float(joint.transmission.torque(x - theta, 0.1))
        for x in (q - dq, q + dq)
    ]
    # The estimate's own error is under a per cent, gravity's share 7 %.
    assert done.external_stiffness == pytest.approx((felt[1] - felt[0]) / (2.0 * dq), rel=0.01)
