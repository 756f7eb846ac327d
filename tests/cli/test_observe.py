"""`rotatum observe`: table, JSON, states, page, and its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from rotatum import write_table
from tests.cli.runs import run
from tests.evaluation.observed_arms import OWN, own_accelerations, short_arm

STATES = ("q_hat", "dq_hat", "theta_hat", "dtheta_hat", "deflection", "torque", "status")


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Log and device file of the arm with an accelerometer on link 4."""
    folder = tmp_path_factory.mktemp("arm")
    log, _, text = short_arm()
    write_table(folder / "run.csv", log.columns())
    (folder / "arm.toml").write_text(text, "utf-8")
    return folder / "run.csv", folder / "arm.toml"


def without(log: Path, *names: str) -> Path:
    """Write the log without some columns beside it."""
    lines = [line.split(",") for line in log.read_text("utf-8").splitlines()]
    kept = [k for k, name in enumerate(lines[0]) if name not in names]
    path = log.with_name("lacking.csv")
    path.write_text("\n".join(",".join(line[k] for k in kept) for line in lines), "utf-8")
    return path


def test_the_table_tells_peaks_errors_and_settings(arm: tuple[Path, Path]) -> None:
    done = run("observe", arm[0], "-d", arm[1])
    assert done.code == 0
    assert done.err == ""
    rows = {line.split()[0]: line.split() for line in done.out.splitlines() if line.strip()}
    assert rows["axis1"][1] == "yes"
    peak, speed, _, error, most, rigid, _ = (float(x) for x in rows["axis1"][2:9])
    # 5 degrees in 0.3 s twist the gear by mrad and turn the link at rad/s
    assert 1.0 < peak < 20.0
    assert 0.1 < speed < 2.0
    assert error < most < rigid
    for words in ("against the truth", "250 rad/s, damping 0.8", "link4.ax, link4.ay, link4.az"):
        assert words in done.out, words


def test_sensors_are_calibrated_first_if_asked(arm: tuple[Path, Path]) -> None:
    done = run("observe", arm[0], "-d", arm[1], "--calibrate")
    assert done.code == 0
    # The log's sensor is but noisy, 0.02 m/s^2.
    bias = next(line.split() for line in done.out.splitlines() if "bias x" in line)
    assert abs(float(bias[2])) < 5.0 * float(bias[4]) < 0.5
    told = json.loads(run("observe", arm[0], "-d", arm[1], "--calibrate", "--json").out)
    value, std = told["calibration"]["link4"]["bias x"]
    assert value == pytest.approx(float(bias[2]), abs=1e-6)
    assert std == pytest.approx(float(bias[4]), abs=1e-6)


def test_json_states_and_page(arm: tuple[Path, Path], tmp_path: Path) -> None:
    table, page = tmp_path / "states.csv", tmp_path / "page.html"
    done = run(
        "observe", arm[0], "-d", arm[1], "--json", "-o", table, "--report", page,
        "--frequency", 150, "--damping", 0.9, "--gyro", 0, "--from", 0.2,
    )  # fmt: skip
    assert done.code == 0
    told = json.loads(done.out)
    assert list(told) == [
        "log", "device", "sensors", "period", "samples", "seconds", "score_from", "joints",
        "us_per_sample", "warnings",
    ]  # fmt: skip
    assert told["score_from"] == pytest.approx(0.2, abs=1e-9)
    assert told["sensors"] == ["link4.ax", "link4.ay", "link4.az"]
    joint = told["joints"]["axis2"]
    assert list(joint) == [
        "determined", "told_percent", "poles", "gyro", "stiffness", "peak", "status", "score",
    ]  # fmt: skip
    assert joint["poles"] == [{"frequency": 150.0, "damping": 0.9}] * 2
    assert joint["told_percent"] == 100.0
    assert list(joint["score"]) == [
        "of", "q_rms", "q_max", "rigid_rms", "deflection_max", "dq_rms", "dq_max",
    ]  # fmt: skip
    head, *rows = table.read_text("utf-8").splitlines()
    names = [f"axis{k}.{state}" for k in (1, 2, 3) for state in STATES]
    assert head.split(",") == ["time", *names]
    assert len(rows) == told["samples"] == 800
    text = page.read_text("utf-8")
    assert text.startswith("<!DOCTYPE html>")
    assert text.count('class="plot"') == 12


