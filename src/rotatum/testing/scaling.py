"""The clause about units: a change of unit only scales the result."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from rotatum.record import Layout, Records
from rotatum.testing.case import Case
from rotatum.testing.report import SkippedError
from rotatum.testing.signals import leaf, leaves

FACTOR = 1024.0
"""A power of two: rounding is the same in both units, so only a forgotten unit shows."""

_TOLERANCE = 1e-9  # of a field's largest value: exp, sin and cos round on either side


def units_only_scale(case: Case) -> Iterator[str]:
    """With inputs and params in another unit, outputs are the same in that unit."""
    if case.scale is None:
        raise SkippedError("no exponents of a change of unit were given")
    known = {
        f"{role}.{name}"
        for role in ("params", "u", "out")
        for name, _ in leaves(_layout(case, role))
    }
    unknown = sorted(set(case.scale) - known)
    if unknown:
        yield f"scale names no float field: {', '.join(unknown)}"
        return
    out, _ = case.run(case.inputs)
    other = type(case)(
        case.stage,
        _scaled(case.params, "params", case.scale),
        _scaled(case.inputs, "u", case.scale),
        case.seed, case.settle, case.endurance, case.scale, case.references,
    )  # fmt: skip
    found, _ = other.run(other.inputs)
    wanted = _scaled(out, "out", case.scale)
    for name, _ in leaves(case.stage.output):
        a, b = leaf(wanted, name), leaf(found, name)
        size = np.nanmax(np.abs(a), initial=0.0) or 1.0
        apart = np.where(np.isfinite(a) | np.isfinite(b), np.abs(a - b), 0.0)
        if not np.nanmax(apart, initial=0.0) <= _TOLERANCE * size or np.isnan(apart).any():
            first = np.argwhere(~(apart <= _TOLERANCE * size))[0]
            place = tuple(int(i) for i in first)
            yield f"out.{name} at {place}: {a[place]!r} expected in the other unit, {b[place]!r}"


def _layout(case: Case, role: str) -> Layout:
    roles = {"params": case.stage.params, "u": case.stage.input, "out": case.stage.output}
    return roles[role]


def _scaled(records: Records, role: str, scale: Mapping[str, float]) -> Records:
    scaled = records.copy()
    for name, exponent in scale.items():
        head, _, tail = name.partition(".")
        if head == role:
            leaf(scaled, tail)[...] *= FACTOR**exponent
    return scaled
