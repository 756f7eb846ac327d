"""The program as a whole: help, version, interruption, surprises, closed pipes."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import rotatum
from tests.cli.conftest import Scene
from tests.cli.runs import MAIN, run, spawn

HEAVY = ("numba", "scipy", "plotly", "pydantic", "pyarrow", "h5py", "numpy")
VERBS = ("estimate", "compare", "characterise", "demo", "devices", "export", "reproduce")


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import atexit, sys\n"
        f"atexit.register(lambda: print([m for m in {HEAVY!r} if m in sys.modules]))\n" + MAIN
    )
    done = spawn("--help", code=code)
    assert done.code == 0
    assert done.out.splitlines()[-1] == "[]"
    assert all(verb in done.out for verb in VERBS)


@pytest.mark.parametrize("words", [*((verb,) for verb in VERBS), ("export", "c")])
def test_every_verb_has_help(words: tuple[str, ...]) -> None:
    done = run(*words, "--help")
    assert done.code == 0
    assert "--help" in done.out


def test_version() -> None:
    assert run("--version").out == f"rotatum {rotatum.__version__}\n"


def test_an_interruption_is_130(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("rotatum.evaluation.estimate", interrupted)
    done = run("estimate", scene.log, "--device", scene.device)
    assert done.code == 130
    assert done.err.splitlines()[-1] == "interrupted"


def test_a_surprise_is_a_sentence(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def surprised(*_: object, **__: object) -> None:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr("rotatum.evaluation.estimate", surprised)
    monkeypatch.delenv("ROTATUM_DEBUG", raising=False)
    done = run("estimate", scene.log, "--device", scene.device)
    assert done.code == 2
    assert "unexpected ZeroDivisionError: of all things" in done.err
    assert "report it" in done.err
    monkeypatch.setenv("ROTATUM_DEBUG", "1")
    with pytest.raises(AssertionError, match="ZeroDivisionError"):
        run("estimate", scene.log, "--device", scene.device)


def test_a_closed_pipe_is_no_traceback() -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-c", MAIN, "devices", "--json"],
        stdout=write,
        stderr=subprocess.PIPE,
        text=True,
        timeout=60,
        check=False,
    )
    os.close(write)
    assert done.stderr == ""
    assert done.returncode == 141
