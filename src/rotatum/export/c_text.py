"""C text that people can read: comments, and lines of at most 100 characters."""

from __future__ import annotations

import re
import textwrap

WIDTH = 100

_BREAKS = re.compile(r"(?<=,) |(?<= &&) |(?<= \|\|) |(?<= [-+*/=?:]) ")
_CONTINUED = " " * 8


def plain(text: str) -> str:
    """Return a text that is safe inside a C comment, on one line.

    >>> plain("see */ there")
    'see * / there'
    """
    return " ".join(text.split()).replace("*/", "* /").replace("/*", "/ *")


def note(text: str, indent: str = "") -> str:
    """Return a comment, over as many lines as it needs."""
    lines = textwrap.wrap(plain(text), WIDTH - len(indent) - 6)
    return f"{indent}/* " + f"\n{indent} * ".join(lines) + " */"


def wrapped(code: str) -> str:
    """Break long lines of code behind commas and operators."""
    return "\n".join(_break(line) for line in code.split("\n"))


def _break(line: str) -> str:
    if len(line) <= WIDTH or line.lstrip().startswith(("/*", "*", "#")):
        return line
    indent = line[: len(line) - len(line.lstrip())]
    done: list[str] = []
    while len(line) > WIDTH:
        places = [m.start() for m in _BREAKS.finditer(line) if len(indent) < m.start() < WIDTH]
        fitting = [p for p in places if line[:p].strip()]
        if not fitting:
            break
        done.append(line[: fitting[-1]])
        line = f"{indent}{_CONTINUED}{line[fitting[-1] :].lstrip()}"
    return "\n".join([*done, line])
