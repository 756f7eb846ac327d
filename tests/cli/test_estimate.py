"""`rotatum estimate`: what it prints, writes and returns when the input is good."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from rotatum import read_log, write_table
from tests.cli.conftest import Scene
from tests.cli.runs import run
from tests.report.scenes import STIFFNESS, small_device, small_estimate, small_log

JOINT_KEYS = {
    "stiffness", "stiffness_std", "torque_rms", "coefficients", "verdict", "converged_at",
    "fitted", "truth", "ns_per_sample",
}  # fmt: skip


def test_json_is_the_object_of_the_estimate(scene: Scene) -> None:
    done = run("estimate", scene.log, "--device", scene.device, "--json")
    assert done.code == 0
    told = json.loads(done.out)
    assert set(told) >= {
        "log", "device", "method", "side", "period", "samples", "seconds", "joints", "warnings"
    }  # fmt: skip
    joint = told["joints"]["elbow"]
    assert set(joint) >= JOINT_KEYS
    assert set(joint["stiffness"]) == {"final", "mean", "min", "max"}
    assert joint["verdict"] == "informative"
    # noise of a per cent on the torque leaves the stiffness of 4 s better than one per cent
    assert joint["stiffness"]["final"] == pytest.approx(STIFFNESS, rel=0.01)
    assert told["log"] == str(scene.log)
    same = small_estimate().joints["elbow"].to_json()
    # the CSV keeps 12 digits
    assert joint["stiffness"]["final"] == pytest.approx(same["stiffness"]["final"], rel=1e-6)


def test_table_tells_answer_reason_and_truth(scene: Scene) -> None:
    done = run("estimate", scene.log, "--device", scene.device)
    assert done.code == 0
    for word in ("elbow", "N m/rad", "informative", "offset", "MSREP %"):
        assert word in done.out
    assert "elbow: informative: 200" in done.out
    assert not done.out.startswith("{")


def test_a_log_that_cannot_answer_is_code_1_and_tells_all_the_same(scene: Scene) -> None:
    log = small_log()
    still = {role: np.zeros(log.samples) for role in ("q", "theta", "tau")}
    write_table(scene.log, replace(log, joints={"elbow": still}).columns())
    done = run("estimate", scene.log, "--device", scene.device, "--json")
    assert done.code == 1
    assert json.loads(done.out)["joints"]["elbow"]["verdict"] == "starved"
    done = run("estimate", scene.log, "--device", scene.device)
    assert done.code == 1
    assert "starved" in done.out
    assert "elbow" in done.err, "a constant channel is worth a warning"


@pytest.mark.parametrize("ending", [".csv", ".npz"])
def test_every_sample_is_written(scene: Scene, ending: str) -> None:
    out = scene.folder / f"out{ending}"
    done = run("estimate", scene.log, "--device", scene.device, "-o", out, "--json")
    assert done.code == 0
    if ending == ".npz":
        with np.load(out) as written:
            columns = {name: written[name] for name in written.files}
    else:
        table = np.genfromtxt(out, delimiter=",", names=True, dtype=None, encoding="utf-8")
        columns = {name: table[name] for name in table.dtype.names}
        columns = {name.replace("elbow", "elbow.", 1): x for name, x in columns.items()}
    assert len(columns["time"]) == small_log().samples
    final = json.loads(done.out)["joints"]["elbow"]["stiffness"]["final"]
    assert columns["elbow.stiffness"][-1] == pytest.approx(final, rel=1e-11)
    assert columns["elbow.verdict"][-1] == "informative"


def test_the_report_is_written(scene: Scene) -> None:
    report = scene.folder / "report.html"
    done = run("estimate", scene.log, "-d", scene.device, "--report", report)
    assert done.code == 0
    assert report.read_text("utf-8").startswith("<!DOCTYPE html>")


def test_options_reach_the_estimator(scene: Scene) -> None:
    done = run(
        "estimate", scene.log, "--device", scene.device, "--cutoff", 500, "--forgetting", 0.9999,
        "--from", 3.0, "--joint", "elbow", "--fit", "offset", "--method", "weak", "--side",
        "motor", "--torque", "estimated", "--solver", "ud", "--json",
    )  # fmt: skip
    assert done.code == 0
    joint = json.loads(done.out)["joints"]["elbow"]
    assert joint["stiffness"]["final"] == pytest.approx(STIFFNESS, rel=0.01)


def test_warnings_go_to_standard_error(scene: Scene) -> None:
    log = read_log(scene.log, small_device())
    keep = np.ones(log.samples, bool)
    keep[2000:2100] = False
    write_table(scene.log, {name: x[keep] for name, x in log.columns().items()})
    done = run("estimate", scene.log, "--device", scene.device, "--json")
    assert "warning: " in done.err
    assert json.loads(done.out)["warnings"]


def test_sensors_of_the_links_are_not_read(scene: Scene) -> None:
    arm = '[robot]\nmodel = "pendulum"\nlengths = [0.5]\nmasses = [1.0]\n'
    imu = '[[accelerometer]]\nname = "imu"\nframe = "tip"\nchannels = { ax = "not there" }\n'
    scene.device.write_text(f"{scene.device.read_text()}\n{arm}{imu}")
    done = run("estimate", scene.log, "--device", scene.device, "--json")
    assert done.code == 0
    assert "imu" not in done.err
    assert json.loads(done.out)["warnings"] == []
    same = small_estimate().joints["elbow"].to_json()["stiffness"]["final"]
    found = json.loads(done.out)["joints"]["elbow"]["stiffness"]["final"]
    assert found == pytest.approx(same, rel=1e-6)  # the CSV keeps 12 digits


def test_a_report_that_fails_at_the_end_costs_no_result(scene: Scene) -> None:
    full = scene.folder / "full.html"
    full.symlink_to("/dev/full")
    done = run("estimate", scene.log, "--device", scene.device, "--report", full)
    assert done.code == 2
    assert "informative" in done.out
    assert "No space left" in done.err
