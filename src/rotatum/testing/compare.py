"""Records compared bit for bit; every NaN is the same NaN."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rotatum.export.structs import words
from rotatum.export.types import FLOAT, of_layout
from rotatum.record import Layout, Records


def numbers(layout: Layout) -> list[tuple[str, bool]]:
    """Return the name of every 8-byte number in a record and whether it is a float."""
    return [(name, kind is FLOAT) for name, kind in words(of_layout(layout))]


def differences(a: Records, b: Records, layout: Layout, labels: tuple[str, str]) -> Iterator[str]:
    """Yield a sentence about the first place, if any, where two arrays of records differ."""
    if a.shape != b.shape:
        yield f"{labels[0]} has shape {a.shape}, {labels[1]} {b.shape}"
        return
    x, y = _bits(a, layout), _bits(b, layout)
    places = np.argwhere(x != y)
    if len(places):
        *where, number = (int(i) for i in places[0])
        name, is_float = numbers(layout)[number]
        index = (*where, number)
        shown = [_shown(array[index], is_float) for array in (x, y)]
        yield (
            f"{layout.name}.{name} at {tuple(where)}: {labels[0]} {shown[0]}, {labels[1]} "
            f"{shown[1]} ({len(places)} of {x.size} numbers differ)"
        )


def finite(records: Records, layout: Layout) -> NDArray[np.bool_]:
    """Return, per number of each record, whether it is finite; integers are."""
    floats = np.array([is_float for _, is_float in numbers(layout)])
    good: NDArray[np.bool_] = np.isfinite(_words(records, layout).view(np.float64)) | ~floats
    return good


def _words(records: Records, layout: Layout) -> NDArray[np.uint64]:
    flat = np.ascontiguousarray(records).view(np.uint64)
    return flat.reshape(*records.shape, layout.dtype.itemsize // 8)


def _bits(records: Records, layout: Layout) -> NDArray[np.uint64]:
    flat = _words(records, layout)
    floats = np.array([is_float for _, is_float in numbers(layout)])
    return np.where(np.isnan(flat.view(np.float64)) & floats, np.uint64(0x7FF8 << 48), flat)


def _shown(word: np.uint64, is_float: bool) -> str:
    one = np.array([word])
    return repr(float(one.view(np.float64)[0]) if is_float else int(one.view(np.int64)[0]))
