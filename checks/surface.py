"""The public surface of the package, found by looking: modules, what they define, records.

Shared by the generated API reference, the symbols page and the check that both are complete.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from types import ModuleType

import rotatum
from rotatum.record import Record

# The command line has a reference of its own, generated from its options.
NOT_API = "rotatum.cli"


def module_names() -> list[str]:
    """Return the dotted names of all public modules below the package, sorted."""
    found = pkgutil.walk_packages(rotatum.__path__, "rotatum.")
    return sorted(
        m.name for m in found if not any(part.startswith("_") for part in m.name.split("."))
    )


def modules() -> Iterator[ModuleType]:
    """Import and yield every public module but those of the command line."""
    for name in module_names():
        if name != NOT_API and not name.startswith(NOT_API + "."):
            yield importlib.import_module(name)


def defined(module: ModuleType) -> dict[str, object]:
    """Return the public functions and classes a module defines itself."""
    return {
        name: value
        for name, value in vars(module).items()
        if not name.startswith("_") and _is_code(value) and home(value) == module.__name__
    }


def home(value: object) -> str:
    """Return the name of the module that defines a function or class."""
    return str(getattr(_unwrapped(value), "__module__", ""))


def canonical(name: str) -> str:
    """Return where a name of ``rotatum.__all__`` is documented: at the module that defines it."""
    value = getattr(rotatum, name)
    if inspect.ismodule(value):
        return value.__name__
    if _is_code(value):
        return f"{home(value)}.{getattr(_unwrapped(value), '__qualname__', name)}"
    return f"rotatum.{name}"


def records() -> Iterator[type[Record]]:
    """Yield every record, in the order of modules and of definition."""
    for module in modules():
        for value in defined(module).values():
            if isinstance(value, type) and issubclass(value, Record) and value is not Record:
                yield value


def _is_code(value: object) -> bool:
    plain = _unwrapped(value)
    return inspect.isfunction(plain) or inspect.isclass(plain)


def _unwrapped(value: object) -> object:
    return inspect.unwrap(value) if callable(value) else value
