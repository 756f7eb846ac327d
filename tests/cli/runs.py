"""Running the program: in this process where that is enough, else in one of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from typer.testing import CliRunner

from rotatum.cli import app

MAIN = "from rotatum.cli import main; main()"


class Outcome(NamedTuple):
    """What a run left."""

    code: int
    out: str
    err: str


def run(*arguments: object) -> Outcome:
    """Run the program in this process; a traceback fails the test that asked."""
    words = [str(a) for a in arguments]
    # Workers of a parallel run are told of a terminal of 80 columns, which folds sentences.
    done = CliRunner().invoke(app, words, prog_name="rotatum", env={"COLUMNS": "120"})
    leaked = done.exception is not None and not isinstance(done.exception, SystemExit)
    assert not leaked, repr(done.exception)
    assert "Traceback" not in done.stdout + done.stderr
    return Outcome(done.exit_code, done.stdout, done.stderr)


def spawn(*arguments: object, code: str = MAIN, folder: Path | None = None) -> Outcome:
    """Run the program in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", code, *(str(a) for a in arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        cwd=folder,
        env={**os.environ, "COLUMNS": "120"},
    )
    return Outcome(done.returncode, done.stdout, done.stderr)
