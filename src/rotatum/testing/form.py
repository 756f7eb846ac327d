"""Clauses about how a stage is written: the subset, its records, its references."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rotatum.export.checker import in_stage
from rotatum.record import Layout
from rotatum.testing.case import Case
from rotatum.testing.report import SkippedError
from rotatum.testing.signals import leaves

_UNITS = frozenset(["", "1", "rad", "s", "N", "m", "kg", "A", "V", "K", "Hz"])


def is_in_subset(case: Case) -> Iterator[str]:
    """Every kernel it reaches is inside the exportable subset, types included."""
    yield from map(str, in_stage(case.stage))


def is_documented(case: Case) -> Iterator[str]:
    """Kernels have a docstring, records and all their fields a line of documentation."""
    for kernel in (case.stage.init, case.stage.step):
        written = not kernel.__code__.co_filename.startswith("<rotatum ")
        if written and not (kernel.__doc__ or "").strip():
            yield f"{kernel.__qualname__} has no docstring"
    for layout in _records(case):
        if not layout.doc.strip():
            yield f"record {layout.name} has no docstring"
        for name, f in leaves(layout):
            if not f.doc.strip():
                yield f"{layout.name}.{name} has no documentation"


def names_its_fields(case: Case) -> Iterator[str]:
    """Field names are identifiers in C too; those numpy's records use are refused by ``Layout``."""
    for layout in _records(case):
        for name, _ in leaves(layout):
            for part in name.split("."):
                if not (part.isidentifier() and part.isascii()):
                    yield f"{layout.name}.{name}: no identifier in C"


def has_units(case: Case) -> Iterator[str]:
    """Units are SI, spelled as ``N m s/rad`` (empty: dimensionless), or say whose unit it is."""
    for layout in _records(case):
        for name, f in leaves(layout):
            unit = f.unit
            if "unit of" in unit:
                continue
            tokens = re.split(r"[\s/]+", re.sub(r"\^-?\d+|[()]", "", unit))
            odd = [t for t in tokens if t not in _UNITS]
            if odd:
                yield f"{layout.name}.{name}: unit {unit!r} is not SI: {', '.join(odd)}"
            if f.kind == "int" and unit:
                yield f"{layout.name}.{name}: an integer counts or selects, it has no unit"


def prints_itself(case: Case) -> Iterator[str]:
    """The ``repr`` of a bank names the stage and stays on one short line."""
    text = repr(case.bank(compile=False))
    if case.stage.name not in text or "\n" in text or len(text) > 200:
        yield f"repr of the bank is {text!r}"
    if not case.stage.name.isidentifier():
        yield f"the name {case.stage.name!r} is no identifier"


def cites_known_work(case: Case) -> Iterator[str]:
    """Every citation key is in the list of references."""
    if case.references is None:
        raise SkippedError("no list of references was given")
    for key in case.stage.cites:
        if key not in case.references:
            yield f"{key} is not in the list of references"


def _records(case: Case) -> tuple[Layout, ...]:
    stage = case.stage
    return tuple(dict.fromkeys((stage.params, stage.state, stage.input, stage.output)))
