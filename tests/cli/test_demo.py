"""`rotatum demo` and the command it ends with."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from tests.cli.runs import run


def test_the_demo_and_how_it_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "a demo"
    done = run("demo", "-o", folder)
    assert done.code == 0
    assert {p.name for p in folder.iterdir()} == {"demo.csv", "demo.toml", "report.html"}
    rows = {line.split()[0]: line.split() for line in done.out.splitlines() if line.split()}
    truth, estimate, std = (float(x) for x in rows["weak"][1:4])
    # the truth lies within four of the standard deviations stated
    assert abs(estimate - truth) < 4.0 * std
    assert "informative" in rows["weak"]
    assert float(rows["residual"][1]) == truth

    command = re.search(r"^  rotatum (estimate .*)$", done.out, re.MULTILINE)
    assert command
    again = run(*shlex.split(command[1]), "--json")
    assert again.code == 0
    (joint,) = json.loads(again.out)["joints"].values()
    assert joint["stiffness"]["final"] == pytest.approx(estimate, rel=1e-4)


def test_json_is_one_object_per_method(tmp_path: Path) -> None:
    done = run("demo", "--output", tmp_path, "--json")
    assert done.code == 0
    told = json.loads(done.out)
    assert list(told) == ["weak", "residual"]
    for method, estimate in told.items():
        assert estimate["method"] == method
        (joint,) = estimate["joints"].values()
        assert joint["truth"] is not None


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "is a file" in run("demo", "-o", tmp_path / "file").err
    done = run("demo", "-o", tmp_path / "file" / "below")
    assert done.code == 2
    assert "cannot be made" in done.err
