"""URDF files: those that come with the package, and the user's."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from rotatum.errors import DeviceError, nearest

__all__ = ["read_urdf", "urdf_names"]


def urdf_names() -> tuple[str, ...]:
    """Return the names of the packaged URDF files, sorted."""
    entries = (files("rotatum.models.robot") / "urdf").iterdir()
    return tuple(sorted(e.name.removesuffix(".urdf") for e in entries if e.name.endswith(".urdf")))


def read_urdf(name_or_path: str, folder: Path | None = None, *, where: str | None = None) -> str:
    """Return the text of a URDF file.

    Parameters
    ----------
    name_or_path : a name of `urdf_names()`, or a path.
    folder : what a relative path is relative to; None: where the process runs.
    where : what messages call the place that names it; None: the path.

    Raises
    ------
    DeviceError if there is no such file, or it is no text.
    """
    names = urdf_names()
    if name_or_path in names:
        return (files("rotatum.models.robot") / "urdf" / f"{name_or_path}.urdf").read_text("utf-8")
    path = (folder or Path()) / name_or_path
    where = where or str(path)
    try:
        return path.read_text("utf-8")
    except FileNotFoundError:
        close = nearest(name_or_path, names)
        hint = f'Did you mean "{close}"?' if close else None
        what = "no such URDF file, and none of this name in the package"
        raise DeviceError(what, where=where, value=name_or_path, allowed=names, hint=hint) from None
    except UnicodeDecodeError:
        raise DeviceError("is not a text file in UTF-8", where=where) from None
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise DeviceError(f"cannot be read ({reason})", where=where) from error
