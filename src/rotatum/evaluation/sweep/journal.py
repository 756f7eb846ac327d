"""Finished cases on the disk, one small file each: a sweep that was killed goes on from there."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from rotatum.errors import OutputError
from rotatum.logs.beside import beside

__all__ = ["Journal"]

_HEADER = "sweep.json"
_CASES = "case-*.json"
_PARTIAL = ".*.partial"  # what `beside` leaves where its process is killed
_SHOWN = 4  # differences named of a journal that is another sweep's


class Journal:
    """The results of a sweep so far, in the folder ``TABLE.cases`` beside its table.

    Numbers are written as the shortest text that gives back the same double, so that a table made
    from the journal has the same bits whenever its cases ran.

    Args:
        table: the sweep's table.
        header: all that decides the results.
        restart: forget what another run left.

    Raises:
        OutputError: the folder cannot be written, holds another sweep, or is no journal.
    """

    def __init__(self, table: Path, header: Mapping[str, Any], *, restart: bool = False) -> None:
        self.folder = table.with_name(f"{table.name}.cases")
        self._header = json.loads(_text(header))
        if self.folder.exists():
            self._check(restart)
        self._write(_HEADER, self._header)
        for path in self.folder.glob(_PARTIAL):
            path.unlink(missing_ok=True)

    def results(self) -> dict[int, dict[str, Any]]:
        """Return case number to result, in the order of the cases."""
        found = {}
        for path in sorted(self.folder.glob(_CASES)):
            result = _read(path)
            # A file that a power cut left empty is a case to do again.
            if result is not None:
                found[int(result["case"])] = result
        return dict(sorted(found.items()))

    def add(self, result: Mapping[str, Any]) -> None:
        """Keep a finished case; the file is there whole or not at all.

        Raises:
            OutputError: it cannot be written.
        """
        self._write(f"case-{result['case']:06d}.json", result)

    def remove(self) -> None:
        """Take the folder away; files of somebody else stay."""
        for pattern in (_CASES, _PARTIAL, _HEADER):
            for path in self.folder.glob(pattern):
                path.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _check(self, restart: bool) -> None:
        shown = str(self.folder)
        if not self.folder.is_dir():
            raise OutputError("is a file, and the sweep's journal needs the name", where=shown)
        header = self.folder / _HEADER
        if not header.exists():
            if any(self.folder.iterdir()):
                what = "is in the way of the sweep's journal"
                raise OutputError(what, where=shown, hint="Move it, or name another table.")
            return
        if restart:
            self.remove()
            return
        hint = "--restart forgets it; or name another table."
        left = _read(header)
        if left is None:
            raise OutputError("is a damaged journal", where=shown, hint=hint)
        differences = list(_differences(left, self._header))
        if differences:
            more = len(differences) - _SHOWN
            named = "; ".join(differences[:_SHOWN]) + (f"; {more} more" if more > 0 else "")
            what = f"is the journal of another sweep ({named})"
            raise OutputError(what, where=shown, hint=hint)

    def _write(self, name: str, value: Mapping[str, Any]) -> None:
        try:
            self.folder.mkdir(exist_ok=True)
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise OutputError(f"cannot be made ({reason})", where=str(self.folder)) from error
        with beside(self.folder / name) as new:
            new.write_text(_text(value), "utf-8")


def _text(value: Mapping[str, Any]) -> str:
    # NaN and the infinities are written by name, which Python reads back; dates by theirs.
    return json.dumps(value, ensure_ascii=False, default=str) + "\n"


def _read(path: Path) -> dict[str, Any] | None:
    try:
        found = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def _differences(left: Any, now: Any, key: str = "") -> Iterator[str]:
    """Name the keys whose values differ, with both."""
    if isinstance(left, dict) and isinstance(now, dict):
        for name in dict.fromkeys((*left, *now)):
            inner = f"{key}.{name}" if key else str(name)
            yield from _differences(left.get(name), now.get(name), inner)
        if list(left) != list(now) and set(left) == set(now) and key == "vary":
            yield f"{key}: the order of the keys"
    elif repr(left) != repr(now):  # NaN is itself here, 1 is not 1.0
        yield f"{key}: then {_brief(left)}, now {_brief(now)}"


def _brief(value: Any) -> str:
    if value is None:
        return "nothing"
    text = str(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
