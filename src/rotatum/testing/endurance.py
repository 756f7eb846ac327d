"""Clauses about long runs: nothing is allocated, nothing winds up."""

from __future__ import annotations

import importlib
import tracemalloc
from collections.abc import Iterator

import numpy as np

from rotatum.record import Records
from rotatum.runtime import jit
from rotatum.runtime.bank import Bank
from rotatum.testing.case import Case
from rotatum.testing.compare import finite, numbers
from rotatum.testing.report import SkippedError

_UPDATES = 1000
_CHUNK = 100_000


def step_allocates_nothing(case: Case) -> Iterator[str]:
    """A compiled step asks for no memory."""
    if not jit.enabled():
        raise SkippedError("compilation is switched off")
    short, long = (_allocations(case, case.inputs[:n]) for n in (100, 200))
    if long > short:
        yield f"100 samples more cost {long - short} allocations more"


def update_allocates_nothing(case: Case) -> Iterator[str]:
    """``Bank.update`` with ``out`` given leaves no memory behind."""
    bank = case.bank()
    u, out = case.inputs[0].copy(), case.stage.output.zeros(len(case.params))
    for _ in range(10):
        bank.update(u, out)
    running = tracemalloc.is_tracing()
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(_UPDATES):
            bank.update(u, out)
        after, _ = tracemalloc.get_traced_memory()
    finally:
        if not running:
            tracemalloc.stop()
    if after - before >= _UPDATES:  # less than a byte each: Python's own bookkeeping
        yield f"{_UPDATES} updates left {after - before} bytes behind"


def stays_finite(case: Case) -> Iterator[str]:
    """A long run stays finite: half of it with the inputs going round, half with them at rest."""
    bank = Bank(case.stage, case.params[:1])
    done = 0
    chunk = np.ascontiguousarray(case.inputs[:_CHUNK, :1])
    while done < case.endurance:
        if done >= case.endurance // 2:
            chunk = _at_rest(chunk)
        piece = _later(chunk[: case.endurance - done], done)
        out = bank.run(np.ascontiguousarray(piece))
        done += len(piece)
        if done <= len(chunk):
            good = finite(out[-1:, 0], case.stage.output)
            whole = finite(bank.state, case.stage.state)
            continue
        for records, before, layout in (
            (out[-1:, 0], good, case.stage.output),
            (bank.state, whole, case.stage.state),
        ):
            lost = np.flatnonzero((~finite(records, layout) & before).any(axis=0))
            if len(lost):
                yield f"{layout.name}.{numbers(layout)[lost[0]][0]} lost after {done:,} samples"
                return


def _allocations(case: Case, inputs: Records) -> int:
    """Count what compiled code allocates on numba's heap during a run."""
    bank, out = case.bank(), case.stage.output.zeros(*inputs.shape)
    bank.run(inputs, out)
    # Statistics are off by default; only jit.py may import numba by name.
    importlib.import_module("numba.core.runtime._nrt_python").memsys_enable_stats()
    stats = importlib.import_module("numba.core.runtime").rtsys.get_allocation_stats
    before = int(stats().alloc)
    bank.run(inputs, out)
    return int(stats().alloc) - before


def _later(chunk: Records, samples: int) -> Records:
    """Return a chunk with its clock put forward by a number of samples."""
    if "time" not in (chunk.dtype.names or ()):
        return chunk
    later = chunk.copy()
    period = (chunk["time"][-1] - chunk["time"][0]) / max(len(chunk) - 1, 1)
    later["time"] += samples * period
    return later


def _at_rest(chunk: Records) -> Records:
    """Return a chunk whose signals keep their first value while the clock runs."""
    still = np.repeat(chunk[:1], len(chunk), axis=0)
    if "time" in (chunk.dtype.names or ()):
        still["time"] = chunk["time"]
    return still
