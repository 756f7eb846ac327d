"""Sweeps: cases in their order, failures as rows, and a table that no interruption changes."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum import estimate
from rotatum.errors import MethodError, OutputError, RotatumError, ScenarioError
from rotatum.evaluation.sweep import (
    TIMINGS,
    Choices,
    Vary,
    parse_vary,
    summary,
    sweep,
)
from rotatum.evaluation.sweep.journal import Journal
from rotatum.evaluation.sweep.score import joint_values
from rotatum.evaluation.sweep.table import columns
from rotatum.evaluation.sweep.work import run_case
from tests.evaluation.sweeps import TABLES, many, plan, small, without_timings
from tests.report.scenes import pair_estimate, pair_log, small_device


def test_values_are_read_as_toml() -> None:
    found = parse_vary(" a.b = 1, 2.5,-inf,true,'x, y',[1, [2]],[] ,vsa-ii, ./own/arm.toml")
    values = (1, 2.5, -math.inf, True, "x, y", [1, [2]], [], "vsa-ii", "./own/arm.toml")
    assert found == Vary("a.b", values)
    assert [type(value) for value in found.values[:2]] == [int, float]
    assert parse_vary('joint."axis 1".start.q=0.1').key == 'joint."axis 1".start.q'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("sensors.encoders.link", "key=value,value"),
        ("=1,2", "key=value,value"),
        ("a=", "a value is missing"),
        ("a=1,,2", "a value is missing"),
        ("a=1,2,1", "the same value twice, got 1"),
        ("a=1e", "is not a TOML value, got '1e'"),
        ("a=[1,2", "is not a TOML value"),
        ("a={ b = 1 }", "one by one"),
        ("a=2026-01-01", "neither a number"),
    ],
)
def test_what_is_no_list_of_values_is_said(text: str, words: str) -> None:
    with pytest.raises(ScenarioError, match=words.replace("[", r"\[")):
        parse_vary(text)


def test_numbers_and_booleans_are_not_the_same_value() -> None:
    assert parse_vary("a=1,1.0,true").values == (1, 1.0, True)


def test_cases_are_the_product_in_the_order_given_seeds_fastest() -> None:
    cases = plan("encoders=4096.0,1024.0", "seconds=0.5,0.2", seeds=2).cases
    told = [(c.number, c.values["encoders"], c.values["seconds"], c.seed) for c in cases]
    assert told == [
        (0, 4096.0, 0.5, 7),
        (1, 4096.0, 0.5, 8),
        (2, 4096.0, 0.2, 7),
        (3, 4096.0, 0.2, 8),
        (4, 1024.0, 0.5, 7),
        (5, 1024.0, 0.5, 8),
        (6, 1024.0, 0.2, 7),
        (7, 1024.0, 0.2, 8),
    ]


def test_nothing_varied_is_the_scenario_itself() -> None:
    (case,) = plan().cases
    assert (case.number, case.values, case.seed) == (0, {}, TABLES["seed"])


@pytest.mark.parametrize(
    ("varied", "words"),
    [
        (["encoder=1,2"], "unknown key, got 'encoder'"),
        (["seconds=0.5", "seconds=1.0"], "varied twice"),
        (["seed=1,2"], "--seeds N"),
        (["estimate.cutoff=100.0,200.0"], "--cutoff sets it for all cases"),
    ],
)
def test_a_sweep_that_cannot_be_is_refused_before_it_runs(varied: list[str], words: str) -> None:
    with pytest.raises(ScenarioError, match=words):
        plan(*varied, choices=Choices(cutoff=50.0))


def test_settings_that_fit_no_case_are_refused_before_it_runs() -> None:
    with pytest.raises(MethodError, match='Did you mean "weak"'):
        plan("encoders=1024.0", choices=Choices(method="waek"))
    # Of a sweep over periods some may be too long for the cutoff: those are its result.
    assert len(plan("period=1e-3,1.0", choices=Choices(cutoff=300.0)).jobs) == 2


def test_no_seeds_is_an_error() -> None:
    with pytest.raises(ScenarioError, match="--seeds"):
        plan(seeds=0)


def test_the_command_line_goes_before_the_scenario() -> None:
    filed = small(TABLES, "").estimate
    told = Choices(cutoff=50.0, fit=()).over(filed)
    assert (told.method, told.cutoff, told.fit, told.solver) == ("weak", 50.0, (), None)


def test_a_case_is_the_estimate_of_its_simulation() -> None:
    choices = Choices(start=1.0)
    varied = ("encoders=65536.0", "estimate.cutoff=100.0")
    job = plan(*varied, seeds=3, choices=choices, seconds=4.0).jobs[2]
    result = run_case(job)
    log = small({**TABLES, "seconds": 4.0}, "").run(9)
    wanted = estimate(log, small_device(), method="weak", cutoff=100.0, start=1.0)
    joint = wanted.joints["elbow"]
    assert joint.truth is not None
    found = result["joints"]["elbow"]
    assert (result["status"], result["message"], result["seed"]) == ("ok", "", 9)
    assert found["stiffness"] == joint.stiffness["final"]
    assert found["stiffness_std"] == joint.stiffness_std
    assert found["stiffness_true"] == 200.0  # the device file's
    assert found["error_percent"] == pytest.approx((found["stiffness"] - 200.0) / 2.0, rel=1e-12)
    assert {name: found[name] for name in joint.truth} == dict(joint.truth)
    assert (found["verdict"], found["converged_at"]) == (joint.verdict, joint.converged_at)
    assert (found["fitted.offset"], found["fitted.offset_std"]) == joint.fitted["offset"]
    assert found["torque_rms"] == joint.torque_rms
    assert result["simulate_seconds"] > 0.0
    assert result["estimate_seconds"] > 0.0


def test_both_transmissions_stand_beside_their_sum() -> None:
    found = pair_estimate()
    (name,) = found.joints
    joint, log = found.joints[name], pair_log()
    values = joint_values(joint, log)
    for end, part in zip("12", joint.parts, strict=True):
        true = log.joints[name][f"stiffness{end}_true"][-1]
        assert values[f"stiffness{end}"] == part.stiffness
        assert values[f"stiffness{end}_std"] == part.stiffness_std
        assert values[f"stiffness{end}_true"] == true
        assert values[f"error{end}_percent"] == 100.0 * (part.stiffness - true) / true
        assert values[f"verdict{end}"] == part.verdict
        assert part.truth is not None
        assert values[f"msrep{end}_percent"] == part.truth["msrep_percent"]
        assert values[f"mse{end}"] == part.truth["mse"]
        assert values[f"coverage{end}_percent"] == part.truth["coverage_percent"]
    both = values["stiffness1_true"] + values["stiffness2_true"]
    assert values["stiffness_true"] == pytest.approx(both, rel=1e-12)  # a sum of two


@pytest.mark.parametrize(
    ("trouble", "status", "message"),
    [
        ("stop", "stopped", "the spring left its range, got 7."),
        ("crash", "failed", "unexpected ZeroDivisionError: nobody thought of this"),
    ],
)
def test_a_case_that_fails_is_a_row_with_its_reason(
    tmp_path: Path, trouble: str, status: str, message: str
) -> None:
    told: list[tuple[int, int, int]] = []
    results = sweep(
        plan(seeds=2, trouble=trouble),
        tmp_path / "t.parquet",
        workers=1,
        progress=lambda *done: told.append(done),
    )
    assert told == [(0, 0, 2), (1, 1, 2), (2, 1, 2)]
    table = pyarrow.parquet.read_table(tmp_path / "t.parquet").to_pydict()
    assert table["status"] == [status, "ok"]
    assert table["message"] == [message, ""]
    assert table["joint"] == ["elbow", "elbow"]
    assert math.isnan(table["stiffness"][0])
    assert summary(results)[0].not_ok == 0.5


def test_what_the_estimator_refuses_is_a_row(tmp_path: Path) -> None:
    # 300 rad/s is beyond pi / 20 ms.
    results = sweep(plan("period=1e-3,0.02"), tmp_path / "t.csv", workers=1)
    assert [result["status"] for result in results] == ["ok", "refused"]
    assert "cutoff" in results[1]["message"]
    assert results[1]["simulate_seconds"] > 0.0
    assert results[1]["estimate_seconds"] is None


def test_a_machine_without_memory_is_no_result(tmp_path: Path) -> None:
    with pytest.raises(MemoryError):
        sweep(plan(trouble="memory"), tmp_path / "t.csv", workers=1)
    assert not (tmp_path / "t.csv").exists()


@given(st.lists(st.floats(), min_size=1), st.integers(0, 2**63 - 1))
def test_numbers_survive_the_journal_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[float], seed: int
) -> None:
    journal = Journal(tmp_path_factory.mktemp("journal") / "t", {})
    journal.add({"case": 3, "seed": seed, "numbers": numbers})
    back = journal.results()[3]
    assert back["seed"] == seed
    # The sign and payload of a NaN mean nothing; all else is the same 64 bits.
    sent, came = np.array(numbers), np.array(back["numbers"])
    known = ~np.isnan(sent)
    assert np.array_equal(np.isnan(came), ~known)
    assert np.array_equal(sent[known].view(np.int64), came[known].view(np.int64))


def test_a_journal_of_another_sweep_is_refused_by_what_differs(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    old = {"rotatum": "0.1", "scenario": {"sensors": {"noise": {"q": 1.0}}}, "seeds": 3}
    Journal(table, old).add({"case": 0})
    new = {"rotatum": "0.1", "scenario": {"sensors": {"noise": {"q": 2.0}}}, "seeds": 4}
    differs = r"sensors\.noise\.q: then 1\.0, now 2\.0; seeds: then 3, now 4.*--restart"
    with pytest.raises(OutputError, match=differs):
        Journal(table, new)
    assert list(Journal(table, old).results()) == [0]
    assert list(Journal(table, new, restart=True).results()) == []


def test_the_order_of_varied_keys_is_part_of_the_sweep(tmp_path: Path) -> None:
    Journal(tmp_path / "t.csv", {"vary": {"a": [1], "b": [2]}})
    with pytest.raises(OutputError, match="the order of the keys"):
        Journal(tmp_path / "t.csv", {"vary": {"b": [2], "a": [1]}})


def test_a_changed_device_file_is_another_sweep(tmp_path: Path) -> None:
    device = tmp_path / "arm.toml"
    device.write_text("stiffness = 1\n")
    before = plan(device=str(device)).header
    device.write_text("stiffness = 2\n")
    after = plan(device=str(device)).header
    assert before["scenario"] == after["scenario"]
    assert before["files"] != after["files"]


def test_half_a_file_is_a_case_to_do_again(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "t.csv", {})
    for case in range(3):
        journal.add({"case": case})
    (journal.folder / "case-000001.json").write_text('{"case": 1, "se')
    (journal.folder / "case-000002.json").write_text("")
    assert list(journal.results()) == [0]


def test_a_folder_of_somebody_else_stays(tmp_path: Path) -> None:
    folder = tmp_path / "t.csv.cases"
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    for restart in (False, True):
        with pytest.raises(OutputError, match="in the way"):
            Journal(tmp_path / "t.csv", {}, restart=restart)
    journal = Journal(tmp_path / "u.csv", {})
    (journal.folder / "notes.txt").write_text("mine")
    journal.remove()
    assert [path.name for path in journal.folder.iterdir()] == ["notes.txt"]


def test_a_damaged_journal_is_said(tmp_path: Path) -> None:
    Journal(tmp_path / "t.csv", {})
    (tmp_path / "t.csv.cases" / "sweep.json").write_text("{")
    with pytest.raises(OutputError, match=r"damaged.*--restart"):
        Journal(tmp_path / "t.csv", {})


class Enough(Exception):
    """Stands for an interruption."""


def stop_at(number: int) -> Any:
    def progress(done: int, failures: int, expected: int) -> None:
        if done == number:
            raise Enough

    return progress


def test_an_interrupted_sweep_does_only_what_is_missing(tmp_path: Path) -> None:
    wanted, table = plan(seeds=6), tmp_path / "t.parquet"
    with pytest.raises(Enough):
        sweep(wanted, table, workers=1, progress=stop_at(4))
    assert not table.exists()
    kept = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "t.parquet.cases").iterdir()}
    assert len([name for name in kept if name.startswith("case-")]) == 4
    told: list[int] = []
    sweep(wanted, table, workers=1, keep=True, progress=lambda done, *_: told.append(done))
    assert told == [4, 5, 6]
    after = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "t.parquet.cases").iterdir()}
    assert len([name for name in after if name.startswith("case-")]) == 6
    assert all(after[name] == when for name, when in kept.items() if name.startswith("case-"))


def test_keep_leaves_the_journal_and_makes_the_table_again(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    sweep(plan(seeds=2), table, workers=1, keep=True)
    first = table.read_bytes()
    table.unlink()
    told: list[int] = []
    sweep(plan(seeds=2), table, workers=1, progress=lambda done, *_: told.append(done))
    assert told == [2]
    assert table.read_bytes() == first  # timings, too: they are of the first run
    assert list(tmp_path.iterdir()) == [table]


def test_a_table_that_cannot_be_written_is_said_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="ending"):
        sweep(plan(), tmp_path / "t.xlsx", workers=1)
    assert list(tmp_path.iterdir()) == []


def test_a_worker_that_dies_is_said_and_finished_cases_stay(tmp_path: Path) -> None:
    dying = plan(seeds=6, trouble="die", process=os.getpid())
    with pytest.raises(RotatumError, match="the same command goes on"):
        sweep(dying, tmp_path / "t.csv", workers=2)
    assert len(list((tmp_path / "t.csv.cases").glob("case-*.json"))) >= 1


def test_columns_have_one_type_each() -> None:
    shared = {"seed": 1, "status": "ok", "message": "", "simulate_seconds": None}
    results = [
        {"case": 0, **shared, "values": {"a": 1, "b": [1, 2], "c": True, "d": 1}, "joints": {}},
        {
            "case": 1,
            **shared,
            "values": {"a": 2, "b": "x", "c": False, "d": 0.5},
            "joints": {"one": {"stiffness": 3.0}, "two": {"stiffness": math.inf}},
        },
    ]
    table = columns(results, [Vary(key, ()) for key in "abcd"])
    assert list(table)[:6] == ["case", "a", "b", "c", "d", "seed"]
    assert list(table)[-3:] == list(TIMINGS)
    assert table["case"].tolist() == [0, 1, 1]
    assert (table["a"].dtype.kind, table["c"].dtype.kind, table["d"].dtype.kind) == ("i", "b", "f")
    assert table["b"].tolist() == ["[1, 2]", "x", "x"]
    assert table["joint"].tolist() == ["", "one", "two"]
    assert repr(table["stiffness"].tolist()) == "[nan, 3.0, inf]"


def test_the_summary_by_hand() -> None:
    def result(case: int, error: float, status: str, verdict: str) -> dict[str, Any]:
        joint = {"error_percent": error, "msrep_percent": error**2 / 100.0, "verdict": verdict}
        joints = {"elbow": joint if status == "ok" else {}}
        return {"case": case, "values": {"a": case // 4}, "joints": joints, "status": status}

    first, second = summary(
        [
            result(0, -1.0, "ok", "informative"),
            result(1, 3.0, "ok", "informative"),
            result(2, 2.0, "ok", "starved"),
            result(3, 0.0, "stopped", ""),
            result(4, math.nan, "ok", "converging"),
        ]
    )
    assert (first.values, first.joint, first.cases) == ({"a": 0}, "elbow", 4)
    assert (first.informative, first.not_ok, first.error_percent) == (0.5, 0.25, 2.0)
    # Linear between the second and third of 1, 2, 3: at 0.9 of the way.
    assert first.error_percent_90 == pytest.approx(2.8, rel=1e-12)
    assert first.msrep_percent == pytest.approx(0.04, rel=1e-12)
    assert second.cases == 1
    assert math.isnan(second.error_percent)
    assert json.loads(json.dumps(second.to_json(), allow_nan=False))["error_percent"] is None


def test_a_sweep_killed_at_half_ends_with_the_same_table(tmp_path: Path) -> None:
    alone, killed = tmp_path / "alone.parquet", tmp_path / "killed.parquet"
    sweep(many(), alone, workers=1)
    command = [sys.executable, "-m", "tests.evaluation.sweeps", str(killed), "2"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line.split()[0]) >= 100:
                break
        os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert not killed.exists()
    done = len(list((tmp_path / "killed.parquet.cases").glob("case-*.json")))
    assert 100 <= done < 200
    told: list[int] = []
    sweep(many(), killed, workers=2, progress=lambda number, *_: told.append(number))
    assert told == list(range(done, 201))
    wanted, found = (pyarrow.parquet.read_table(path) for path in (alone, killed))
    assert wanted.num_rows == 200
    assert wanted.schema == found.schema
    assert without_timings(wanted.to_pydict()) == without_timings(found.to_pydict())
    assert wanted["status"].to_pylist().count("stopped") == 68  # seeds 7, 10 .. 106, twice
    assert sorted(path.name for path in tmp_path.iterdir()) == ["alone.parquet", "killed.parquet"]
