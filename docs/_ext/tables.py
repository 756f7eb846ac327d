"""Tables as docutils nodes, so that no text of the package has to be escaped for a parser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from docutils import nodes


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> nodes.table:
    """Build a table; text between backticks in a cell becomes code."""
    group = nodes.tgroup(cols=len(head))
    group += [nodes.colspec(colwidth=1) for _ in head]
    top, body = nodes.thead(), nodes.tbody()
    top += _row(head)
    body += [_row(row) for row in rows]
    group += [top, body]
    whole = nodes.table(classes=["colwidths-auto"])
    whole += group
    return whole


def section(title: str, name: str, *content: nodes.Node) -> nodes.section:
    """Build a section whose title is code."""
    made = nodes.section(ids=[nodes.make_id(name)], names=[name.lower()])
    head = nodes.title()
    head += text(f"`{title}`")
    made += head
    made += list(content)
    return made


def paragraph(words: str) -> nodes.paragraph:
    """Build a paragraph; text between backticks becomes code."""
    made = nodes.paragraph()
    made += text(words)
    return made


def text(words: str) -> list[nodes.Node]:
    """Split text into plain and, between backticks (one or two), code."""
    parts = words.replace("``", "`").split("`")
    return [
        nodes.literal(part, part) if odd % 2 else nodes.Text(part)
        for odd, part in enumerate(parts)
        if part
    ]


def _row(cells: Sequence[str]) -> nodes.row:
    made = nodes.row()
    for cell in cells:
        entry = nodes.entry()
        entry += paragraph(cell)
        made += entry
    return made
