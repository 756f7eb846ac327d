"""`rotatum.compare`: what runs, what is left out and why, and that all are scored alike.

Everything runs on the small joint of the reports' scenes: one basis term and an offset.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from rotatum import Comparison, Device, Log, RotatumError, compare
from rotatum.errors import MethodError
from rotatum.evaluation import msrep_percent
from rotatum.evaluation.candidates import CANDIDATES, Widths, variant
from tests.report.scenes import DEVICE, PERIOD, SECONDS, STIFFNESS, small_device, small_log

MOTOR = ("weak", "weak, window", "algebraic", "residual")


@lru_cache(maxsize=1)
def compared() -> Comparison:
    return compare(small_log(), small_device(), window=0.2)


def without(roles: Sequence[str], log: Log | None = None) -> Log:
    full = log or small_log()
    joints = {
        name: {role: x for role, x in channels.items() if role not in roles}
        for name, channels in full.joints.items()
    }
    return replace(full, joints=joints)


def device_without(*lines: str) -> Device:
    text = DEVICE
    for line in lines:
        assert line in text
        text = text.replace(line, "")
    return small_device(text)


def test_every_method_runs_on_a_log_that_has_everything() -> None:
    found = compared()
    assert [m.label for m in found.methods] == [c.label for c in CANDIDATES]
    assert not found.left_out
    assert found.joints == ("elbow",)
    assert found.samples == round(SECONDS / PERIOD)


@pytest.mark.parametrize("label", [c.label for c in CANDIDATES if c.method != "residual"])
def test_methods_without_lag_meet_the_truth(label: str) -> None:
    (found,) = (m for m in compared().methods if m.label == label)
    # noise of a per cent on the torque leaves the stiffness of 4 s better than one per cent
    assert found.stiffness == pytest.approx(STIFFNESS, rel=0.01)


def test_scores_are_those_of_the_samples_from_the_common_start() -> None:
    found = compared()
    start = found.score_from["elbow"]
    known = [m.converged_at for m in found.methods if m.converged_at is not None]
    assert start == max(known)
    for method in found.methods:
        scored = method.curve.time >= start
        sigma = method.curve.stiffness[scored]
        assert method.truth is not None
        assert method.truth["msrep_percent"] == pytest.approx(msrep_percent(sigma, STIFFNESS))


def test_the_reference_is_the_narrowest_informative_one() -> None:
    found = compared()
    good = [m for m in found.methods if m.verdict == "informative"]
    narrowest = min(good, key=lambda m: m.stiffness_std)
    assert found.references["elbow"] == narrowest.label
    assert narrowest.disagreement is None
    assert all(m.disagreement for m in found.methods if m is not narrowest)


def test_what_the_log_lacks_is_said_and_no_error() -> None:
    found = compare(without(["tau", "torque_measured"]), small_device(), start=2.0)
    assert {m.side for m in found.methods} == {"link"}
    told = {(out.name, out.side): out.why for out in found.left_out}
    assert {name for name, _ in told} == {*MOTOR, "weak, torque sensor"}
    assert all("the log has no tau" in told[name, "motor"] for name in MOTOR)
    assert "torque_measured" in told["weak, torque sensor", "motor"]
    assert found.score_from["elbow"] == 2.0


def test_what_the_device_lacks_is_said() -> None:
    device = device_without("inertia = 0.8\n", "inertia = 4e-5\n")
    found = compare(without(["stiffness_true"]), device, start=2.0)
    assert [m.label for m in found.methods] == ["weak, torque sensor, motor side"]
    assert all(m.truth is None for m in found.methods)
    told = {(out.name, out.side): out.why for out in found.left_out}
    assert "motor's inertia" in told["residual", "motor"]
    assert "link's inertia" in told["weak", "link"]
    assert "link's inertia" in told["rotatum", "link"]


def test_nothing_that_can_run_is_an_error_with_all_reasons() -> None:
    device = device_without("inertia = 0.8\n")
    with pytest.raises(MethodError, match="no method can estimate") as caught:
        compare(without(["tau", "torque_measured"]), device)
    assert "no tau" in str(caught.value)
    assert "link's inertia" in str(caught.value)


def test_each_method_takes_of_the_fit_what_it_can() -> None:
    text = DEVICE.replace('fit = ["offset"]', 'fit = ["damping", "offset"]')
    device = small_device(text)
    fits = {}
    for candidate in CANDIDATES:
        told = variant(device, candidate, Widths())
        fits[candidate.label] = told.joints[0].estimator.fit
    assert fits["weak, motor side"] == ("damping", "offset")
    assert fits["algebraic, motor side"] == ("damping",)
    assert fits["residual, motor side"] == ("offset",)
    assert fits["weak, link side"] == ("offset",)
    only = variant(device, CANDIDATES[-1], Widths(fit=("inertia",)))
    assert only.joints[0].estimator.fit is None, "its own default where nothing of it can be"


def test_widths_go_to_the_methods_that_have_them() -> None:
    widths = Widths(cutoff=100.0, window=0.3)
    for candidate in CANDIDATES:
        told = variant(small_device(), candidate, widths).joints[0].estimator
        if candidate.windowed:
            assert (told.cutoff, told.window) == (None, 0.3)
        else:
            assert (told.cutoff, told.window) == (100.0, None)


def test_a_filed_cutoff_is_the_low_passes_or_the_observers() -> None:
    rotatum = next(c for c in CANDIDATES if c.method == "rotatum")
    weak = CANDIDATES[0]
    own = DEVICE.replace('"weak"\ncutoff = 300.0', '"rotatum"\nside = "link"\ncutoff = 80.0')
    own = own.replace('fit = ["offset"]\n', "")
    for text, expected in ((DEVICE, (300.0, None)), (own, (None, 80.0))):
        device = small_device(text)
        told = [variant(device, one, Widths()).joints[0].estimator for one in (weak, rotatum)]
        assert tuple(one.cutoff for one in told) == expected


def test_an_unknown_quantity_is_refused() -> None:
    with pytest.raises(RotatumError, match="inertia"):
        compare(small_log(), small_device(), fit=("intertia",))


def test_json_is_finite_and_complete() -> None:
    told = json.loads(json.dumps(compared().to_json(), allow_nan=False))
    joint = told["joints"]["elbow"]
    assert set(joint) == {"score_from", "reference", "methods", "left_out", "recommendation"}
    keys = {
        "name", "method", "side", "torque", "width", "stiffness", "stiffness_std", "verdict",
        "reason", "converged_at", "delay", "ns_per_sample", "fitted", "truth", "disagreement",
    }  # fmt: skip
    assert all(set(method) == keys for method in joint["methods"])
    assert "0.2 s" in joint["methods"][1]["width"]
    assert "(" not in joint["methods"][0]["width"]


def test_the_table_is_written(tmp_path: Path) -> None:
    path = tmp_path / "table.npz"
    compared().write(path)
    with np.load(path) as written:
        assert list(written["name"]) == [m.name for m in compared().methods]
        assert list(written["stiffness"]) == [m.stiffness for m in compared().methods]


def test_progress_names_the_method_and_comes_to_its_end() -> None:
    seen: dict[str, int] = {}

    def progress(label: str, done: int, expected: int | None) -> None:
        seen[label] = done
        assert expected == small_log().samples

    compare(without(["tau", "torque_measured"]), small_device(), start=2.0, progress=progress)
    labels = ["weak, link side", "weak, window, link side", "rotatum, link side"]
    assert seen == dict.fromkeys(labels, small_log().samples)
