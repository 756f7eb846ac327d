"""Writing a file so that it is there whole or not at all."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rotatum.errors import OutputError

__all__ = ["beside"]


@contextmanager
def beside(path: str | Path) -> Iterator[Path]:
    """Give a path to write to; what is there takes the place of `path` when the block ends well.

    The new file is written beside the old one and renamed, so that an error, a full disk or an
    interruption leaves the old file as it was and no partial one. A device such as /dev/null and
    a pipe are written to as they are.

    Parameters
    ----------
    path : the file to write.

    Raises
    ------
    OutputError if the folder does not exist, is not writable, or the disk is full.

    >>> with beside("out.txt") as new:  # doctest: +SKIP
    ...     new.write_text("all of it")
    """
    shown = str(path)
    target = Path(os.path.realpath(path))  # through a link, so that the link stays one
    direct = _is_device(target, shown)
    new = target if direct else target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        yield new
        if not direct:
            os.replace(new, target)
    except OSError as error:
        raise _not_written(error, shown, target) from error
    finally:
        if not direct:
            with suppress(OSError):
                new.unlink(missing_ok=True)


def _is_device(target: Path, shown: str) -> bool:
    """Say whether the target is a device or a pipe; refuse a folder."""
    try:
        mode = target.stat().st_mode
    except OSError:
        return False
    if stat.S_ISDIR(mode):
        raise OutputError("is a folder; give the name of a file", where=shown)
    return not stat.S_ISREG(mode)


def _not_written(error: OSError, shown: str, target: Path) -> OutputError:
    """Say why a file was not written."""
    if isinstance(error, FileNotFoundError) and not target.parent.is_dir():
        return OutputError(f"the folder {target.parent.name!r} does not exist", where=shown)
    reason = error.strerror or str(error) or type(error).__name__
    return OutputError(f"cannot be written ({reason}); no partial file is left", where=shown)
