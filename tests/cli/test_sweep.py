"""`rotatum sweep`: from a scenario's file to a table, a summary and an exit code."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from rotatum import estimate
from rotatum.cli import sweep as module
from rotatum.simulation.scenario import load_scenario
from tests.cli.runs import Outcome, run
from tests.report.scenes import DEVICE, STIFFNESS

SCENARIO = """\
device = "elbow.toml"
seconds = 3.0
period = 1e-3
seed = 5

[drives.tau]
kind = "multisine"
rms = 5.0
low = 0.3
high = 10.0
count = 20

[sensors]
encoders = { link = 65536, motor = 1310720 }
noise = { tau = 0.05 }

[estimate]
method = "weak"
start = 1.0
"""


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")  # a narrow terminal folds the keys


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    (tmp_path / "elbow.toml").write_text(DEVICE, "utf-8")
    path = tmp_path / "shaken.toml"
    path.write_text(SCENARIO, "utf-8")
    return path


def swept(scenario: Path, *arguments: object, table: str = "table.csv") -> Outcome:
    output = scenario.parent / table
    return run("sweep", scenario, "-o", output, "--workers", 1, *arguments)


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_table_of_all_combinations_and_their_truth(scenario: Path) -> None:
    done = swept(scenario, "--vary", "sensors.encoders.link=1024,65536", "--seeds", 2)
    assert done.code == 0, done.err
    rows = read(scenario.parent / "table.csv")
    assert [row["case"] for row in rows] == ["0", "1", "2", "3"]
    assert [row["sensors.encoders.link"] for row in rows] == ["1024", "1024", "65536", "65536"]
    assert [row["seed"] for row in rows] == ["5", "6", "5", "6"]
    assert {row["joint"] for row in rows} == {"elbow"}
    assert {row["status"] for row in rows} == {"ok"}
    assert all(float(row["stiffness_true"]) == STIFFNESS for row in rows)
    # The truth lies within five standard deviations of every fine case.
    for row in rows[2:]:
        assert row["verdict"] == "informative"
        assert abs(float(row["stiffness"]) - STIFFNESS) < 5.0 * float(row["stiffness_std"])
    assert "0 of 4 cases" in done.err
    assert "4 of 4 cases" in done.err
    assert "sensors.encoders.link" in done.out
    assert "100 %" in done.out


def test_a_case_is_what_simulate_and_estimate_give(scenario: Path) -> None:
    done = swept(scenario, "--vary", "sensors.noise.tau=0.02", "--cutoff", 200.0)
    assert done.code == 0, done.err
    (row,) = read(scenario.parent / "table.csv")
    one = load_scenario(scenario).with_values({"sensors.noise.tau": 0.02})
    joint = estimate(one.run(5), one.device, cutoff=200.0, start=1.0).joints["elbow"]
    assert joint.truth is not None
    assert row["stiffness"] == f"{joint.stiffness['final']:.12g}"  # as CSV is written
    assert row["msrep_percent"] == f"{joint.truth['msrep_percent']:.12g}"


def test_json_is_one_object_with_a_group_per_combination(scenario: Path) -> None:
    done = swept(scenario, "--vary", "sensors.noise.tau=0.02,0.05", "--seeds", 2, "--json")
    told = json.loads(done.out)
    assert told["cases"] == 4
    assert told["table"].endswith("table.csv")
    assert [group["values"] for group in told["groups"]] == [
        {"sensors.noise.tau": 0.02},
        {"sensors.noise.tau": 0.05},
    ]
    assert [group["cases"] for group in told["groups"]] == [2, 2]
    assert all(group["not_ok"] == 0.0 for group in told["groups"])


def test_cases_that_fail_are_told_and_end_nothing(scenario: Path) -> None:
    # Rows every 20 ms are too slow for 300 rad/s, which is beyond pi / period.
    done = swept(scenario, "--vary", "log_period=0.02,1e-3", "--cutoff", 300.0, "--seeds", 2)
    assert done.code == 0, done.err
    rows = read(scenario.parent / "table.csv")
    assert [row["status"] for row in rows] == ["refused", "refused", "ok", "ok"]
    assert "cutoff" in rows[0]["message"]
    assert rows[0]["verdict"] == ""
    assert "warning: 2 of 4 cases refused, the first: case 0, log_period = 0.02, seed 5" in done.err
    assert rows[0]["message"] in done.err


def test_nothing_informative_is_code_1(scenario: Path) -> None:
    done = swept(scenario, "--vary", "seconds=0.05", "--json")
    assert done.code == 1, done.err
    assert [row["seconds"] for row in read(scenario.parent / "table.csv")] == ["0.05"]
    assert json.loads(done.out)["groups"][0]["informative"] == 0.0


def test_a_terminal_gets_a_bar(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")  # what makes rich believe in a terminal
    monkeypatch.setenv("TERM", "xterm")
    with module._progress() as shown:
        shown(0, 0, 40)
        shown(20, 3, 40)
    told = capsys.readouterr()
    assert "20/40" in told.err
    assert "3 without result" in told.err
    assert told.out == ""


def test_without_a_terminal_there_are_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with module._progress() as shown:
        for done in range(201):
            shown(done, 0, 200)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 11
    assert lines[5] == "sweeping: 100 of 200 cases"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "sensors.encoders.lnk=1,2"], 'Did you mean "link"'),
        (["--vary", "seconds=1.0,-1.0"], "seconds"),
        (["--vary", "seconds"], "key=value,value"),
        (["--method", "waek"], 'Did you mean "weak"'),
        (["--seeds", "0"], "--seeds"),
    ],
)
def test_bad_input_is_a_sentence_and_nothing_runs(
    scenario: Path, arguments: list[str], words: str
) -> None:
    done = swept(scenario, *arguments)
    assert done.code == 2
    assert done.err.startswith("error: ")
    assert words in done.err
    assert sorted(path.name for path in scenario.parent.iterdir()) == ["elbow.toml", "shaken.toml"]


def test_another_sweep_is_not_gone_on_with(scenario: Path) -> None:
    assert swept(scenario, "--seeds", 2, "--keep").code == 0
    done = swept(scenario, "--seeds", 3)
    assert done.code == 2
    assert "seeds: then 2, now 3" in done.err
    assert "--restart" in done.err
    assert swept(scenario, "--seeds", 3, "--restart").code == 0
    assert len(read(scenario.parent / "table.csv")) == 3
    assert not (scenario.parent / "table.csv.cases").exists()


def test_a_changed_device_file_is_another_sweep(scenario: Path) -> None:
    assert swept(scenario, "--keep").code == 0
    device = scenario.parent / "elbow.toml"
    device.write_text(DEVICE.replace("damping = 1.0", "damping = 2.0"), "utf-8")
    done = swept(scenario)
    assert done.code == 2
    assert "elbow.toml: then" in done.err


def test_no_scheduler_there_is_said(scenario: Path) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed (extra scale)")
    done = swept(scenario, "--scheduler", "nonsense")
    assert done.code == 2
    assert "no Dask scheduler answers" in done.err
    assert "dask scheduler" in done.err


def test_the_table_is_not_written_over_the_scenario(scenario: Path) -> None:
    done = run("sweep", scenario, "-o", scenario)
    assert done.code == 2
    assert scenario.read_text("utf-8") == SCENARIO
