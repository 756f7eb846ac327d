"""Writing NPZ archives."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

__all__ = ["NpzSink"]


class NpzSink:
    """Collects chunks and writes them as one compressed archive.

    Parameters
    ----------
    path : the file; written when closed.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._chunks: dict[str, list[NDArray[np.generic]]] = {}
        # Found out now rather than after the computation: can there be such a file?
        path.open("wb").close()

    def write(self, columns: Mapping[str, NDArray[np.generic]]) -> None:
        """Keep a copy of the rows."""
        for name, column in columns.items():
            self._chunks.setdefault(name, []).append(np.array(column))

    def close(self) -> None:
        """Write the archive: one .npy per column, any name, as numpy.load expects."""
        with zipfile.ZipFile(self._path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, chunks in self._chunks.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                    npy.write_array(entry, np.concatenate(chunks), allow_pickle=False)

    def abandon(self) -> None:
        """Forget the rows."""
        self._chunks.clear()
