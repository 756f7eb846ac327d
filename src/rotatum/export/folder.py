"""Writing the files of an exported project so that they are there whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rotatum.errors import OutputError

_MARK = "# Files: "
_BUILT = {"selftest"}  # what `make` adds


@contextmanager
def project_folder(directory: Path) -> Iterator[Path]:
    """Give a folder to write a project to; its files take their places when the block ends well.

    A folder that is there may be empty or an earlier export, which is replaced.

    Raises:
        OutputError: it holds anything else, or cannot be written; then it is as it was.
    """
    shown, target = str(directory), Path(os.path.realpath(directory))
    earlier = _earlier_files(target, shown)
    work = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        hidden = f".{target.name}."
        work = Path(tempfile.mkdtemp(prefix=hidden, suffix=".partial", dir=target.parent))
        yield work
        _put(work, target, earlier)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        what = f"cannot be written ({reason}); nothing is left of it"
        raise OutputError(what, where=shown) from error
    finally:
        if work is not None:
            shutil.rmtree(work, ignore_errors=True)


def _earlier_files(target: Path, shown: str) -> set[str]:
    """Return the files of an earlier export; refuse a folder that holds others."""
    if not target.exists():
        return set()
    if not target.is_dir():
        raise OutputError("is a file; give the name of a folder", where=shown)
    there = {entry.name for entry in target.iterdir()}
    listed: set[str] = set()
    if (target / "Makefile").is_file():
        lines = (target / "Makefile").read_text(encoding="utf-8", errors="replace").splitlines()
        marked = (line for line in lines if line.startswith(_MARK))
        listed = set(next(marked, _MARK).removeprefix(_MARK).split())
    strangers = sorted(there - listed - (_BUILT if listed else set()))
    if strangers:
        what = "the folder holds files that are not from an earlier export"
        hint = "Give an empty or new folder."
        raise OutputError(what, where=shown, value=strangers[:5], hint=hint)
    return there & listed


def _put(work: Path, target: Path, earlier: set[str]) -> None:
    work.chmod(0o777 & ~_umask())
    if not target.exists():
        os.rename(work, target)
        return
    # One file at a time: the folder itself may be somebody's current directory.
    written = {file.name for file in work.iterdir()}
    for name in sorted(written):
        os.replace(work / name, target / name)
    for name in earlier - written:
        with suppress(OSError):
            (target / name).unlink()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
