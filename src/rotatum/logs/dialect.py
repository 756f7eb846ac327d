"""How a text table is written: delimiter, decimal sign, header; found by looking at its start."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["MISSING", "Dialect", "find_dialect", "split"]

# Cells that mean "no value here".
MISSING = frozenset(("", "na", "n/a", "nan", "null", "none"))


@dataclass(frozen=True)
class Dialect:
    """The layout of a text table.

    Parameters
    ----------
    delimiter : between cells; None: any run of blanks.
    decimal : "." or ",".
    names : of the columns; their numbers "0", "1", ... where the table has no header.
    skip : lines before the first row of numbers.
    """

    delimiter: str | None
    decimal: str
    names: tuple[str, ...]
    skip: int


def find_dialect(lines: Sequence[str]) -> Dialect | None:
    """Work out the layout from the first lines of a table; None if there is no line to go by.

    Lines that start with # are comments; the last of them is the header if nothing else is.

    Parameters
    ----------
    lines : the first lines of the file.
    """
    skip = 0
    comment = ""
    while skip < len(lines) and (not lines[skip].strip() or lines[skip].lstrip().startswith("#")):
        comment = lines[skip].strip().lstrip("#").strip() or comment
        skip += 1
    if skip == len(lines):
        return None
    delimiter = _delimiter(lines[skip])
    cells = split(lines[skip], delimiter)
    if not _is_row(cells, delimiter):
        names = tuple(cells)
        skip += 1
    else:
        header = split(comment, delimiter)
        numbered = tuple(str(number) for number in range(len(cells)))
        names = tuple(header) if len(header) == len(cells) else numbered
    decimal = _decimal(lines[skip:], delimiter)
    return Dialect(delimiter=delimiter, decimal=decimal, names=names, skip=skip)


def split(line: str, delimiter: str | None) -> list[str]:
    """Split a line into stripped cells, minding quotes."""
    if delimiter is None:
        return line.split()
    cells = next(csv.reader([line.rstrip("\r\n")], delimiter=delimiter), [])
    return [cell.strip() for cell in cells]


def _delimiter(line: str) -> str | None:
    """Return the delimiter of a line: of `;`, tab and `|` any that occurs, else a comma."""
    for delimiter in (";", "\t", "|", ","):
        if delimiter in line:
            return delimiter
    return None if len(line.split()) > 1 else ","


def _is_row(cells: Sequence[str], delimiter: str | None) -> bool:
    """Say whether cells are numbers rather than names."""
    return all(_is_number(cell, delimiter) or cell.lower() in MISSING for cell in cells)


def _is_number(cell: str, delimiter: str | None) -> bool:
    """Say whether a cell is a number with either decimal sign."""
    try:
        float(cell if delimiter == "," else cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _decimal(rows: Sequence[str], delimiter: str | None) -> str:
    """Return the decimal sign: a comma if no cell has a point and one has a comma."""
    if delimiter == ",":
        return "."
    comma = any("," in row for row in rows)
    point = any("." in row for row in rows)
    return "," if comma and not point else "."
