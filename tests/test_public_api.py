"""The public names: few, sorted, all there, all documented, and cheap to import."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import rotatum

# Nothing a user's `import rotatum` may pay for before asking for it.
HEAVY = ("numba", "scipy", "plotly", "pyarrow", "h5py", "pandas", "pooch", "rotatum.cli")


def test_all_is_sorted_and_short() -> None:
    names = rotatum.__all__
    assert list(names) == sorted(names)
    assert len(names) == len(set(names))
    assert len(names) <= 40


@pytest.mark.parametrize("name", rotatum.__all__)
def test_every_public_name_exists_and_is_documented(name: str) -> None:
    value = getattr(rotatum, name)
    if inspect.isfunction(value) or inspect.isclass(value) or inspect.ismodule(value):
        assert (inspect.getdoc(value) or "").strip(), f"rotatum.{name} has no docstring"


def test_every_public_name_is_listed() -> None:
    assert set(rotatum.__all__) <= set(dir(rotatum))


def test_an_unknown_name_is_an_attribute_error() -> None:
    missing = "no_such_name"
    with pytest.raises(AttributeError, match=missing):
        getattr(rotatum, missing)


def test_version_is_that_of_the_project(project: Path) -> None:
    stated = tomllib.loads((project / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    assert rotatum.__version__ == stated


def test_import_is_lazy() -> None:
    """Counted by modules, not by the clock: a busy machine must not fail this."""
    code = f"import sys, rotatum; print([m for m in {HEAVY!r} if m in sys.modules])"
    assert _python(code) == "[]"


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys\n"
        "from rotatum.cli import main\n"
        "sys.argv = ['rotatum', '--help']\n"
        "try:\n"
        "    main()\n"
        "except SystemExit as stop:\n"
        "    assert not stop.code, stop.code\n"
        f"print([m for m in {HEAVY[:-1]!r} if m in sys.modules])"
    )
    assert _python(code).splitlines()[-1] == "[]"


def test_help_is_quick() -> None:
    """The aim is 0.6 s; the best of three takes at most twice that of the processor's time."""
    assert min(_help_seconds() for _ in range(3)) < 1.2


def test_type_information_is_shipped() -> None:
    assert (Path(inspect.getfile(rotatum)).parent / "py.typed").is_file()


def _help_seconds() -> float:
    before = os.times()
    _python("import sys; sys.argv = ['rotatum', '--help']; from rotatum.cli import main; main()")
    after = os.times()
    # others' work on a shared machine makes it wait, not work
    spent = after.children_user - before.children_user
    return spent + after.children_system - before.children_system


def _python(code: str) -> str:
    """Standard output of a fresh interpreter; the test fails with its standard error."""
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "100"},
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()
