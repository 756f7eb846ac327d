"""Which format a log has: by its first bytes, checked against the ending of its name."""

from __future__ import annotations

from pathlib import Path

from rotatum.errors import LogError, nearest
from rotatum.logs.csv_source import CsvSource
from rotatum.logs.hdf5_source import open_hdf5
from rotatum.logs.mat_source import open_mat
from rotatum.logs.npz_source import open_npz
from rotatum.logs.parquet_source import ParquetSource
from rotatum.logs.source import Source

__all__ = ["open_source"]

# First bytes -> format. MAT 7.3 is HDF5 behind a header of its own.
_MAGIC = (
    (b"PK\x03\x04", "npz"),
    (b"PK\x05\x06", "npz"),
    (b"MATLAB 7.3", "hdf5"),
    (b"MATLAB 5.0", "mat"),
    (b"\x89HDF", "hdf5"),
    (b"PAR1", "parquet"),
)
# Ending -> formats its content may have.
_ENDINGS = {
    ".csv": ("csv",),
    ".tsv": ("csv",),
    ".txt": ("csv",),
    ".dat": ("csv",),
    ".csv.gz": ("csv",),
    ".tsv.gz": ("csv",),
    ".txt.gz": ("csv",),
    ".npz": ("npz",),
    ".mat": ("mat", "hdf5"),
    ".h5": ("hdf5",),
    ".hdf5": ("hdf5",),
    ".parquet": ("parquet",),
    ".pq": ("parquet",),
}


def open_source(path: str | Path) -> Source:
    """Open a log file of any format.

    Raises
    ------
    LogError if the file is missing, empty, unreadable, of no known format, or of another format
    than its name says; ExtraError if its format needs a package that is not installed.
    """
    text = str(path)
    ending = _ending(text)
    content = _content(text)
    if not content:
        raise LogError("is empty", where=text)
    found = next((kind for magic, kind in _MAGIC if content.startswith(magic)), None)
    if ending is None and found is None and b"\0" in content:
        raise LogError("is of no known format", where=text, allowed=tuple(_ENDINGS))
    expected = _ENDINGS.get(ending, ()) if ending is not None else ()
    kind = found or (expected[0] if expected else "csv")
    if expected and kind not in expected:
        raise LogError(f"is named {ending} but holds {kind}", where=text)
    # A MAT file of version 4 starts with no mark of its own.
    if found is None and kind not in ("csv", "mat"):
        raise LogError(f"is named {ending} but does not hold {kind}", where=text)
    return _open(kind, text)


def _open(kind: str, path: str) -> Source:
    """Open a file whose format is known."""
    if kind == "npz":
        return open_npz(path)
    if kind == "mat":
        return open_mat(path)
    if kind == "hdf5":
        return open_hdf5(path)
    if kind == "parquet":
        return ParquetSource(path)
    return CsvSource(path)


def _ending(path: str) -> str | None:
    """Return the known ending of a file's name."""
    name = Path(path).name.lower()
    return next((ending for ending in _ENDINGS if name.endswith(ending)), None)


def _content(path: str) -> bytes:
    """Return the first bytes of a file, or say why it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read(1024)
    except FileNotFoundError:
        raise _missing(path) from None
    except IsADirectoryError:
        raise LogError("is a folder, not a log", where=path) from None
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise LogError(f"cannot be read ({reason})", where=path) from error


def _missing(path: str) -> LogError:
    """Say that there is no such file, and which one beside it has nearly that name."""
    folder = Path(path).parent
    try:
        beside = [entry.name for entry in folder.iterdir() if entry.is_file()]
    except OSError:
        return LogError("no such file; its folder does not exist either", where=path)
    close = nearest(Path(path).name, beside)
    return LogError("no such file", where=path, hint=f'Did you mean "{close}"?' if close else None)
