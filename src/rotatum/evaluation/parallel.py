"""The same work for many jobs, spread over processes."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TypeVar

__all__ = ["finished", "spread"]

J = TypeVar("J")
R = TypeVar("R")

_LOOK = 0.5  # s between looks at whether the parent is still there


def spread(
    function: Callable[[J], R],
    jobs: Sequence[J],
    progress: Callable[[int, int | None], None] | None = None,
    *,
    workers: int | None = None,
) -> list[R]:
    """Return ``[function(job) for job in jobs]``, worked on by several processes.

    Args:
        function, jobs, workers: as for ``finished``.
        progress: called after every job with jobs done and jobs in all.
    """
    results: dict[int, R] = {}
    for number, result in finished(function, jobs, workers=workers):
        results[number] = result
        if progress is not None:
            progress(len(results), len(jobs))
    return [results[number] for number in range(len(jobs))]


def finished(
    function: Callable[[J], R], jobs: Sequence[J], *, workers: int | None = None
) -> Iterator[tuple[int, R]]:
    """Give ``(number, function(jobs[number]))`` as the jobs finish, in any order.

    The first job is done here: what it compiles the others find in the kernel cache, whose place
    (``ROTATUM_CACHE_DIR``) they are told. Workers write no files and end with this
    process, killed or not.

    Args:
        function: of a module, so that another process can find it.
        jobs: small; the results should be, too.
        workers: processes; ``None``: as many as there are processors. 1 works here.
    """
    if not jobs:
        return
    yield 0, function(jobs[0])
    rest = list(enumerate(jobs))[1:]
    processes = min(workers or os.cpu_count() or 1, len(rest))
    if processes < 2:
        for number, job in rest:
            yield number, function(job)
        return
    from joblib import Parallel, delayed

    settings = {k: v for k, v in os.environ.items() if k.startswith("ROTATUM_")}
    pool = Parallel(n_jobs=processes, max_nbytes=None, return_as="generator_unordered")
    yield from pool(
        delayed(_within)(os.getpid(), settings, function, number, job) for number, job in rest
    )


def _within(
    parent: int, settings: Mapping[str, str], function: Callable[[J], R], number: int, job: J
) -> tuple[int, R]:
    """Work under these settings: a process that is used again may be older than they are."""
    _leave_with(parent)
    os.environ.update(settings)
    return number, function(job)


@lru_cache(maxsize=1)
def _leave_with(parent: int) -> None:
    """End this process soon after its parent: one that is killed cannot say goodbye."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
