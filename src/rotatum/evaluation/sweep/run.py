"""A sweep, run: cases done anywhere, kept one by one, put into one table in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rotatum.errors import ExtraError, RotatumError
from rotatum.evaluation.parallel import finished
from rotatum.evaluation.sweep.cluster import finished_on
from rotatum.evaluation.sweep.journal import Journal
from rotatum.evaluation.sweep.plan import Plan
from rotatum.evaluation.sweep.table import columns
from rotatum.evaluation.sweep.work import OK, Job, run_case
from rotatum.logs import TableWriter, write_table

__all__ = ["Progress", "sweep"]

Progress = Callable[[int, int, int], None]
"""Called with cases done, those that are not ok among them, and cases in all."""


def sweep(
    plan: Plan,
    output: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    restart: bool = False,
    keep: bool = False,
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Do all cases of a sweep, write their table, and return their results in order.

    Finished cases are kept in the folder ``OUTPUT.cases`` until the table is written; another call
    with the same plan and output does what is missing. The table does not tell how often a
    sweep was interrupted, nor where its cases ran: all but its ``TIMINGS`` has the same bits.

    Args:
        plan: from ``plan_of``.
        output: the table, ``.csv``, ``.npz`` or ``.parquet``.
        workers: processes; ``None``: as many as there are processors.
        scheduler: address of a Dask cluster to do the work instead.
        restart: forget what an interrupted run left.
        keep: leave the folder of finished cases there.
        progress: called at the start and after every case.

    Raises:
        OutputError: the table or the folder cannot be written, or the folder is another sweep's.
        SchedulerError: the cluster cannot be reached or cannot do the work.
        RotatumError: a worker process died.
    """
    table = Path(output)
    _check_format(table)
    journal = Journal(table, plan.header, restart=restart)
    results = journal.results()
    failures = sum(result["status"] != OK for result in results.values())
    missing = [job for job in plan.jobs if job.case.number not in results]

    def told() -> None:
        if progress is not None:
            progress(len(results), failures, len(plan.jobs))

    told()
    for result in _done(missing, workers, scheduler):
        journal.add(result)
        results[result["case"]] = result
        failures += result["status"] != OK
        told()
    # Read back, so that every case has gone through the same text.
    ordered = list(journal.results().values())
    write_table(table, columns(ordered, plan.varied))
    if not keep:
        journal.remove()
    return ordered


def _check_format(table: Path) -> None:
    """Refuse before the work what could not be written after it."""
    TableWriter(table)
    if table.suffix.lower() == ".parquet" and find_spec("pyarrow") is None:
        raise ExtraError("writing Parquet needs pyarrow", extra="parquet", where=str(table))


def _done(
    jobs: Sequence[Job], workers: int | None, scheduler: str | None
) -> Iterator[dict[str, Any]]:
    if scheduler is not None:
        for _, result in finished_on(scheduler, run_case, jobs):
            yield result
        return
    try:
        for _, result in finished(run_case, jobs, workers=workers):
            yield result
    except BrokenExecutor as error:
        raise RotatumError(
            "a worker process was ended, by the system for lack of memory or by somebody",
            hint="Finished cases are kept: the same command goes on; --workers 1 needs least.",
        ) from error
