"""`rotatum characterise`: tables, JSON, the device file, the page, and its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rotatum import load_device, write_table
from tests.cli.runs import run
from tests.evaluation.torque_sweeps import NAME, log_of, qbmove


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "sweep.csv"
    write_table(path, log_of(qbmove(samples=200)).columns())
    return path


def test_the_tables_tell_constants_and_presets(log: Path) -> None:
    done = run("characterise", log, "-d", NAME)
    assert done.code == 0
    for word in ("k1", "a2", "offset", "1/rad", "preset", "c %", "below floor", "variance"):
        assert word in done.out, word


def test_json_device_and_page(log: Path, tmp_path: Path) -> None:
    device, page = tmp_path / "fitted.toml", tmp_path / "page.html"
    done = run("characterise", log, "-d", NAME, "--json", "-o", device, "--report", page)
    assert done.code == 0
    told = json.loads(done.out)["joints"][NAME]
    assert told["answered"] is True
    spring = load_device(device).joints[0].transmissions[1]
    assert spring.law == "sinh"
    assert spring.given["a"][0] == told["constants"]["a2"]["value"]
    assert "relative rms" in device.read_text("utf-8")
    text = page.read_text("utf-8")
    assert text.startswith("<!DOCTYPE html>")
    assert text.count('class="plot"') == 2


def test_constants_that_are_not_told_are_code_1_and_no_file(tmp_path: Path) -> None:
    log, device = tmp_path / "small.csv", tmp_path / "fitted.toml"
    write_table(log, log_of(qbmove(presets=(0.0, 0.02), reach=0.05, samples=200)).columns())
    done = run("characterise", log, "-d", NAME, "-o", device, "--json")
    assert done.code == 1
    told = json.loads(done.out)["joints"][NAME]
    assert told["constants"]["k1"] == {"value": None, "std": None, "unit": "N m"}
    assert told["confounded"] == ["k1", "a1", "k2", "a2"]
    assert set(told["together"]) <= {"k1 a1", "k2 a2"}
    assert not device.exists()
    assert "is not written" in done.err
    done = run("characterise", log, "-d", NAME)
    assert "not told" in done.out
    assert "--tied" in done.out


def test_bad_input_is_code_2_and_names_the_nearest(log: Path, tmp_path: Path) -> None:
    device = tmp_path / "fitted.toml"
    for options, words in (
        (("--law", "snih"), "Did you mean 'sinh'"),
        (("--law", "lever"), "depends on a set-point"),
        (("--fix", "k"), "NAME=VALUE"),
        (("--fix", "k=-1"), "greater than 0"),
        (("--fix", "a=nan"), "a finite number"),
        (("--fit", "zeros"), "Did you mean 'zero'"),
        (("--max-speed", "0"), "--max-speed"),
        (("--terms", "0", "--law", "polynomial"), "1 to 8"),
    ):
        done = run("characterise", log, "-d", NAME, "-o", device, *options)
        assert done.code == 2, options
        assert words in done.err
        assert not device.exists()
