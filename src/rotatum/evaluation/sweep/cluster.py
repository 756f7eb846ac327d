"""The same work for many jobs on a Dask cluster, where workers may die."""

from __future__ import annotations

import asyncio
import logging
import uuid
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

from rotatum.errors import ExtraError, RotatumError

__all__ = ["SchedulerError", "finished_on"]

J = TypeVar("J")
R = TypeVar("R")

_PATIENCE = 5.0  # s for a scheduler to answer
_WORKERS = 30.0  # s for its first worker to come
_RETRIES = 2  # of a job that raised: another machine may have the room, or the file
_LIVES = 3  # times a job is given out; each time the scheduler gives it up after some workers
_KEPT = "Finished cases are kept: the same command goes on from there."


class SchedulerError(RotatumError):
    """A Dask cluster that cannot be reached, or that cannot do the work."""


def finished_on(
    address: str, function: Callable[[J], R], jobs: Sequence[J]
) -> Iterator[tuple[int, R]]:
    """Give ``(number, function(jobs[number]))`` as the jobs finish on a Dask cluster.

    The first job is done alone, so that its worker compiles kernels where the others find them,
    if they share the kernel cache. A job whose worker dies is done again by another one.

    Args:
        address: of the scheduler, such as ``tcp://10.0.0.1:8786``.
        function: of a module that the workers have installed.
        jobs: small; the results should be, too.

    Raises:
        ExtraError: Dask is not installed.
        SchedulerError: no scheduler there, no workers, or a job that no worker survives.
        RotatumError: what ``function`` raises of these.
    """
    try:
        import distributed
    except ImportError:
        what = "a Dask cluster needs dask.distributed"
        raise ExtraError(what, extra="scale", where="--scheduler") from None
    if not jobs:
        return
    with _quiet(), _connected(distributed, address) as client:
        for numbers in ((0,), range(1, len(jobs))):
            yield from _finished(distributed, client, function, jobs, numbers)


@contextmanager
def _connected(distributed: Any, address: str) -> Iterator[Any]:
    where = f"--scheduler {address}"
    try:
        # A client that cannot connect complains once more, unasked, when it is collected.
        with ThreadPoolExecutor(1) as pool:
            pool.submit(asyncio.run, _greeted(distributed, address)).result()
    except Exception as error:  # what answers may be anything
        raise SchedulerError(
            f"no Dask scheduler answers ({str(error) or type(error).__name__})",
            where=where,
            hint="Start one with: dask scheduler. Its first lines say the address.",
        ) from error
    with distributed.Client(address, timeout=_PATIENCE, set_as_default=False) as client:
        try:
            client.wait_for_workers(1, timeout=_WORKERS)
        except TimeoutError as error:
            raise SchedulerError(
                f"the scheduler has had no workers for {_WORKERS:g} s",
                where=where,
                hint=f"Start some with: dask worker {address} --nworkers auto --nthreads 1.",
            ) from error
        yield client


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep tracebacks off the terminal: what is wrong with the cluster is raised as a sentence."""
    loggers = [logging.getLogger(name) for name in ("distributed.client", "distributed.utils")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


async def _greeted(distributed: Any, address: str) -> None:
    security = distributed.Security().get_connection_args("client")
    comm = await distributed.comm.connect(address, timeout=_PATIENCE, **security)
    comm.abort()


def _finished(
    distributed: Any,
    client: Any,
    function: Callable[[J], R],
    jobs: Sequence[J],
    numbers: Sequence[int],
) -> Iterator[tuple[int, R]]:
    given: dict[str, int] = {}
    deaths: dict[int, int] = dict.fromkeys(numbers, 0)

    def submit(number: int) -> Any:
        # A key of its own: the same job may be given again.
        key = f"{function.__name__}-{number}-{uuid.uuid4().hex}"
        given[key] = number
        return client.submit(function, jobs[number], key=key, pure=False, retries=_RETRIES)

    futures = distributed.as_completed([*map(submit, numbers)], loop=client.loop)
    for future in futures:
        number = given.pop(future.key)
        try:
            result: R = future.result()
        except distributed.KilledWorker:
            deaths[number] += 1
            if deaths[number] >= _LIVES:
                what = f"no worker survives {jobs[number]}; do they have the memory"
                raise SchedulerError(f"{what}? {_KEPT}") from None
            futures.add(submit(number))
        except RotatumError:
            raise
        except distributed.CancelledError as error:
            raise SchedulerError("the Dask scheduler is gone", hint=_KEPT) from error
        except Exception as error:
            what = f"a worker cannot do its work ({type(error).__name__}: {error})"
            raise SchedulerError(what, hint=_KEPT) from error
        else:
            yield number, result
