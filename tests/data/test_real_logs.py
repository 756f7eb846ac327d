"""The public logs, where a copy is at hand: what must come out of them, and what must not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotatum as rt
from rotatum.evaluation import JointEstimate

Find = Callable[[str], Path]
BENCH = "utokyo-two-inertia/MultisineTypeA.mat"


def run(project: Path, path: Path, device: str, **options: Any) -> rt.Estimate:
    found = rt.load_device(project / "examples" / "devices" / f"{device}.toml")
    return rt.estimate(rt.read_log(path, found), found, **options)


# A fit of a two-inertia model to the frequency response of the bench gives 544.8 A/rad, a second
# recording 548.8; a batch weak-form fit 549.5: the answer has to lie about these.
@pytest.mark.parametrize("cutoff", [300.0, 1000.0, 3000.0])
def test_bench_at_any_cutoff(project: Path, shared_data: Find, cutoff: float) -> None:
    joint = one(run(project, shared_data(BENCH), "utokyo-two-inertia", cutoff=cutoff))
    assert 535.0 <= joint.stiffness["final"] <= 555.0
    assert joint.stiffness_std < 0.02 * joint.stiffness["final"]
    assert joint.verdict == "informative"


@pytest.mark.parametrize("fit", [("inertia", "damping"), ("inertia", "damping", "offset")])
def test_bench_with_inertia_fitted(project: Path, shared_data: Find, fit: tuple[str, ...]) -> None:
    joint = one(run(project, shared_data(BENCH), "utokyo-two-inertia", fit=fit))
    assert 530.0 <= joint.stiffness["final"] <= 560.0
    # Of the frequency response's 4.76e-3 A s^2/rad.
    assert joint.fitted["inertia"][0] == pytest.approx(4.76e-3, rel=0.04)
    assert joint.verdict == "informative"


@pytest.mark.parametrize("fit", [("offset",), ("link_damping", "offset")])
def test_bench_from_the_load_alone(project: Path, shared_data: Find, fit: tuple[str, ...]) -> None:
    """No current is read: the load's own motion and its inertia give the stiffness."""
    joint = one(run(project, shared_data(BENCH), "utokyo-two-inertia", side="link", fit=fit))
    assert 540.0 <= joint.stiffness["final"] <= 552.0
    # All of the torque is made of the load's inertia, which is known to 1 %.
    assert joint.stiffness_std >= 0.01 * joint.stiffness["final"]
    assert joint.verdict == "informative"


def test_both_sides_of_the_bench_agree_within_their_intervals(
    project: Path, shared_data: Find
) -> None:
    path = shared_data(BENCH)
    motor = one(run(project, path, "utokyo-two-inertia", fit=("inertia", "damping", "offset")))
    load = one(
        run(project, path, "utokyo-two-inertia", side="link", fit=("link_damping", "offset"))
    )
    apart = abs(motor.stiffness["final"] - load.stiffness["final"])
    assert apart <= 1.96 * (motor.stiffness_std**2 + load.stiffness_std**2) ** 0.5


@pytest.mark.parametrize("fit", [(), ("offset",)])
def test_bench_residual_is_biased_and_says_so(
    project: Path, shared_data: Find, fit: tuple[str, ...]
) -> None:
    joint = one(
        run(
            project,
            shared_data(BENCH),
            "utokyo-two-inertia",
            method="residual",
            cutoff=300.0,
            fit=fit,
        )
    )
    assert joint.stiffness["final"] < 300.0
    assert joint.verdict == "inconsistent"
    assert "delayed copy" in joint.reason


def one(estimate: rt.Estimate) -> JointEstimate:
    (joint,) = estimate.joints.values()
    return joint


@pytest.fixture(scope="module")
def arm(project: Path, shared_data: Find) -> dict[str, rt.Estimate]:
    path = "kuka-kr300/KR300_{}.npz"
    return {r: run(project, shared_data(path.format(r)), "kuka-kr300") for r in "AB"}


@pytest.mark.parametrize("axis", ["a2", "a3"])
def test_arm_axes_agree_between_runs(arm: dict[str, rt.Estimate], axis: str) -> None:
    first, second = arm["A"].joints[axis], arm["B"].joints[axis]
    for joint in (first, second):
        assert joint.verdict in ("converging", "informative")
        skew, _ = joint.fitted["skew"]
        assert 2.5e-3 <= skew <= 3.4e-3
    gap = abs(first.stiffness["final"] - second.stiffness["final"])
    assert gap <= 1.96 * np.hypot(first.stiffness_std, second.stiffness_std)


def test_arm_axis_1(arm: dict[str, rt.Estimate]) -> None:
    refused, joint = arm["A"].joints["a1"], arm["B"].joints["a1"]
    assert refused.verdict in ("starved", "inconsistent")
    assert refused.stiffness["final"] < 0.0
    assert "negative" in refused.reason
    # The maker's value.
    assert abs(joint.stiffness["final"] - 4.58e6) <= 1.96 * joint.stiffness_std


def test_arm_says_that_skew_and_friction_are_one_column(arm: dict[str, rt.Estimate]) -> None:
    told = [w for w in arm["B"].warnings if w.startswith("joint a3") and "skew" in w]
    assert len(told) == 1
    assert "viscous friction is the same column" in told[0]


def test_unloaded_actuator_is_starved(project: Path, shared_data: Find) -> None:
    estimate = run(project, shared_data("hebi-unloaded/exampleLog.npz"), "hebi-x5-1")
    joint = one(estimate)
    assert not estimate.informative
    assert joint.verdict == "starved"
    assert "the spring moves less than q - theta can be trusted" in joint.reason


def test_units_do_not_matter(project: Path, shared_data: Find, tmp_path: Path) -> None:
    """Show 6: radians and newton metres, or degrees and newton millimetres: 1e-9 alike."""
    path = shared_data(BENCH)
    device = rt.load_device(project / "examples" / "devices" / "utokyo-two-inertia.toml")
    log = rt.read_log(path, device)
    (roles,) = log.joints.values()
    rt.write_table(
        tmp_path / "log.npz",
        {
            "ms": 1e3 * log.time,
            "q": np.rad2deg(roles["q"]),
            "theta": np.rad2deg(roles["theta"]),
            "tau": 1e3 * roles["tau"],
        },
    )
    text = (project / "examples" / "devices" / "utokyo-two-inertia.toml").read_text()
    head = text[: text.index("[channels]")]
    (tmp_path / "device.toml").write_text(
        head + '[channels]\ntime = { name = "ms", unit = "ms" }\n'
        'q = { name = "q", unit = "deg" }\ntheta = { name = "theta", unit = "deg" }\n'
        'tau = { name = "tau", unit = "N mm" }\n'
    )
    other = rt.load_device(tmp_path / "device.toml")
    first = one(rt.estimate(log, device))
    second = one(rt.estimate(rt.read_log(tmp_path / "log.npz", other), other))
    assert second.stiffness["final"] == pytest.approx(first.stiffness["final"], rel=1e-9)
    assert second.stiffness_std == pytest.approx(first.stiffness_std, rel=1e-9)
    assert second.verdict == first.verdict
