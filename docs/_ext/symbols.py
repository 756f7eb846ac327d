"""Pages generated from the package's own tables: symbols, status bits, units."""

from __future__ import annotations

import inspect
from collections import defaultdict

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import paragraph, section, table

from checks import surface
from rotatum.kernels import status
from rotatum.models.units import find_unit, unit_names
from rotatum.record import Field, Record


class Letters(SphinxDirective):
    """``{rotatum-letters}``: which field is which letter of the papers."""

    def run(self) -> list[nodes.Node]:
        """Make one row per letter and meaning."""
        uses: dict[tuple[str, str, str], list[str]] = defaultdict(list)
        for record in surface.records():
            for name, field in record.fields().items():
                if field.symbol:
                    place = uses[field.symbol, _unit(field), field.doc]
                    place.append(f"`{record.__name__}.{name}`")
        rows = [
            (f"`{symbol}`", doc, unit, ", ".join(places))
            for (symbol, unit, doc), places in sorted(uses.items(), key=_by_letter)
        ]
        return [table(("Letter", "Meaning", "Unit", "Fields"), rows)]


class Records(SphinxDirective):
    """``{rotatum-records}``: every record with its fields."""

    def run(self) -> list[nodes.Node]:
        """Make a section with a table per record."""
        return [self._record(record) for record in surface.records()]

    def _record(self, record: type[Record]) -> nodes.section:
        head = ("Field", "Letter", "Unit", "Size", "Meaning")
        rows = [
            (f"`{name}`", f"`{f.symbol}`" if f.symbol else "", _unit(f), _size(f), f.doc)
            for name, f in record.fields().items()
        ]
        module = surface.home(record)
        intro = paragraph(f"{inspect.getdoc(record)} Defined in `{module}`.")
        place = f"{module}.{record.__name__}"
        return section(record.__name__, place, intro, table(head, rows))


class StatusBits(SphinxDirective):
    """``{rotatum-status}``: the bits of ``status``."""

    def run(self) -> list[nodes.Node]:
        """Make one row per bit."""
        rows = [(f"`{s.name}`", f"{s.bit}", _kind(s.bit), s.sentence) for s in status.TABLE]
        return [table(("Name", "Bit", "Kind", "Meaning"), rows)]


class Units(SphinxDirective):
    """``{rotatum-units}``: what logs and device files may declare."""

    def run(self) -> list[nodes.Node]:
        """Make one row per unit."""
        units = [find_unit(name) for name in unit_names()]
        rows = [(u.kind, f"`{u.name}`", f"{u.factor:.10g}") for u in units]
        return [table(("Quantity", "Unit", "In SI"), rows)]


def _by_letter(entry: tuple[tuple[str, str, str], list[str]]) -> tuple[str, str, str]:
    symbol, unit, doc = entry[0]
    return symbol.lower(), symbol, unit + doc


def _unit(field: Field) -> str:
    return field.unit or "1"


def _size(field: Field) -> str:
    kind = field.kind if isinstance(field.kind, str) else field.kind.name
    return f"{kind} [{', '.join(map(str, field.dims))}]" if field.dims else kind


def _kind(bit: int) -> str:
    if bit & status.REJECTED:
        return "sample refused"
    return "model or data wrong" if bit & status.WRONG else "notice"


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("rotatum-letters", Letters)
    app.add_directive("rotatum-records", Records)
    app.add_directive("rotatum-status", StatusBits)
    app.add_directive("rotatum-units", Units)
    return {"parallel_read_safe": True}
