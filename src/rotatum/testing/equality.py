"""Clauses that say: two ways to run a stage give the same bits."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.testing.case import Case
from rotatum.testing.compare import differences
from rotatum.testing.faults import rough
from rotatum.testing.report import SkippedError

_INTERPRETED = 300  # samples; interpreting takes about a millisecond for each
_CHUNKED = 5000  # samples; a call from Python takes microseconds


def interpreted_is_compiled(case: Case) -> Iterator[str]:
    """Interpreted = compiled, on good samples and on bad ones."""
    good = case.inputs[:_INTERPRETED]
    for name, inputs in (("good", good), ("bad", rough(case, good))):
        labels = (f"on {name} samples interpreted", "compiled")
        yield from _same(case, case.run(inputs, compile=False), case.run(inputs), labels)


def compiled_is_c(case: Case) -> Iterator[str]:
    """Compiled = exported C, on good samples and on bad ones."""
    if case.no_c:
        raise SkippedError(case.no_c)
    for name, inputs in (("good", case.inputs), ("bad", rough(case, case.inputs[:_CHUNKED]))):
        labels = (f"on {name} samples compiled", "C")
        yield from _same(case, case.run(inputs), case.run_c(inputs), labels)


def online_is_batch(case: Case) -> Iterator[str]:
    """Sample by sample, and in chunks of any size = in one go."""
    inputs = case.inputs[:_CHUNKED]
    rng, bank, done, pieces = case.rng, case.bank(), 0, list[Records]()
    while done < len(inputs):
        chunk = inputs[done : done + int(rng.choice([1, 1, 2, 7, 50, 400]))]
        pieces.append(bank.update(chunk[0])[np.newaxis] if len(chunk) == 1 else bank.run(chunk))
        done += len(chunk)
    chunked = np.concatenate(pieces), bank.state
    yield from _same(case, chunked, case.run(inputs), ("in chunks", "in one go"))


def joints_are_apart(case: Case) -> Iterator[str]:
    """A bank of n joints = n banks of one."""
    inputs = case.inputs[:_CHUNKED]
    together, _ = case.run(inputs)
    for j in range(len(case.params)):
        alone = Bank(case.stage, case.params[j : j + 1]).run(
            np.ascontiguousarray(inputs[:, j : j + 1])
        )
        labels = (f"joint {j} in the bank", "alone")
        yield from differences(together[:, j : j + 1], alone, case.stage.output, labels)


def snapshot_restores(case: Case) -> Iterator[str]:
    """The state is all memory: restored, or given to a fresh bank, it gives the same again."""
    inputs = case.inputs[:_CHUNKED]
    half = len(inputs) // 2
    bank = case.bank()
    bank.run(inputs[:half])
    snapshot = bank.state.copy()
    first = bank.run(inputs[half:])
    bank.state[:] = snapshot
    fresh = case.bank()
    fresh.state[:] = snapshot
    for name, other in (("restored", bank), ("fresh", fresh)):
        labels = ("before", f"{name} bank")
        yield from differences(first, other.run(inputs[half:]), case.stage.output, labels)


def output_is_whole(case: Case) -> Iterator[str]:
    """Every field of the output is written at every sample, whatever the record held before."""
    inputs = rough(case, case.inputs[:_CHUNKED])
    fresh, _ = case.run(inputs)
    used = np.full_like(fresh.view(np.uint8), 0x41).view(fresh.dtype).reshape(fresh.shape)
    case.bank().run(inputs, used)
    labels = ("written to zeros", "written to a used record")
    yield from differences(fresh, used, case.stage.output, labels)


def inputs_stay(case: Case) -> Iterator[str]:
    """Inputs and params are left as they were."""
    inputs = case.inputs[:_CHUNKED].copy()
    before, bank = inputs.copy(), case.bank()
    bank.run(inputs)
    yield from differences(before, inputs, case.stage.input, ("before", "after"))
    yield from differences(case.params, bank.params, case.stage.params, ("before", "after"))


def _same(
    case: Case,
    a: tuple[Records, Records],
    b: tuple[Records, Records],
    labels: tuple[str, str],
) -> Iterator[str]:
    yield from differences(a[0], b[0], case.stage.output, labels)
    yield from differences(a[1], b[1], case.stage.state, labels)
