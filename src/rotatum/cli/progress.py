"""Progress on standard error: a bar on a terminal, a line where there is none."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rotatum.cli.failures import say

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["progress"]

_COMPILING = "loading kernels (compiled first, once per machine and method)"
_PATIENCE = 3.0  # seconds without a sample that a start with compiled kernels does not take


@contextmanager
def progress(what: str) -> Iterator[Callable[[int, int | None], None]]:
    """Show progress while the block runs; give what to call with samples done and expected.

    Parameters
    ----------
    what : the work, such as "estimating".
    """
    from rich.console import Console

    console = Console(stderr=True, markup=False)
    with _bar(console, what) if console.is_terminal else _line() as report:
        yield report


@contextmanager
def _bar(console: Console, what: str) -> Iterator[Callable[[int, int | None], None]]:
    from rich.progress import (
        BarColumn,
        Progress,
        SpinnerColumn,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task(what, total=None)
        with _while_compiling(lambda: shown.update(task, description=_COMPILING)) as started:

            def report(done: int, expected: int | None) -> None:
                started()
                shown.update(task, description=what, completed=done, total=expected)

            yield report


@contextmanager
def _line() -> Iterator[Callable[[int, int | None], None]]:
    with _while_compiling(lambda: say(f"{_COMPILING} ...")) as started:
        yield lambda done, expected: started()


@contextmanager
def _while_compiling(tell: Callable[[], None]) -> Iterator[Callable[[], None]]:
    """Call `tell` once if the given function is not called for a while."""
    timer = threading.Timer(_PATIENCE, tell)
    timer.daemon = True
    timer.start()
    try:
        yield timer.cancel
    finally:
        timer.cancel()
        sys.stderr.flush()
