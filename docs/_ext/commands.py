"""The command-line reference, generated from the program's own options."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import paragraph, section, table

MARKUP = re.compile(r"\[/?[a-z ]+\]")


class Commands(SphinxDirective):
    """``{rotatum-commands}``: every verb with its arguments and options."""

    def run(self) -> list[nodes.Node]:
        """Make a section per verb."""
        import typer

        from rotatum.cli import app

        top = typer.main.get_command(app)
        return [_verb(path, command) for path, command in _walk("rotatum", top)]


def _walk(path: str, command: Any) -> Iterator[tuple[str, Any]]:
    """Yield the verbs of a command, those of its groups included."""
    children = getattr(command, "commands", None)
    if not children:
        yield path, command
        return
    for name in sorted(children):
        if not children[name].hidden:
            yield from _walk(f"{path} {name}", children[name])


def _verb(path: str, command: Any) -> nodes.section:
    positional = [p for p in command.params if p.param_type_name == "argument"]
    usage = " ".join([path, *(_metavar(p) for p in positional), "[OPTIONS]"])
    words = (command.help or "").split("\n\n")
    content: list[nodes.Node] = [nodes.literal_block(usage, usage, language="text")]
    content += [paragraph(_plain(part)) for part in words if part.strip()]
    rows = [(_names(p), _default(p), _plain(p.help or "")) for p in command.params if not p.hidden]
    return section(path, path, *content, table(("Name", "Default", "Meaning"), rows))


def _names(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return f"`{_metavar(parameter)}`"
    names = [*parameter.opts, *parameter.secondary_opts]
    return ", ".join(f"`{name}`" for name in names)


def _metavar(parameter: Any) -> str:
    return str(parameter.metavar or parameter.name.upper())


def _default(parameter: Any) -> str:
    value = parameter.default
    unset = value is None or callable(value) or "Sentinel" in type(value).__name__
    if parameter.required:
        return "required"
    return "" if unset or value is False else f"`{value}`"


def _plain(words: str) -> str:
    """Drop the markup meant for terminals and the line breaks."""
    return " ".join(MARKUP.sub("", words).split())


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("rotatum-commands", Commands)
    return {"parallel_read_safe": True}
