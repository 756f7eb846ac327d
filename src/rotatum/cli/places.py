"""Whether results can be written where they are asked for, said before the work and not after."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from rotatum.errors import OutputError

__all__ = ["check_folder", "check_places"]


def check_places(outputs: Sequence[Path | None], inputs: Sequence[Path] = ()) -> None:
    """Refuse files that cannot be written, or that are one another or an input.

    Parameters
    ----------
    outputs : files to write; None: not asked for.
    inputs : files that are read meanwhile.

    Raises
    ------
    OutputError naming the file.
    """
    taken = [(path, "is read as input") for path in inputs]
    for path in outputs:
        if path is None:
            continue
        if path.is_dir():
            raise OutputError("is a folder; give the name of a file", where=str(path))
        for other, what in taken:
            if os.path.realpath(other) == os.path.realpath(path) and not _is_device(path):
                raise OutputError(f"cannot be written: the same file {what}", where=str(path))
        _check_parent(path)
        taken.append((path, "is written as another result"))


def check_folder(path: Path) -> None:
    """Refuse a folder that neither exists nor can be made, or that cannot be written to.

    Parameters
    ----------
    path : the folder.

    Raises
    ------
    OutputError naming the folder.
    """
    if path.exists():
        if not path.is_dir():
            raise OutputError("is a file, not a folder", where=str(path))
        if not os.access(path, os.W_OK | os.X_OK):
            raise OutputError("the folder is not writable", where=str(path))
        return
    there = next((p for p in path.absolute().parents if p.exists()), Path("/"))
    if not (there.is_dir() and os.access(there, os.W_OK | os.X_OK)):
        raise OutputError(f"the folder cannot be made in {str(there)!r}", where=str(path))


def _check_parent(path: Path) -> None:
    if _is_device(path):
        return
    parent = Path(os.path.realpath(path)).parent
    if not parent.is_dir():
        raise OutputError(f"the folder {str(path.parent)!r} does not exist", where=str(path))
    if not os.access(parent, os.W_OK | os.X_OK):
        raise OutputError(f"the folder {str(path.parent)!r} is not writable", where=str(path))


def _is_device(path: Path) -> bool:
    return path.exists() and not path.is_file()
