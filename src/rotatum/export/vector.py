"""The test vector of an exported project: inputs in full, outputs in part and as digests of all.

The file is 8-byte little-endian words: a header; then per sample, joint by joint, the input and,
for the first ``HEAD`` samples and every ``STRIDE``-th one, the output; and after every ``BLOCK``
samples a digest of all their outputs. So 100,000 samples are compared bit for bit, a difference
is located, and the file stays small.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from rotatum.export.structs import words
from rotatum.export.types import FLOAT, of_layout
from rotatum.record import Layout, Records

MAGIC = 0x314D5554_41544F52  # "ROTATUM1", read as a little-endian word
BLOCK, HEAD, STRIDE = 1000, 1000, 100

_Words = NDArray[np.uint64]
_NAN = np.uint64(0x7FF8000000000000)
_BASIS, _PRIME = np.uint64(0xCBF29CE484222325), np.uint64(0x100000001B3)


def write_vector(
    file: BinaryIO, layouts: tuple[Layout, Layout], inputs: Records, outputs: Records
) -> None:
    """Write a test vector.

    Args:
        file: open for writing bytes.
        layouts: of the input and of the output.
        inputs: ``(N, n)`` records.
        outputs: ``(N, n)`` records, what the stage makes of them.
    """
    samples, joints = inputs.shape
    u = _as_words(inputs, layouts[0])
    y = _canonical(_as_words(outputs, layouts[1]), layouts[1])
    header = [MAGIC, joints, samples, u.shape[2], y.shape[2], BLOCK, HEAD, STRIDE]
    _write(file, np.array(header, np.uint64))
    digests = _digests(y.reshape(samples, -1))
    for k in range(samples):
        stored = k < HEAD or k % STRIDE == 0
        _write(file, np.concatenate([u[k], y[k]], axis=1) if stored else u[k])
        if (k + 1) % BLOCK == 0 or k + 1 == samples:
            _write(file, digests[k // BLOCK : k // BLOCK + 1])


def kinds(layout: Layout) -> str:
    """Return a letter per word of a record: f for a float, i for an integer."""
    return "".join("f" if kind is FLOAT else "i" for _, kind in words(of_layout(layout)))


def _as_words(records: Records, layout: Layout) -> _Words:
    flat = np.ascontiguousarray(records).view(np.uint64)
    return flat.reshape(*records.shape, layout.dtype.itemsize // 8)


def _canonical(y: _Words, layout: Layout) -> _Words:
    """Return the words with every NaN the same one."""
    floats = np.array([kind == "f" for kind in kinds(layout)])
    return np.where(np.isnan(y.view(np.float64)) & floats, _NAN, y)


def _digests(y: _Words) -> _Words:
    """Return the digest of each block of rows: FNV-1a over words, folded."""
    blocks = -(-len(y) // BLOCK)
    found = np.full(blocks, _BASIS)
    whole = len(y) // BLOCK
    found[:whole] = _digest(y[: whole * BLOCK].reshape(whole, -1), found[:whole])
    if blocks > whole:
        found[whole:] = _digest(y[whole * BLOCK :].reshape(1, -1), found[whole:])
    return found


def _digest(rows: _Words, start: _Words) -> _Words:
    hashes = start.copy()
    for column in rows.T:
        hashes = (hashes ^ column) * _PRIME
        hashes ^= hashes >> np.uint64(32)
    return hashes


def _write(file: BinaryIO, array: _Words) -> None:
    file.write(np.ascontiguousarray(array, dtype="<u8").tobytes())
