"""Sweeps on a Dask cluster: deaths of workers lose nothing and change nothing."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet
import pytest

from rotatum.errors import ExtraError, RotatumError
from rotatum.evaluation.sweep import cluster as module
from rotatum.evaluation.sweep import sweep
from rotatum.evaluation.sweep.cluster import SchedulerError, finished_on
from tests.evaluation.sweeps import many, plan, without_timings

dask = pytest.importorskip("dask", reason="Dask is not installed (extra scale)")
distributed = pytest.importorskip("distributed", reason="Dask is not installed (extra scale)")


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Two worker processes of one thread, each with a nanny that replaces it when it dies.

    A job is given up after its second worker's death, so that the test need not wait for more.
    """
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as local,
    ):
        yield local


def pids(address: str) -> list[int]:
    with distributed.Client(address, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60.0)
        return list(client.run(os.getpid).values())


def test_a_sweep_whose_worker_is_killed_ends_with_the_same_table(
    tmp_path: Path, cluster: Any
) -> None:
    alone, spread = tmp_path / "alone.parquet", tmp_path / "spread.parquet"
    sweep(many(), alone, workers=1)
    address = cluster.scheduler_address
    before = pids(address)
    told: list[int] = []

    def kill_at_half(done: int, failures: int, expected: int) -> None:
        told.append(done)
        if done == expected // 2:
            os.kill(before[0], signal.SIGKILL)

    sweep(many(), spread, scheduler=address, progress=kill_at_half)
    assert told == list(range(201))  # each case once
    assert before[0] not in pids(address)
    wanted, found = (pyarrow.parquet.read_table(path) for path in (alone, spread))
    assert wanted.num_rows == 200
    assert wanted.schema == found.schema
    assert without_timings(wanted.to_pydict()) == without_timings(found.to_pydict())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["alone.parquet", "spread.parquet"]


def die_a_few_times(job: tuple[int, Path]) -> int:
    """Kill the own worker, once more than the scheduler bears."""
    number, folder = job
    times = len(list(folder.iterdir()))
    if number == 1 and times < 3:
        (folder / str(times)).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return 10 * number


def test_a_job_the_scheduler_gives_up_is_given_again(tmp_path: Path, cluster: Any) -> None:
    jobs = [(number, tmp_path) for number in range(4)]
    found = dict(finished_on(cluster.scheduler_address, die_a_few_times, jobs))
    assert found == {0: 0, 1: 10, 2: 20, 3: 30}
    assert len(list(tmp_path.iterdir())) == 3


def refuse(job: int) -> int:
    if job == 1:
        raise RotatumError("no", value=job)
    if job == 2:
        raise OSError("no room")
    return job


def test_errors_of_the_work_are_raised_here(cluster: Any) -> None:
    with pytest.raises(RotatumError, match="no, got 1") as caught:
        list(finished_on(cluster.scheduler_address, refuse, [0, 1]))
    assert caught.value.value == 1
    with pytest.raises(SchedulerError, match=r"OSError: no room.*the same command"):
        list(finished_on(cluster.scheduler_address, refuse, [0, 2]))


def test_another_version_on_the_workers_is_refused(tmp_path: Path, cluster: Any) -> None:
    older = plan(seeds=2)
    for job in older.jobs:
        object.__setattr__(job, "version", "0.0.9")
    with pytest.raises(SchedulerError, match=r"the sweep 0\.0\.9.*same version everywhere"):
        sweep(older, tmp_path / "t.csv", scheduler=cluster.scheduler_address)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense", "ftp://127.0.0.1:8786"])
def test_no_scheduler_there_is_said_within_seconds(tmp_path: Path, address: str) -> None:
    begin = time.monotonic()
    with pytest.raises(SchedulerError, match=f"--scheduler {address}: no Dask scheduler answers"):
        sweep(plan(), tmp_path / "t.csv", scheduler=address)
    assert time.monotonic() - begin < 15.0  # 5 s of patience, on a busy machine


def test_a_scheduler_without_workers_is_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(module, "_WORKERS", 0.5)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0") as empty,
        pytest.raises(SchedulerError, match=r"no workers for 0\.5 s"),
    ):
        sweep(plan(), tmp_path / "t.csv", scheduler=empty.scheduler_address)


def test_without_dask_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ExtraError, match=r"rotatum\[scale\]"):
        sweep(plan(), tmp_path / "t.csv", scheduler="tcp://127.0.0.1:9")
