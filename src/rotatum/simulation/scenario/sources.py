"""Where scenarios come from: ready ones in the package, files, and what they extend."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from rotatum.errors import ScenarioError, nearest
from rotatum.models.device import device_names
from rotatum.simulation.scenario.merge import merged

__all__ = ["anchored", "read_tables", "ready_abouts", "scenario_names", "scenario_text"]

READY = "ready:"


def scenario_names() -> tuple[str, ...]:
    """Return the names of the ready scenarios, "group/name", sorted."""
    return tuple(sorted(_ready()))


def ready_abouts() -> dict[str, str]:
    """Return the name of each ready scenario -> what it is about, in a line."""
    return {name: str(read_tables(name)[0].get("about", "")) for name in scenario_names()}


def scenario_text(name_or_path: str | Path) -> tuple[str, str]:
    """Return the text of a scenario, and its source: "ready:NAME" or the path.

    Raises
    ------
    ScenarioError if there is no such name and no such file; it suggests the nearest name.
    """
    shown = str(name_or_path)
    ready = _ready()
    if shown.removeprefix(READY) in ready:
        name = shown.removeprefix(READY)
        return ready[name].read_text("utf-8"), f"{READY}{name}"
    try:
        return Path(name_or_path).read_text("utf-8"), shown
    except FileNotFoundError:
        raise _no_such(shown, tuple(sorted(ready))) from None
    except UnicodeDecodeError as error:
        raise ScenarioError("is not a text file in UTF-8", where=shown) from error
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ScenarioError(f"cannot be read ({reason})", where=shown) from error


def read_tables(
    name_or_path: str | Path, above: tuple[str, ...] = ()
) -> tuple[dict[str, Any], str]:
    """Return the tables of a scenario, with what it extends, and its source.

    Parameters
    ----------
    name_or_path : a name of `scenario_names`, or a path.
    above : sources of the scenarios that extend this one.

    Raises
    ------
    ScenarioError as `scenario_text` does, for a text that is not TOML, and for scenarios that
    extend one another in a circle.
    """
    text, source = scenario_text(name_or_path)
    if source in above:
        what = "scenarios extend one another in a circle"
        raise ScenarioError(what, where=above[0], value=" -> ".join((*above, source)))
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"is not valid TOML: {error}", where=source) from None
    base = tables.pop("extends", None)
    tables.setdefault("name", _name(source))
    if base is None:
        return anchored(tables, source), source
    if not isinstance(base, str):
        raise ScenarioError("extends must be the name or path of one", where=source, value=base)
    if base not in scenario_names():
        base = _beside(base, source)
    below, _ = read_tables(base, (*above, source))
    return merged(below, anchored(tables, source)), source


def anchored(tables: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return tables whose paths no longer depend on where they are read from.

    Parameters
    ----------
    tables : of a scenario; the device's path and those of drives are relative to its file.
    source : its file.
    """
    result = _with_paths(tables, source)
    device = result.get("device")
    if isinstance(device, str) and device not in device_names():
        result["device"] = _beside(device, source)
    return result


def _with_paths(tables: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return tables with the paths of all drives from files resolved."""
    result: dict[str, Any] = {}
    for key, value in tables.items():
        result[key] = _resolved(value, source)
    if result.get("kind") == "file" and isinstance(result.get("path"), str):
        result["path"] = _beside(result["path"], source)
    return result


def _resolved(value: Any, source: str) -> Any:
    if isinstance(value, Mapping):
        return _with_paths(value, source)
    return [_resolved(inner, source) for inner in value] if isinstance(value, list) else value


def _beside(path: str, source: str) -> str:
    """Return a path relative to a scenario's file as it is seen from here."""
    if source.startswith(READY) or Path(path).is_absolute():
        return path
    beside = Path(source).parent / path
    return str(beside.absolute() if beside.exists() else path)


def _name(source: str) -> str:
    if source.startswith(READY):
        return source.removeprefix(READY)
    return Path(source).stem


@cache
def _ready() -> dict[str, Traversable]:
    return dict(_entries(files("rotatum.simulation.scenario") / "ready", ""))


def _entries(folder: Traversable, group: str) -> Iterator[tuple[str, Traversable]]:
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _entries(entry, f"{group}{entry.name}/")
        elif entry.name.endswith(".toml"):
            yield group + entry.name.removesuffix(".toml"), entry


def _no_such(shown: str, names: tuple[str, ...]) -> ScenarioError:
    # Most people remember the second half of a name.
    ends = {name.rpartition("/")[2]: name for name in names}
    close = nearest(shown, names) or ends.get(nearest(shown, ends) or "")
    hint = f'Did you mean "{close}"?' if close else "rotatum simulate lists the ready ones."
    what = "no such scenario file, and no ready scenario of this name"
    return ScenarioError(what, value=shown, hint=hint)
