"""Two transmissions on one link: their sum, each part, and what becomes of a bad channel."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotatum as rt
from rotatum.errors import MethodError
from rotatum.evaluation import JointEstimate, msrep_percent
from rotatum.evaluation.noise import measure
from rotatum.evaluation.papers.flacco2012 import vsa2
from rotatum.evaluation.papers.variants import with_counts
from rotatum.kernels.status import GAP, NOT_FINITE
from rotatum.models import Device, device_from_tables
from rotatum.simulation import multisine, simulate_joint, sine
from tests.report.scenes import DEVICE as ELBOW

START = 2.0  # s; the targets are over 2 to 20 s
# The paper's own test takes 0 to 9. Over forty others the median is 0.0013 %, and one seed in six
# exceeds 0.002 %: the median of three does so in one choice of twelve.
SEEDS = (10, 11, 12)
LOST = slice(8000, 9000)  # samples in which a channel is missing
SHIFT = 0.01  # rad, of a link encoder mounted askew; 3 % of the range, three times the warning's


def single(found: rt.Estimate) -> JointEstimate:
    (joint,) = found.joints.values()
    return joint


def with_roles(log: rt.Log, **roles: np.ndarray | None) -> rt.Log:
    """The log with other channels; None takes one away."""
    ((name, own),) = log.joints.items()
    told = {**own, **roles}
    return replace(log, joints={name: {k: v for k, v in told.items() if v is not None}})


@pytest.fixture(scope="module")
def device() -> Device:
    return vsa2.device()


@pytest.fixture(scope="module")
def log(device: Device) -> rt.Log:
    return vsa2.motion(device, SEEDS[0])


@pytest.fixture(scope="module")
def found(device: Device, log: rt.Log) -> rt.Estimate:
    return rt.estimate(log, device, start=START)


@pytest.mark.parametrize("name", vsa2.NAMES)
def test_the_total_is_good_and_so_is_its_interval(name: str) -> None:
    device = vsa2.device(name)
    told = []
    for seed in SEEDS:
        done = single(rt.estimate(vsa2.motion(device, seed), device, start=START))
        assert done.verdict == "informative"
        assert done.truth is not None
        told.append(done.truth)
    errors = [truth["msrep_percent"] for truth in told]
    # What is promised; a fixed cubic basis, which knows the order, reaches 0.001 and 0.0026.
    assert np.median(errors) <= 0.002
    assert max(errors) <= 0.008
    # 95 % nominal; neighbouring samples share their error, so the share of one motion scatters.
    assert min(truth["coverage_percent"] for truth in told) >= 85.0


def test_the_total_is_the_sum_of_its_parts(found: rt.Estimate) -> None:
    records = single(found).records
    # One addition of the two numbers that are told beside it: equal to the bit.
    for field in ("stiffness", "torque", "dstiffness", "row_torque", "row_fit"):
        first, second = records[f"part_{field}"].T
        assert np.array_equal(records[field], first + second)
    mean = 0.5 * (records["part_deflection"][:, 0] + records["part_deflection"][:, 1])
    assert np.array_equal(records["deflection"], mean)


def test_the_deviation_of_the_total_has_its_bounds(found: rt.Estimate) -> None:
    records = single(found).records[2000:]
    first, second = records["part_stiffness_std"].T
    # A correlation between -1/2 and 1 (``kernels.pair``); 1e-9 for rounding.
    assert np.all(records["stiffness_std"] <= (first + second) * (1.0 + 1e-9))
    lowest = np.sqrt(first**2 + second**2 - first * second)
    assert np.all(records["stiffness_std"] >= lowest * (1.0 - 1e-9))


def test_json_tells_both_transmissions(found: rt.Estimate, device: Device) -> None:
    told = found.to_json()["joints"][device.joints[0].name]
    parts = told["transmissions"]
    assert len(parts) == 2
    assert told["stiffness"]["final"] == parts[0]["stiffness"] + parts[1]["stiffness"]
    for part, own in zip(parts, single(found).parts, strict=True):
        assert set(part) == {"stiffness", "stiffness_std", "verdict", "truth"}
        assert (part["stiffness"], part["stiffness_std"]) == (own.stiffness, own.stiffness_std)
        assert part["verdict"] == "informative"
        # Half of the total each: the same error is four times the relative square of the total's.
        assert part["truth"]["msrep_percent"] <= 4.0 * 0.008
    assert set(told["fitted"]) == {"offset1", "offset2"}
    # Of the law alone: the offsets are not among them.
    assert len(told["coefficients"]) == 2 * device.joints[0].basis.orders


def test_columns_of_the_written_table(found: rt.Estimate, tmp_path: Path) -> None:
    found.write(tmp_path / "out.csv")
    name = single(found).name
    with (tmp_path / "out.csv").open() as file:
        head = file.readline().strip().split(",")
    own = ("stiffness", "stiffness_std", "torque", "torque_std", "dstiffness", "deflection")
    words = [*own, "external_stiffness", "verdict", "status"]
    for i in "12":
        words += [f"{w}{i}" for w in ("stiffness", "torque", "dstiffness", "deflection")]
        words.append(f"stiffness{i}_std")
    assert sorted(head) == sorted(["time", *(f"{name}.{word}" for word in words)])
    numbers = [head.index(f"{name}.{w}") for w in ("stiffness", "stiffness1", "stiffness2")]
    table = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1, usecols=numbers)
    assert len(table) == found.samples
    # A CSV keeps twelve digits of each.
    np.testing.assert_allclose(table[:, 0], table[:, 1] + table[:, 2], rtol=1e-11)
    np.testing.assert_allclose(table[:, 0], single(found).records["stiffness"], rtol=1e-11)


def test_a_missing_channel_of_one_transmission_holds_both(
    device: Device, log: rt.Log, found: rt.Estimate
) -> None:
    theta2 = single_roles(log)["theta2"].copy()
    theta2[LOST] = np.nan
    done = rt.estimate(with_roles(log, theta2=theta2), device, start=START)
    records, clean = single(done).records, single(found).records
    before, lost = records[LOST.start - 1], records[LOST]
    assert np.array_equal(records[: LOST.start], clean[: LOST.start])
    assert np.all(lost["status"] & NOT_FINITE)
    for field in ("stiffness", "stiffness_std", "part_stiffness", "coefficients", "rows"):
        assert np.all(lost[field] == before[field])
    assert records[LOST.stop]["status"] & GAP
    assert not np.any(records[LOST.stop :]["status"] & NOT_FINITE)
    # One second in twenty is not learnt from; the rest is as good as it was.
    truth = single_roles(log)["stiffness_true"][LOST.stop :]
    assert msrep_percent(records["stiffness"][LOST.stop :], truth) <= 0.008
    assert single(done).verdict == "informative"
    assert any("1000 samples" in warning and "NaN" in warning for warning in done.warnings)


def single_roles(log: rt.Log) -> dict[str, np.ndarray]:
    (roles,) = log.joints.values()
    return dict(roles)


def test_a_wrong_zero_of_the_link_is_told_for_each_transmission(
    device: Device, log: rt.Log, found: rt.Estimate
) -> None:
    name = device.joints[0].name
    assert not any("zero of the deflection" in warning for warning in found.warnings)
    askew = with_roles(log, q=single_roles(log)["q"] + SHIFT)
    done = rt.estimate(askew, device)
    told = [w for w in done.warnings if "zero of the deflection" in w]
    assert len(told) == 2
    for end, warning in zip("12", told, strict=True):
        assert warning.startswith(f"joint {name}, transmission {end}: ")
        off = re.search(r"off by (-?[\d.]+) mrad", warning)
        assert off is not None
        # To first order tau(phi - zero) about rest; the motion ends near it. Two digits are told.
        assert float(off[1]) == pytest.approx(-1e3 * SHIFT, rel=0.1)


@pytest.mark.slow
def test_residual_runs_and_weak_is_better(device: Device) -> None:
    weak, residual = [], []
    for seed in SEEDS:
        log = vsa2.motion(device, seed)
        for method, told in (("weak", weak), ("residual", residual)):
            done = single(rt.estimate(log, device, method=method, start=START))
            assert len(done.parts) == 2
            assert done.truth is not None
            told.append(done.truth["msrep_percent"])
    # Its filters lag behind the motors' motion, a bias that seeds share (errata of flacco2012).
    assert all(a < b for a, b in zip(weak, residual, strict=True))
    assert np.median(residual) > 1.5 * np.median(weak)
    # What the paper reached with its own settings, on motor torques: 0.046 %.
    assert max(residual) <= 0.046


def test_both_inertias_are_found_where_the_encoders_see_them() -> None:
    # With the 4059 counts of the device the acceleration is nearly all encoder noise.
    device = with_counts(vsa2.device(), 262144)
    done = single(rt.estimate(vsa2.motion(device, SEEDS[0]), device, fit=["inertia"]))
    assert set(done.fitted) == {"inertia1", "inertia2"}
    for motor, (value, std) in zip(device.joints[0].motors, done.fitted.values(), strict=True):
        assert motor.inertia is not None
        assert std < 0.2 * motor.inertia.value
        assert abs(value - motor.inertia.value) <= 3.0 * std


def test_a_missing_channel_is_named(device: Device, log: rt.Log) -> None:
    with pytest.raises(MethodError, match=r"lacks the channel theta2 of joint vsa-ii"):
        rt.estimate(with_roles(log, theta2=None), device)
    loop = rt.Estimator(device, period=log.period)
    with pytest.raises(MethodError, match=r"update needs theta2 for joint vsa-ii"):
        loop.update(q=0.0, theta1=0.0, tau1=0.0, tau2=0.0)


def catalogue(name: str) -> dict[str, Any]:
    entry = files("rotatum.models") / "catalogue" / f"{name}.toml"
    return tomllib.loads(entry.read_text("utf-8"))


def test_one_device_may_have_joints_of_every_actuation() -> None:
    tables = {
        "pair": catalogue("vsa-ii"),
        "elbow": tomllib.loads(ELBOW),
        "lever": catalogue("awas"),
    }
    alone = {n: device_from_tables({**t, "name": n}, n) for n, t in tables.items()}
    mixed = device_from_tables(
        {"name": "mixed", "joint": [{**t, "name": n} for n, t in tables.items()]}, "mixed"
    )
    drives = {
        "pair": vsa2.PAPER_DRIVES,
        "elbow": {"tau": multisine(rms=5.0, low=0.3, high=10.0, count=20, seed=1)},
        "lever": {"tau": sine(15.0, 0.5), "setpoint": lambda t: 0.09 + 0.01 * np.cos(t)},
    }
    logs = {
        n: simulate_joint(d.joints[0], seconds=6.0, period=1e-3, drives=drives[n], seed=3)
        for n, d in alone.items()
    }
    together = replace(
        logs["pair"],
        joints={n: dict(single_roles(log)) for n, log in logs.items()},
        holds={n: log.holds[n] for n, log in logs.items()},
    )
    batch = rt.estimate(together, mixed)
    # A loop cannot measure its signals beforehand: it is told what the log's are like.
    measured = measure(together.joints, mixed, 1e-3)
    loop = rt.Estimator(mixed, period=1e-3, holds=together.holds, measured=measured)
    assert len(loop.groups) == 3
    found = looped(loop, together, 1500)
    for i, (name, device) in enumerate(alone.items()):
        own = rt.estimate(logs[name], device).joints[name]
        # The same code on the same numbers: to the bit.
        assert np.array_equal(batch.joints[name].records, own.records)
        assert np.array_equal(found["stiffness"][:, i], own.records["stiffness"][:1500])
        assert np.array_equal(found["stiffness_std"][:, i], own.records["stiffness_std"][:1500])
        assert batch.joints[name].verdict == own.verdict
        assert len(batch.joints[name].parts) == (2 if name == "pair" else 1)


def looped(loop: rt.Estimator, log: rt.Log, samples: int) -> dict[str, np.ndarray]:
    """Sample by sample; a channel that a joint does not have is NaN there."""
    nothing = np.full(log.samples, np.nan)
    roles = ("q", "theta", "theta1", "theta2", "setpoint", "tau", "tau1", "tau2")
    u = {r: np.stack([own.get(r, nothing) for own in log.joints.values()], axis=1) for r in roles}
    found: dict[str, list[np.ndarray]] = {"stiffness": [], "stiffness_std": []}
    for k in range(samples):
        out = loop.update(**{r: x[k] for r, x in u.items()}, time=float(log.time[k]))
        for field, values in found.items():
            values.append(out[field].copy())
    return {field: np.array(values) for field, values in found.items()}
