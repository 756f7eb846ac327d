"""Every error of the library: one base class, data on attributes, one readable sentence."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

__all__ = [
    "DatasetError",
    "DeviceError",
    "ExtraError",
    "LogError",
    "MethodError",
    "OutputError",
    "RotatumError",
    "ScenarioError",
    "SimulationError",
    "check_names",
    "nearest",
]

_LISTED = 12  # names shown of a long list; more would bury the sentence


class RotatumError(Exception):
    """An input the library cannot work with, said in one sentence.

    Parameters
    ----------
    what : what is wrong, without the place, the value and the final stop.
    where : file, key, row or column the error is about.
    value : the offending value as it was given.
    allowed : what would have been accepted: names, or a phrase.
    hint : a further sentence: what to do about it.
    """

    def __init__(
        self,
        what: str,
        *,
        where: str | None = None,
        value: object = None,
        allowed: Sequence[str] | str | None = None,
        hint: str | None = None,
    ) -> None:
        self.what = what
        self.where = where
        self.value = value
        self.allowed = allowed
        self.hint = hint
        super().__init__(_sentence(what, where, value, allowed, hint))


class DeviceError(RotatumError):
    """A device file or catalogue name that cannot be used."""


class LogError(RotatumError):
    """A log that cannot be read, or whose columns do not fit the device."""


class MethodError(RotatumError):
    """A method that does not exist, or that lacks channels or parameters it needs."""


class OutputError(RotatumError):
    """A result that could not be written; no partial file is left behind."""


class DatasetError(RotatumError):
    """A public data set that is unknown, unreachable or damaged."""


class ScenarioError(RotatumError):
    """A scenario file or name that cannot be used."""


class SimulationError(RotatumError):
    """A motion that left the range of a law, or diverged.

    Attributes
    ----------
    log : the log until then, a `rotatum.logs.Log`; None where nothing was simulated.
    """

    log: object = None


class ExtraError(RotatumError):
    """A feature whose optional dependency is not installed.

    Parameters
    ----------
    what : the feature asked for, such as "reading Parquet needs pyarrow".
    extra : the extra of this package that brings the dependency.
    where : file or option the feature was asked for.
    """

    def __init__(self, what: str, *, extra: str, where: str | None = None) -> None:
        self.extra = extra
        super().__init__(what, where=where, hint=f'Install it: pip install "rotatum[{extra}]".')

    def __reduce__(self) -> tuple[object, ...]:
        """Say how it is made again in another process; `extra` has no default."""
        return _extra_error, (self.what, self.extra, self.where)


def check_names(names: Iterable[str], allowed: Sequence[str], *, what: str, where: str) -> None:
    """Refuse names that are not allowed, suggesting the nearest one that is.

    Parameters
    ----------
    names : as they were given.
    allowed : the names there are.
    what, where : of the error.

    Raises
    ------
    RotatumError about the first of them.
    """
    for name in names:
        if name not in allowed:
            close = nearest(name, allowed)
            hint = f"Did you mean {close!r}?" if close else None
            raise RotatumError(what, where=where, value=name, allowed=tuple(allowed), hint=hint)


def _extra_error(what: str, extra: str, where: str | None) -> ExtraError:
    return ExtraError(what, extra=extra, where=where)


def nearest(name: str, allowed: Iterable[str]) -> str | None:
    """Return the allowed name most like `name`, or None if none is close.

    >>> nearest("intertia", ["inertia", "damping"])
    'inertia'
    >>> nearest("payload", ["inertia", "damping"]) is None
    True
    """
    by_lower = {candidate.lower(): candidate for candidate in allowed}
    close = difflib.get_close_matches(name.lower(), list(by_lower), n=1, cutoff=0.6)
    return by_lower[close[0]] if close else None


def _sentence(
    what: str,
    where: str | None,
    value: object,
    allowed: Sequence[str] | str | None,
    hint: str | None,
) -> str:
    """Join the parts of an error into a sentence."""
    text = f"{where}: {what}" if where else what
    if value is not None:
        text += f", got {value!r}"
    if allowed:
        text += f"; allowed: {allowed if isinstance(allowed, str) else _listing(allowed)}"
    if not text.endswith((".", "!", "?")):
        text += "."
    return f"{text} {hint}" if hint else text


def _listing(names: Sequence[str]) -> str:
    """Join names, cutting a long list short."""
    shown = ", ".join(names[:_LISTED])
    left = len(names) - _LISTED
    return f"{shown} and {left} more" if left > 0 else shown
