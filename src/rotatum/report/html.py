"""The little HTML there is to write."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

__all__ = ["escape", "table", "tag", "typeset"]


def escape(text: object) -> str:
    """Return a text as HTML shows it literally.

    Parameters
    ----------
    text : anything with a text.
    """
    return html.escape(str(text), quote=True)


def tag(name: str, content: str, attributes: Mapping[str, str] | None = None) -> str:
    """Return an element.

    Parameters
    ----------
    name : of the element.
    content : its HTML, escaped already.
    attributes : values are escaped here.
    """
    told = "".join(f' {key}="{escape(value)}"' for key, value in (attributes or {}).items())
    return f"<{name}{told}>{content}</{name}>"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], kind: str = "") -> str:
    """Return a table of texts that scrolls sideways where it is too wide.

    Parameters
    ----------
    head : titles of the columns.
    rows : cells, escaped here.
    kind : class of the table.
    """
    top = "".join(tag("th", escape(title), {"scope": "col"}) for title in head)
    lines = "".join(tag("tr", "".join(tag("td", escape(cell)) for cell in row)) for row in rows)
    inner = f"<thead><tr>{top}</tr></thead><tbody>{lines}</tbody>"
    return tag("div", tag("table", inner, {"class": kind}), {"class": "wide"})


def typeset(text: str) -> str:
    """Write +- as one sign, which not every terminal has.

    Parameters
    ----------
    text : with +- between a value and its interval.
    """
    return text.replace("+-", "±")
