"""MAT logs up to version 7.2: variables, and fields of nested structs by dotted path."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.logs.array_source import ArraySource
from rotatum.logs.source import unreadable

__all__ = ["open_mat"]


def open_mat(path: str) -> ArraySource:
    """Open a MAT file of version 4 to 7.2.

    Raises
    ------
    LogError if the file is not one, or is damaged or truncated.
    """
    from scipy.io import loadmat

    try:
        variables = loadmat(path)
    except Exception as error:  # scipy's reader lets parsing errors of any type through
        raise unreadable(path, "MAT", error) from error
    arrays: dict[str, NDArray[np.generic]] = {}
    for name, value in variables.items():
        # MATLAB's objects come without a name; "__header__" and the like are not variables.
        if isinstance(name, str) and not name.startswith("__"):
            arrays.update(_numbers(name, value))
    return ArraySource(path, "MAT", tuple(arrays), arrays.__getitem__)


def _numbers(path: str, value: Any) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Yield the arrays below a variable with their dotted paths."""
    from scipy.io.matlab import MatlabFunction, MatlabOpaque

    if not isinstance(value, np.ndarray) or isinstance(value, MatlabFunction | MatlabOpaque):
        return
    if value.dtype.names and value.size == 1:
        for name in value.dtype.names:
            yield from _numbers(f"{path}.{name}", value.flat[0][name])
    elif value.dtype.kind in "fiub":
        yield path, value
