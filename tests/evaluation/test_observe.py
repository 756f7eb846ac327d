"""`observe`: states, scores, peaks and counts over a log, against formulas and plain numpy."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from rotatum import Log, RotatumError, observe, write_table
from rotatum.errors import LogError, MethodError
from rotatum.evaluation import Observation, observed
from rotatum.kernels.status import NOT_FINITE, SETTLING, SINGULAR, UNSEEN
from rotatum.logs import open_log, read_log
from tests.evaluation.observed_arms import own_accelerations, short_arm

JOINTS = ("axis1", "axis2", "axis3")


@lru_cache(maxsize=1)
def short() -> Observation:
    log, device, _ = short_arm()
    return observe(log, device)


@lru_cache(maxsize=1)
def own() -> Observation:
    return observe(*own_accelerations())


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


# --- what is observed -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", JOINTS)
def test_the_arm_is_observed_beyond_its_gears(name: str) -> None:
    """Issue 7's figure is a fifth of the rigid joint's error; noise leaves far less of it here."""
    joint = short().joints[name]
    assert joint.determined
    assert joint.told == 1.0
    assert joint.score is not None
    assert joint.score.of == "truth"
    assert joint.score.q_rms < 0.2 * joint.score.rigid_rms
    assert joint.score.deflection_max < 0.2 * joint.peak["deflection"]


@pytest.mark.parametrize("name", ["straight", "lever", "hardening"])
def test_joints_with_accelerations_of_their_own_follow_the_formula(name: str) -> None:
    """What is left is the straight line taken between samples, ``(w T)^2 / 8`` of a cosine.

    w is 17 rad/s of the deflections: 4e-5 of them. The tangent of a bent spring is that at the
    deflection of one sample's prediction, and a set-point moves 0.1 % a sample: some times more.
    """
    score = own().joints[name].score
    assert score is not None
    assert score.q_rms < 3e-4 * score.rigid_rms
    assert score.dq_rms < 3e-5 * 0.4 * 6.0


def test_the_set_point_is_used_as_the_device_reads_it() -> None:
    log, device = own_accelerations()
    still = {**log.joints, "lever": {**log.joints["lever"], "setpoint": np.full(1000, 20.0)}}
    found = observe(replace(log, joints=still), device).joints["lever"].score
    known = own().joints["lever"].score
    assert found is not None
    assert known is not None
    # The arm is 4 % longer or shorter than said, the spring 8 % stiffer or softer.
    assert found.q_rms > 10.0 * known.q_rms


# --- figures, counted anew ------------------------------------------------------------------------


@pytest.mark.parametrize("start", [None, 0.3])
def test_scores_and_peaks_are_those_of_the_states(start: float | None) -> None:
    log, device, _ = short_arm()
    found = short() if start is None else observe(log, device, start=start)
    for name in JOINTS:
        joint, logged = found.joints[name], log.joints[name]
        states, score = joint.series, joint.score
        scored = (states["status"] & SETTLING) == 0 if start is None else log.time >= start
        off = (states["q_hat"] - logged["q_true"])[scored]
        rigid = (logged["theta_true"] - logged["q_true"])[scored]
        bent = ((states["q_hat"] - states["theta_hat"])[scored]) + rigid
        fast = (states["dq_hat"] - logged["dq_true"])[scored]
        assert score is not None
        told = (score.q_rms, score.rigid_rms, score.dq_rms)
        # sums of a thousand squares, added in another order
        assert told == pytest.approx([rms(off), rms(rigid), rms(fast)], rel=1e-12)
        most = (score.q_max, score.deflection_max, score.dq_max)
        expected = [float(np.abs(x).max()) for x in (off, bent, fast)]
        assert most == pytest.approx(expected, rel=1e-12)
        for key in ("deflection", "dq_hat", "torque"):
            assert joint.peak[key] == np.abs(states[key][scored]).max()
        assert joint.status["settling"] == np.count_nonzero(states["status"] & SETTLING)
    first = int(np.argmax(scored))
    assert found.score_from == pytest.approx(log.time[first] - log.time[0], abs=1e-12)


def test_without_truth_it_is_scored_against_the_encoder_and_not_where_that_wraps() -> None:
    log, device, _ = short_arm()
    joints = {
        name: {role: x for role, x in own.items() if not role.endswith("_true")}
        for name, own in log.joints.items()
    }
    blind = {role: x for role, x in joints["axis3"].items() if role != "q"}
    wrapped = device.joints[1].encoders.model_copy(update={"wrap_link": 6.283185307179586})
    second = device.joints[1].model_copy(update={"encoders": wrapped})
    other = replace(device, joints=(device.joints[0], second, device.joints[2]))
    found = observe(replace(log, joints={**joints, "axis3": blind}), other)
    score, states = found.joints["axis1"].score, found.joints["axis1"].series
    assert score is not None
    assert score.of == "encoder"
    assert np.isnan(score.dq_rms)
    settled = (states["status"] & SETTLING) == 0
    off = (states["q_hat"] - log.joints["axis1"]["q"])[settled]
    assert score.q_rms == pytest.approx(rms(off), rel=1e-12)
    assert found.joints["axis2"].score is None
    assert found.joints["axis3"].score is None
    assert found.joints["axis1"].to_json()["score"]["q_rms"] == score.q_rms
    assert found.to_json()["joints"]["axis1"]["score"]["dq_rms"] is None


def test_a_long_log_keeps_every_second_fourth_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    log, device = own_accelerations()
    monkeypatch.setattr(observed, "KEEP", 3 * 260)
    # The function of the same name hides the module. Batches that four does not divide.
    monkeypatch.setattr(import_module("rotatum.evaluation.observe"), "BATCH", 170)
    thin = observe(log, device).joints["lever"]
    assert thin.every == 4
    for key, values in own().joints["lever"].series.items():
        assert np.array_equal(thin.series[key], values[::4]), key
    known = own().joints["lever"].score
    assert thin.score is not None
    assert known is not None
    # the same squares, added batch by batch
    assert thin.score.dq_rms == pytest.approx(known.dq_rms, rel=1e-12)
    assert thin.score.q_max == known.q_max


# --- logs in pieces, tables -----------------------------------------------------------------------


def test_pieces_of_a_log_and_the_whole_are_the_same_bit_for_bit(tmp_path: Path) -> None:
    log, device, _ = short_arm()
    path = tmp_path / "log.npz"
    write_table(path, log.columns())
    whole = observe(read_log(path, device, true_states=True), device)
    table = tmp_path / "states.csv"
    apart = observe(open_log(path, device, chunk=170, true_states=True), device, output=table)
    for name in JOINTS:
        one, other = whole.joints[name], apart.joints[name]
        assert one.series.keys() == other.series.keys()
        for key, values in one.series.items():
            assert np.array_equal(values, other.series[key]), key
        assert one.peak == other.peak
        assert one.status == other.status
    head, first = table.read_text("utf-8").splitlines()[:2]
    assert head.split(",") == [
        "time",
        *(f"{name}.{key}" for name in JOINTS for key in (
            "q_hat", "dq_hat", "theta_hat", "dtheta_hat", "deflection", "torque", "status",
        )),
    ]  # fmt: skip
    assert len(first.split(",")) == 1 + 3 * 7
    apart.write(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == table.read_bytes()


# --- what the sensors do not tell -----------------------------------------------------------------


def test_silent_accelerometers_tell_nothing() -> None:
    log, device, _ = short_arm()
    silent = {"link4": {axis: np.full(log.samples, np.nan) for axis in ("ax", "ay", "az")}}
    found = observe(replace(log, inertial=silent), device)
    assert not found.observed
    for joint in found.joints.values():
        assert joint.determined
        assert joint.told == 0.0
        assert np.all(joint.series["status"] & NOT_FINITE)
        assert np.all(np.isfinite(joint.series["q_hat"]))
    assert any("not_finite" in text or "NaN" in text for text in found.warnings)


def test_a_spell_without_readings_lowers_the_share() -> None:
    log, device = own_accelerations()
    acc = log.joints["straight"]["acc"].copy()
    acc[500:700] = np.nan
    joints = {**log.joints, "straight": {**log.joints["straight"], "acc": acc}}
    found = observe(replace(log, joints=joints), device)
    joint = found.joints["straight"]
    bad = (joint.series["status"] & (SINGULAR | UNSEEN)) != 0
    scored = (joint.series["status"] & SETTLING) == 0
    assert 0 < np.count_nonzero(bad) <= 200
    assert joint.told == pytest.approx(1.0 - bad[scored].mean(), abs=1e-12)
    assert found.observed


# --- what is refused ------------------------------------------------------------------------------


def lacking(log: Log, joint: str, role: str) -> Log:
    kept = {k: x for k, x in log.joints[joint].items() if k != role}
    return replace(log, joints={**log.joints, joint: kept})


@pytest.mark.parametrize("role", ["theta", "tau", "acc", "setpoint"])
def test_a_missing_channel_is_named(role: str) -> None:
    log, device = own_accelerations()
    with pytest.raises(MethodError, match=rf"lacks the channel {role} of joint lever"):
        observe(lacking(log, "lever", role), device)


def test_missing_readings_are_named() -> None:
    log, device, _ = short_arm()
    only = {"link4": {"ax": log.inertial["link4"]["ax"]}}
    with pytest.raises(MethodError, match=r"link4\.ay, link4\.az.*the log has link4\.ax"):
        observe(replace(log, inertial=only), device)


def test_a_log_that_ends_too_early_leaves_no_table(tmp_path: Path) -> None:
    log, device = own_accelerations(0.02)
    table = tmp_path / "states.csv"
    with pytest.raises(LogError, match="before there is anything to score"):
        observe(log, device, output=table)
    with pytest.raises(LogError, match="before there is anything to score"):
        observe(*own_accelerations(0.3), start=0.3, output=table)
    assert list(tmp_path.iterdir()) == []


def test_other_actuations_and_sources_are_refused() -> None:
    log, device = own_accelerations()
    with pytest.raises(RotatumError, match="accelerometer"):
        observe(log, device, accelerations="accelerometers")
    with pytest.raises(MethodError, match="no such joint"):
        observe(replace(log, joints={"elbow": log.joints["lever"]}), device)
