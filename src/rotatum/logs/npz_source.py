"""NPZ logs: numpy's archive of arrays."""

from __future__ import annotations

import zipfile
import zlib

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.array_source import ArraySource
from rotatum.logs.source import unreadable

__all__ = ["open_npz"]

_DAMAGE = (zipfile.BadZipFile, zlib.error, ValueError, EOFError, KeyError, OSError)


def open_npz(path: str) -> ArraySource:
    """Open an NPZ archive; arrays are read when picked, never unpickled.

    Raises
    ------
    LogError if the file is damaged or truncated.
    """
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            names = tuple(archive.files)
    except _DAMAGE as error:
        raise unreadable(path, "NPZ", error) from error

    def load(name: str) -> NDArray[np.generic]:
        try:
            with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
                array: NDArray[np.generic] = archive[name]
        except ValueError as error:
            if "pickle" not in str(error):
                raise unreadable(path, "NPZ", error) from error
            raise LogError(f'"{name}" holds Python objects, not numbers', where=path) from error
        except _DAMAGE as error:
            raise unreadable(path, "NPZ", error) from error
        return array

    return ArraySource(path, "NPZ", names, load)
