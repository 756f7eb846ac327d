"""The whole-robot observer: the state beyond springs, bad samples, sensors that are not there."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import rotatum as rt
from rotatum.errors import MethodError, RotatumError
from rotatum.estimators.full_state.combined import CombinedEstimator
from rotatum.estimators.full_state.design import Noise, figures
from rotatum.estimators.full_state.poles import Pair
from rotatum.kernels.status import (
    BACKWARDS,
    BRIDGED,
    GAP,
    NOT_FINITE,
    REPEATED,
    RESTARTED,
    SETTLING,
    UNSEEN,
)
from rotatum.models import Device, device_from_tables

T = 1e-3
NOISE = 0.05  # rad/s^2, of a link's own acceleration


class Run(NamedTuple):
    """A log of one joint as arrays (N, 1), with the exact acceleration of its link."""

    device: Device
    time: Any
    theta: Any
    tau: Any
    acc: Any
    q: Any
    true: dict[str, Any]


@cache
def swing() -> Run:
    """A hardening spring swung over its range and shaken, two seconds; its motor does not rub."""
    values = {"seconds": 2.0, "truth.motor.coulomb": 0.0, "told.motor.coulomb": 0.0}
    scenario = rt.load_scenario("trouble/clean").with_values(values)
    log = scenario.run()
    (own,) = log.joints.values()
    link = scenario.device.joints[0].link
    torque = own["torque_true"] + link.damping.value * own["dq_true"]
    acc = -(torque + link.gravity_torque * np.sin(own["q_true"])) / link.inertia.value
    noise = NOISE * np.random.default_rng(500).standard_normal(acc.size)
    columns = {k: v[:, None] for k, v in own.items()}
    return Run(
        scenario.device, log.time, columns["theta"], columns["tau"], (acc + noise)[:, None],
        columns["q"], {k[:-5]: v for k, v in own.items() if k.endswith("_true")},
    )  # fmt: skip


def fed(loop: rt.StateObserver, run: Run, **more: Any) -> tuple[Any, Any]:
    """States (N, 4): q, q', theta, theta'; and status (N,)."""
    states, status = np.empty((len(run.time), 4)), np.empty(len(run.time), dtype=int)
    for k in range(len(run.time)):
        x = loop.update(
            theta=run.theta[k], tau=run.tau[k], readings=run.acc[k], time=run.time[k],
            **{name: values[k] for name, values in more.items()},
        )  # fmt: skip
        states[k], status[k] = (x.q[0], x.dq[0], x.theta[0], x.dtheta[0]), x.status[0]
    return states, status


def errors(states: Any, run: Run, first: int = 300) -> Any:
    true = np.column_stack([run.true[name] for name in ("q", "dq", "theta", "dtheta")])
    return np.sqrt(np.mean((states - true)[first:] ** 2, axis=0))


def test_a_nonlinear_spring_is_followed_along_its_tangent() -> None:
    run = swing()
    loop = rt.StateObserver(run.device, period=T)
    states, status = fed(loop, run)
    q, dq, theta, dtheta = errors(states, run)
    rigid = np.sqrt(np.mean((run.true["theta"] - run.true["q"]) ** 2))
    # What counts and noise lead to at the spring's softest, where they matter most.
    counts = 2.0 * np.pi / 1638400.0
    noise = figures(loop.designs[0], Noise(resolution=counts, acceleration=NOISE)).deviation
    assert q < 1.1 * noise[1]
    assert rigid > 300.0 * q
    assert dq < 1.1 * noise[3]
    # Of the motor it is the counts alone, and they are no white noise where it turns round.
    assert theta < 2.0 * noise[0]
    assert dtheta < 2.0 * noise[2]
    assert (status[100:] == 0).all()
    # With the stiffness at rest in place of the law's tangent, everything else alike, it is not.
    spring = run.device.joints[0].transmission
    flat = fed(rt.StateObserver(run.device, period=T), run,
               stiffness=np.full((len(run.time), 1), spring.stiffness(0.0)))[0]  # fmt: skip
    assert errors(flat, run)[0] > 30.0 * q


def test_a_batch_is_its_samples_bit_for_bit_and_a_reset_forgets() -> None:
    run = swing()
    loop = rt.StateObserver(run.device, period=T)
    one, status = fed(loop, run)
    none = np.zeros((len(run.time), 1))
    loop.reset()
    found = loop.run(run.time, run.theta, run.tau, none, run.acc, none[:, :0])
    for i, name in enumerate(("q_hat", "dq_hat", "theta_hat", "dtheta_hat")):
        assert np.array_equal(found[name][:, 0], one[:, i])
    assert np.array_equal(found["status"][:, 0], status)


def test_a_controller_that_waits_for_the_state_loses_nothing() -> None:
    run = swing()
    held = {"holds": {"series-demo": True}}
    logged, _ = fed(rt.StateObserver(run.device, period=T, **held), run)
    loop = rt.StateObserver(run.device, period=T, **held)
    acted = np.vstack([run.tau[:1], run.tau[:-1]])
    known = np.array([
        loop.update(
            theta=run.theta[k], tau=acted[k], acted=True, readings=run.acc[k], time=run.time[k]
        ).q[0]
        for k in range(len(run.time))
    ])  # fmt: skip
    assert np.array_equal(known, logged[:, 0])


def test_it_starts_at_rest_under_gravity() -> None:
    run = swing()
    q0 = 0.7
    spring, link = run.device.joints[0].transmission, run.device.joints[0].link
    torque = -link.gravity_torque * np.sin(q0)
    phi = np.linspace(-0.05, 0.05, 100_001)
    theta = q0 - np.interp(torque, spring.torque(phi), phi)
    x = rt.StateObserver(run.device, period=T).update(theta=[theta], tau=[0.0], readings=[0.0])
    assert x.q[0] == pytest.approx(q0, abs=1e-7)
    assert x.torque[0] == pytest.approx(torque, rel=1e-5)
    assert x.status[0] == RESTARTED | SETTLING


def test_the_zero_of_the_spring_is_taken_off_the_motor() -> None:
    run = swing()
    joint = run.device.joints[0]
    zero = 0.0625
    spring = joint.transmission.model_copy(update={"zero": zero})
    moved = replace(run.device, joints=(joint.model_copy(update={"transmissions": (spring,)}),))
    plain, _ = fed(rt.StateObserver(run.device, period=T), run)
    shifted, _ = fed(rt.StateObserver(moved, period=T), run._replace(theta=run.theta - zero))
    # Positions are sums with 0.0625, speeds of their differences over a millisecond.
    np.testing.assert_allclose(shifted[:, 2] + zero, plain[:, 2], rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(shifted[:, [0, 1, 3]], plain[:, [0, 1, 3]], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("what", "rows", "bit"),
    [
        ("theta", slice(1000, 1001), NOT_FINITE),
        ("tau", slice(1000, 1004), NOT_FINITE),
        ("acc", slice(1000, 1004), 0),
        ("acc", slice(1000, 1030), UNSEEN),
        ("time", slice(1000, 1001), REPEATED),
        ("time", slice(1000, 1002), BACKWARDS),
    ],
)
def test_bad_samples_are_said_and_forgotten(what: str, rows: slice, bit: int) -> None:
    run = swing()
    values = getattr(run, what).copy()
    if what == "time":
        values[rows] = run.time[999] if bit == REPEATED else 0.0
    else:
        values[rows] = np.nan if what != "tau" else np.inf
    good, _ = fed(rt.StateObserver(run.device, period=T), run)
    bad, status = fed(rt.StateObserver(run.device, period=T), run._replace(**{what: values}))
    assert np.isfinite(bad).all()
    assert bit == 0 or (status[rows] & bit).any()
    if what in ("theta", "tau", "time"):
        assert status[rows.stop] & BRIDGED
        assert np.array_equal(bad[rows], np.repeat(bad[999:1000], rows.stop - 1000, axis=0))
    # Off by 1 N m over 250 N m/rad at most; and then the same again within 50 time constants.
    assert np.abs(bad - good)[rows.stop : rows.stop + 20, 0].max() < 4e-3
    np.testing.assert_allclose(bad[1250:], good[1250:], rtol=0.0, atol=1e-9)
    assert (status[1250:] == 0).all()


def test_after_a_gap_it_starts_at_rest_and_finds_back() -> None:
    run = swing()
    keep = np.r_[0:1000, 1100:2000]
    cut = Run(run.device, *(getattr(run, name)[keep] for name in ("time", "theta", "tau", "acc",
              "q")), true={k: v[keep] for k, v in run.true.items()})  # fmt: skip
    states, status = fed(rt.StateObserver(run.device, period=T), cut)
    assert status[1000] & (GAP | RESTARTED) == GAP | RESTARTED
    assert status[1000] & SETTLING
    good, _ = fed(rt.StateObserver(run.device, period=T), run)
    np.testing.assert_allclose(states[1250:], good[1350:], rtol=0.0, atol=1e-9)


def test_a_wrong_stiffness_leaves_the_torque_right() -> None:
    run = swing()
    soft = 0.8 * run.device.joints[0].transmission.stiffness(0.0)
    loop = rt.StateObserver(run.device, period=T)
    torque = np.array([
        loop.update(
            theta=run.theta[k], tau=run.tau[k], readings=run.acc[k], stiffness=[soft]
        ).torque[0]
        for k in range(len(run.time))
    ])  # fmt: skip
    true = run.true["torque"]
    # The stiffness is 20 to 50 % wrong; the motor's balance holds the torque up to 250 rad/s.
    assert np.sqrt(np.mean((torque - true)[300:] ** 2)) < 0.05 * np.sqrt(np.mean(true**2))


def test_a_stiffness_that_is_estimated_on_the_way_is_as_good_as_the_true_one() -> None:
    tables = {
        "name": "linear", "actuation": "series",
        "motor": {"inertia": 0.3, "damping": 0.2},
        "transmission": {"law": "linear", "stiffness": 300.0, "zero": 0.0},
        "link": {"inertia": 0.25, "gravity_torque": 6.0},
        "encoders": {"link": 262144, "motor": 1638400},
        "basis": {"deflection_range": 0.08, "orders": 1},
    }  # fmt: skip
    true = device_from_tables(tables, "test")
    tables["transmission"] = {"law": "linear", "stiffness": 210.0, "zero": 0.0}
    told = device_from_tables(tables, "test")
    run = linear(true)
    both = CombinedEstimator(told, period=T)
    q, stiffness = np.empty((2, len(run.time)))
    for k in range(len(run.time)):
        x, found = both.update(
            q=run.q[k], theta=run.theta[k], tau=run.tau[k], readings=run.acc[k], time=run.time[k]
        )
        q[k], stiffness[k] = x.q[0], found.stiffness[0]
    assert found.verdict == ("informative",)
    assert stiffness[-1] == pytest.approx(300.0, rel=0.01)
    late = slice(5500, None)
    known, unknown = (
        errors(fed(rt.StateObserver(d, period=T), run)[0], run, 5500)[0] for d in (true, told)
    )
    own = np.sqrt(np.mean((q - run.true["q"])[late] ** 2))
    assert own < 1.5 * known
    assert own < 0.05 * unknown


def linear(device: Device) -> Run:
    """Seven seconds of a linear joint, its motor shaken."""
    drive = {"tau": rt.load_scenario("trouble/clean")._drives(0)["series-demo"]["tau"]}
    log = rt.simulate(device, seconds=7.0, period=T, drives={device.joints[0].name: drive}, seed=3)
    (own,) = log.joints.values()
    link = device.joints[0].link
    acc = -(own["torque_true"] + link.gravity_torque * np.sin(own["q_true"])) / link.inertia.value
    columns = {k: v[:, None] for k, v in own.items()}
    return Run(device, log.time, columns["theta"], columns["tau"], acc[:, None], columns["q"],
               {k[:-5]: v for k, v in own.items() if k.endswith("_true")})  # fmt: skip


# --- what is refused ------------------------------------------------------------------------------


def test_what_cannot_be_observed_is_refused_by_name() -> None:
    device = swing().device
    with pytest.raises(RotatumError, match=r"[Dd]id you mean 'joints'"):
        rt.StateObserver(device, period=T, accelerations="joint")
    with pytest.raises(MethodError, match="no accelerometer"):
        rt.StateObserver(device, period=T, accelerations="accelerometers")
    with pytest.raises(RotatumError, match="poles of a joint"):
        rt.StateObserver(device, period=T, poles={"elbow": (Pair(), Pair())})
    with pytest.raises(MethodError, match="too fast"):
        rt.StateObserver(device, period=T, frequency=4000.0)
    with pytest.raises(MethodError, match="one motor and one transmission"):
        rt.StateObserver(rt.load_device("vsa-ii"), period=T)
    loop = rt.StateObserver(device, period=T)
    with pytest.raises(MethodError, match=r"every reading needs a number.*series-demo\.acc"):
        loop.update(theta=[0.0], tau=[0.0], readings=[0.0, 1.0])
    with pytest.raises(MethodError, match="no gyroscopes"):
        loop.update(theta=[0.0], tau=[0.0], readings=[0.0], rates=[1.0])


def test_a_slow_clock_has_slower_poles_by_default() -> None:
    device = swing().device
    assert rt.StateObserver(device, period=T).designs[0].pairs == (Pair(), Pair())
    slow = rt.StateObserver(device, period=0.01).designs[0].pairs[0]
    assert slow.frequency == pytest.approx(0.3 * np.pi / 0.01)
