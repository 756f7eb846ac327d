"""Progress: a line where there is no terminal, a bar where there is, results untouched."""

from __future__ import annotations

import time

import pytest

from rotatum.cli import progress as module
from rotatum.cli.progress import progress


def test_waiting_for_the_compiler_is_explained(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_PATIENCE", 0.01)
    with progress("working"):
        time.sleep(0.3)
    told = capsys.readouterr()
    assert told.err == f"{module._COMPILING} ...\n"
    assert told.out == ""


def test_quick_work_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("working") as shown:
        shown(10, 100)
        shown(100, 100)
    assert capsys.readouterr().err == ""


def test_a_terminal_gets_a_bar(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")  # what makes rich believe in a terminal
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(module, "_PATIENCE", 0.05)
    with progress("working [hard]") as shown:
        time.sleep(0.4)
        shown(50, 100)
        time.sleep(0.4)
    told = capsys.readouterr()
    assert "loading kernels" in told.err
    assert "working [hard]" in told.err
    assert "50%" in told.err
    assert told.out == ""


def test_an_error_passes_through() -> None:
    with pytest.raises(ValueError, match="no"), progress("working"):
        raise ValueError("no")