def test_a_joint_with_its_own_acceleration(tmp_path: Path) -> None:
    log, device = tmp_path / "run.csv", tmp_path / "three.toml"
    write_table(log, own_accelerations()[0].columns())
    device.write_text(OWN, "utf-8")
    done = run("observe", log, "-d", device, "--json")
    assert done.code == 0
    told = json.loads(done.out)
    assert told["sensors"] == ["straight.acc", "lever.acc", "hardening.acc"]
    assert told["joints"]["lever"]["score"]["of"] == "truth"


@pytest.mark.parametrize(
    ("lacks", "words"),
    [
        (("link4.ay", "link4.az"), ("link4.ay, link4.az", "the log has link4.ax")),
        (("axis2.tau",), ("tau", "axis2")),
        (("axis3.theta",), ("theta", "axis3")),
    ],
)
def test_missing_columns_are_code_2_by_name(
    arm: tuple[Path, Path], tmp_path: Path, lacks: tuple[str, ...], words: tuple[str, ...]
) -> None:
    table, page = tmp_path / "states.csv", tmp_path / "page.html"
    done = run("observe", without(arm[0], *lacks), "-d", arm[1], "-o", table, "--report", page)
    assert done.code == 2
    assert done.out == ""
    for word in words:
        assert word in done.err, word
    assert list(tmp_path.iterdir()) == []


def test_no_accelerations_at_all_say_what_to_do(arm: tuple[Path, Path], tmp_path: Path) -> None:
    bare = tmp_path / "bare.toml"
    text = arm[1].read_text("utf-8")
    first = text.index("[[accelerometer]]")
    bare.write_text(text[:first] + text[text.index("[[joint]]") :], "utf-8")
    done = run("observe", arm[0], "-d", bare)
    assert done.code == 2
    assert "axis1" in done.err
    assert "[[accelerometer]]" in done.err


def test_a_sensor_that_tells_no_joint_is_code_1(arm: tuple[Path, Path], tmp_path: Path) -> None:
    """On body 1, which turns about the upright through its origin, it shows gravity alone."""
    device = tmp_path / "low.toml"
    text = arm[1].read_text("utf-8").replace('frame = "body4"', 'frame = "body1"')
    first = text.index("position = [", text.index("[[accelerometer]]"))
    last = text.index("]", first)
    device.write_text(f"{text[:first]}position = [0.0, 0.0, 0.0{text[last:]}", "utf-8")
    table = tmp_path / "states.csv"
    done = run("observe", arm[0], "-d", device, "-o", table)
    assert done.code == 1
    assert "axis1, axis2, axis3 are not determined by the sensors" in done.out
    assert "axis1: no sensor determines the acceleration of its link" in done.err
    assert len(table.read_text("utf-8").splitlines()) == 801
    told = json.loads(run("observe", arm[0], "-d", device, "--json").out)
    assert [joint["determined"] for joint in told["joints"].values()] == [False] * 3
    assert told["joints"]["axis1"]["status"]["unseen"] == 800


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--frequency", 5000), "too fast"),
        (("--frequency", -1), "positive"),
        (("--damping", 0), "not stable"),
        (("--accelerations", "joint"), "joints"),
        (("--accelerations", "joints"), "acc"),
        (("--from", 60), "before there is anything to score"),
        (("-o", "states.xls"), ".csv"),
    ],
)
def test_bad_settings_are_code_2_and_leave_nothing(
    arm: tuple[Path, Path], tmp_path: Path, options: tuple[object, ...], words: str
) -> None:
    table = () if "-o" in options else ("-o", tmp_path / "states.csv")
    done = run("observe", arm[0], "-d", arm[1], *table, *options)
    assert done.code == 2
    assert words in done.err
    assert list(tmp_path.iterdir()) == []


def test_readings_that_are_never_numbers_are_code_1(arm: tuple[Path, Path]) -> None:
    log = short_arm()[0]
    columns = log.columns()
    silent = {name: np.full(log.samples, np.nan) for name in columns if name.startswith("link4")}
    path = arm[0].with_name("silent.csv")
    write_table(path, {**columns, **silent})
    done = run("observe", path, "-d", arm[1])
    assert done.code == 1, done.err
    assert "ax of sensor link4 never holds a finite number" in done.err
    assert "NaN" in done.err
