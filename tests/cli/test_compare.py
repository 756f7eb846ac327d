"""`rotatum compare`, and the settings of both sides and of windows on every verb that has them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from rotatum import write_table
from tests.cli.conftest import Scene
from tests.cli.runs import run
from tests.report.scenes import DEVICE, STIFFNESS, small_log


def test_the_table_tells_every_method_and_what_is_left_out(scene: Scene) -> None:
    log = small_log().columns()
    del log["elbow.torque_measured"]
    write_table(scene.log, log)
    done = run("compare", scene.log, "--device", scene.device, "--from", 2, "--window", 0.2)
    assert done.code == 0
    words = ("algebraic", "residual", "weak, window", "link", "MSREP", "Left out", "Recommended")
    for word in words:
        assert word in done.out, word
    assert "weak, torque sensor, motor side: the log has no torque_measured." in done.out
    assert "elbow: scored from 2 s on, against the log's truth" in done.out
    assert "elbow: --method weak" in done.out


def test_json_report_and_table(scene: Scene) -> None:
    table, report = scene.folder / "table.csv", scene.folder / "report.html"
    done = run(
        "compare", scene.log, "-d", scene.device, "--json", "-o", table, "--report", report,
        "--cutoff", 200, "--window", 0.2, "--fit", "offset", "--joint", "elbow",
    )  # fmt: skip
    assert done.code == 0
    told = json.loads(done.out)["joints"]["elbow"]
    assert len(told["methods"]) == 8
    assert "200 rad/s" in told["methods"][0]["width"]
    assert told["recommendation"]["torque"] == "sensor"
    assert len(table.read_text("utf-8").splitlines()) == 9
    page = report.read_text("utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert "Methods compared on elbow" in page


def test_nothing_informative_is_code_1(scene: Scene) -> None:
    log = small_log()
    still = {"time": log.time, "elbow.q": np.zeros(log.samples), "elbow.theta": np.zeros(4000)}
    write_table(scene.log, still)
    done = run("compare", scene.log, "-d", scene.device)
    assert done.code == 1
    assert "starved" in done.out
    assert "does not change" in done.out


def test_nothing_that_can_run_is_code_2(scene: Scene) -> None:
    scene.device.write_text(DEVICE.replace("inertia = 0.8\n", ""))
    log = small_log().columns()
    write_table(scene.log, {k: log[k] for k in ("time", "elbow.q", "elbow.theta")})
    done = run("compare", scene.log, "-d", scene.device)
    assert done.code == 2
    assert "no method can estimate this log" in done.err
    assert done.out == ""


def test_a_table_of_no_known_kind_is_refused_before_the_work(scene: Scene) -> None:
    done = run("compare", scene.log, "-d", scene.device, "-o", scene.folder / "table.xls")
    assert done.code == 2
    assert ".csv" in done.err


@pytest.mark.parametrize(
    ("options", "side", "words"),
    [
        (("--side", "link"), "link", "300 rad/s"),
        (("--side", "link", "--window", 0.2), "link", "over 0.2 s"),
        (("--method", "algebraic", "--window", 0.2), "motor", "slope"),
        (("--window", 0.2, "--order", 3, "--stride", 20), "motor", "a row every 20 ms"),
    ],
)
def test_estimate_takes_sides_and_windows(
    scene: Scene, options: tuple[object, ...], side: str, words: str
) -> None:
    done = run("estimate", scene.log, "-d", scene.device, *options)
    assert done.code == 0
    assert f"{side} side" in done.out
    assert words in done.out
    told = json.loads(run("estimate", scene.log, "-d", scene.device, *options, "--json").out)
    joint = told["joints"]["elbow"]
    # noise of a per cent on the torque leaves the stiffness of 4 s better than one per cent
    assert joint["stiffness"]["final"] == pytest.approx(STIFFNESS, rel=0.01)
    assert joint["delay"] == pytest.approx(0.1 if "--window" in options else 0.008, abs=0.004)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--side", "left"), "motor"),
        (("--side", "link", "--method", "residual"), "motor"),
        (("--window", 0.2, "--cutoff", 100), "not both"),
        (("--method", "residual", "--window", 0.2), "cutoff"),
        (("--stride", 5), "only a window"),
        (("--solver", "continous"), 'Did you mean "continuous"'),
    ],
)
def test_what_does_not_fit_together_is_refused(
    scene: Scene, options: tuple[object, ...], told: str
) -> None:
    done = run("estimate", scene.log, "-d", scene.device, *options)
    assert done.code == 2
    assert told in done.err
