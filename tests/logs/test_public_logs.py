"""The public logs, read with the example device files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rotatum.logs import Log, read_log
from rotatum.models import load_device

Find = Callable[[str], Path]


def _read(project: Path, log: Path, device: str) -> Log:
    return read_log(log, load_device(project / "examples" / "devices" / f"{device}.toml"))


def test_two_inertia_bench(project: Path, shared_data: Find) -> None:
    path = shared_data("utokyo-two-inertia/MultisineTypeA.mat")
    log = _read(project, path, "utokyo-two-inertia")
    joint = log.joints["utokyo-two-inertia"]
    assert log.samples == 50_000
    assert log.period == pytest.approx(4e-4, rel=1e-9)
    assert log.warnings == ()
    # The encoders' zeros differ by 6.85 rad.
    assert np.mean(joint["q"] - joint["theta"]) == pytest.approx(6.85, abs=0.005)


@pytest.mark.parametrize("run", ["A", "B"])
def test_kuka(run: str, project: Path, shared_data: Find) -> None:
    path = shared_data(f"kuka-kr300/KR300_{run}.npz")
    log = _read(project, path, "kuka-kr300")
    assert list(log.joints) == ["a1", "a2", "a3"]
    assert log.samples == 2501
    assert log.warnings == ()
    for roles in log.joints.values():
        # 1 to 3 mrad of deflection, and torques of a large arm at the joint.
        assert 1e-3 < np.ptp(roles["q"] - roles["theta"]) < 4e-3
        assert 1e3 < np.abs(roles["tau"]).max() < 1e4


def test_the_recording_and_its_conversion_are_the_same(project: Path, shared_data: Find) -> None:
    original = shared_data("kuka-kr300/2020-10-21_10s_FF_A_data.mat")
    converted = shared_data("kuka-kr300/KR300_A.npz")
    first = _read(project, original, "kuka-kr300-mat")
    second = _read(project, converted, "kuka-kr300")
    for joint, roles in second.joints.items():
        for role, values in roles.items():
            assert np.array_equal(first.joints[joint][role], values)


def test_hebi(project: Path, shared_data: Find) -> None:
    log = _read(project, shared_data("hebi-unloaded/exampleLog.npz"), "hebi-x5-1")
    joint = log.joints["hebi-x5-1"]
    assert log.samples == 999
    assert log.period == pytest.approx(0.01, rel=0.002)
    assert any("uneven" in warning for warning in log.warnings)
    # Once the gear is taken out, both encoders tell the same angle but for a constant.
    assert np.std(joint["q"] - joint["theta"]) < 0.01 < np.std(joint["q"])
    assert set(joint) == {"q", "theta", "torque_measured"}
