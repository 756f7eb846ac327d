"""Names a robot does not have: the error, with the nearest it has."""

from __future__ import annotations

from collections.abc import Sequence

from rotatum.errors import DeviceError, nearest

__all__ = ["no_such"]


def no_such(
    kind: str, name: str, allowed: Sequence[str], *, where: str | None = None
) -> DeviceError:
    """Return the error of a name that is not there.

    Parameters
    ----------
    kind : "frame", "joint", ...
    name : the name given.
    allowed : the names there are.
    where : file the error is about.
    """
    close = nearest(name, allowed)
    hint = f'Did you mean "{close}"?' if close else None
    what = f"the robot has no such {kind}"
    return DeviceError(what, where=where, value=name, allowed=tuple(allowed), hint=hint)
