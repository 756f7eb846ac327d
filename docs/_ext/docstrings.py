"""The house style of docstrings, brought to what napoleon expects.

Types are in the signature, so ``name : text`` below *Parameters* is a description, where napoleon
would take the text for a type; and ``|x|`` is a magnitude, where docutils sees a substitution.
"""

from __future__ import annotations

import re

from pydantic import BaseModel
from sphinx.application import Sphinx

UNDERLINE = re.compile(r"^-{3,}\s*$")
ENTRY = re.compile(r"^(\*{0,2}\w[\w, ]*?) : (.+)$")
RAISED = re.compile(r"^(\w+)(?:,| (?=if|as|where|when|from))(.+)$")
SECTIONS = {"Parameters": ENTRY, "Attributes": ENTRY, "Returns": ENTRY, "Raises": RAISED}


def adapt(
    app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]
) -> None:
    """Rewrite one docstring in place, before napoleon reads it."""
    lines[:] = [_literal_bars(line) for line in _entries(lines)]


def shorten(
    app: Sphinx, what: str, name: str, thing: object, options: object, *signature: str | None
) -> tuple[str, None] | None:
    """Leave out the signatures of tables: validators fill a screen, the docstring says it all."""
    table = isinstance(thing, type) and issubclass(thing, BaseModel)
    return ("", None) if table else None


def _entries(lines: list[str]) -> list[str]:
    made: list[str] = []
    pattern: re.Pattern[str] | None = None
    for number, line in enumerate(lines):
        following = lines[number + 1] if number + 1 < len(lines) else ""
        if UNDERLINE.match(following):
            pattern = SECTIONS.get(line.strip())
        found = pattern.match(line) if pattern else None
        if found:
            made += [found[1], "    " + found[2].strip()]
        elif pattern and line.startswith(" "):
            made.append("    " + line.strip())
        else:
            made.append(line)
    return made


def _literal_bars(line: str) -> str:
    """Escape bars outside code."""
    if line.lstrip().startswith((">>>", "...", "|", "+")):
        return line
    parts = line.split("`")
    parts[::2] = [part.replace("|", "\\|") for part in parts[::2]]
    return "`".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Run before napoleon, whose priority is the default of 500."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", adapt, priority=400)
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True}
