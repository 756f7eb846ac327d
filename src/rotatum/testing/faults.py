"""What goes wrong with samples, and the clauses that say: a stage lives through it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from rotatum.record import Records
from rotatum.testing.case import Case
from rotatum.testing.compare import differences, finite, numbers
from rotatum.testing.signals import leaf, leaves

_LENGTH = 5  # samples a fault lasts
_SATURATION = 1e12  # times the largest good value
_JUMP = 10.0  # s
_GAP = 50  # samples that a dropout loses


class Fault(NamedTuple):
    """Something that happens to joint 0 from one sample on.

    Args:
        name: what happens.
        apply: changes the records after the given sample in place.
    """

    name: str
    apply: Callable[[Records, int], None]


def faults_of(case: Case) -> Iterator[Fault]:
    """Yield what can go wrong with the inputs of a stage."""
    for name, f in leaves(case.stage.input):
        if f.kind != "int":
            size = float(np.abs(leaf(case.inputs, name)).max())
            values = [np.nan, np.inf, -np.inf]
            if name != "time":
                values += [_SATURATION * (size + 1.0), -_SATURATION * (size + 1.0)]
            yield from (Fault(f"{name} = {v:.3g}", _setter(name, v)) for v in values)
    yield Fault("repeated samples", _repeat)
    yield Fault("dropout", _drop)
    if "time" in case.stage.input.fields:
        yield Fault("time jumps ahead", _shifter(_JUMP, lasting=True))
        yield Fault("time jumps back", _shifter(-_JUMP, lasting=True))
        yield Fault("time is late for a while", _shifter(-_JUMP, lasting=False))


def rough(case: Case, inputs: Records) -> Records:
    """Return inputs with every fault in it, one after the other, on every joint."""
    worse = inputs.copy()
    faults = list(faults_of(case))
    step = max(len(inputs) // (len(faults) + 2), 1)
    for count, fault in enumerate(faults):
        at = min((count + 1) * step, len(inputs) - 1)
        for j in range(inputs.shape[1]):
            fault.apply(worse[at:, j], 0)
    return worse


def recovers(case: Case) -> Iterator[str]:
    """After each fault and ``settle`` good samples, all is finite that is so without the fault.

    A fault of one joint changes nothing of another.
    """
    before = min(case.settle, len(case.inputs) // 2)
    inputs = case.inputs[: before + _LENGTH + _GAP + case.settle]
    clean, clean_state = case.run(inputs)
    for fault in faults_of(case):
        bad = inputs.copy()
        fault.apply(bad[:, 0], before)
        out, state = case.run(bad)
        for records, wanted, layout in (
            (out[-1:, 0], clean[-1:, 0], case.stage.output),
            (state[:1], clean_state[:1], case.stage.state),
        ):
            lost = ~finite(records, layout) & finite(wanted, layout)
            names = [numbers(layout)[i][0] for i in np.flatnonzero(lost.any(axis=0))]
            if names:
                yield f"after {fault.name}: {layout.name}.{', '.join(names[:5])} not finite"
        labels = (f"{fault.name} on joint 0: another joint without", "with")
        yield from differences(clean[:, 1:], out[:, 1:], case.stage.output, labels)


def status_says_why(case: Case) -> Iterator[str]:
    """Where there is a ``status``, a sample that is not finite sets it if it changes anything."""
    if "status" not in case.stage.output.fields:
        return
    at = min(case.settle, len(case.inputs) // 2)
    inputs = case.inputs[: at + 1]
    clean, _ = case.run(inputs)
    for fault in faults_of(case):
        if not fault.name.endswith(("nan", "inf")):
            continue
        bad = inputs.copy()
        fault.apply(bad[:, 0], at)
        out, _ = case.run(bad)
        changed = any(differences(clean[at:], out[at:], case.stage.output, ("", "")))
        if changed and out["status"][at, 0] == 0:
            yield f"{fault.name} changes the output and status stays 0"


def _setter(name: str, value: float) -> Callable[[Records, int], None]:
    def apply(records: Records, at: int) -> None:
        leaf(records, name)[at : at + _LENGTH] = value

    return apply


def _repeat(records: Records, at: int) -> None:
    records[at : at + _LENGTH] = records[max(at - 1, 0)]


def _drop(records: Records, at: int) -> None:
    kept = records[at + _GAP :].copy()
    records[at : at + len(kept)] = kept
    if len(kept):  # the log ends early: its last sample comes again and again
        records[at + len(kept) :] = kept[-1]


def _shifter(seconds: float, *, lasting: bool) -> Callable[[Records, int], None]:
    def apply(records: Records, at: int) -> None:
        end = None if lasting else at + _LENGTH
        records["time"][at:end] += seconds

    return apply
