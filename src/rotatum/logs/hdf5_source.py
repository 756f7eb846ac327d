"""HDF5 logs and MAT files of version 7.3, which are HDF5: data sets by dotted path."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import ExtraError
from rotatum.logs.array_source import ArraySource
from rotatum.logs.source import unreadable

__all__ = ["open_hdf5"]


def open_hdf5(path: str) -> ArraySource:
    """Open an HDF5 file; data sets are read when picked.

    Raises
    ------
    ExtraError if h5py is not installed; LogError if the file is damaged or truncated.
    """
    try:
        import h5py
    except ImportError:
        what = "reading HDF5 and MAT 7.3 needs h5py"
        raise ExtraError(what, extra="hdf5", where=path) from None

    names: list[str] = []

    def note(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and not name.startswith("#"):
            names.append(name.replace("/", "."))

    def load(name: str) -> NDArray[np.generic]:
        try:
            with h5py.File(path, "r") as file:
                return np.asarray(file[name.replace(".", "/")][()])
        except (OSError, RuntimeError) as error:
            raise unreadable(path, "HDF5", error) from error

    try:
        with h5py.File(path, "r") as file:
            file.visititems(note)
    except (OSError, RuntimeError) as error:
        raise unreadable(path, "HDF5", error) from error
    return ArraySource(path, "HDF5", tuple(names), load)
