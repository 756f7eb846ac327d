"""Tables generated from the package's elastic laws and its catalogue of devices."""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import section, table, text

from rotatum.models import LAWS, Law, device_names, load_device

_HEAD = ("Key", "Unit", "Meaning")


class Laws(SphinxDirective):
    """``{rotatum-laws}``: every law with its formula, constants, range and source."""

    def run(self) -> list[nodes.Node]:
        """Make a section per law."""
        return [self._law(law) for law in LAWS.values()]

    def _law(self, law: Law) -> nodes.section:
        formula = rf"\tau_e = {law.formula}"
        shown = nodes.math_block(formula, formula, nowrap=False, number=None, label=None)
        rows = [
            (f"`{c.name}`", c.unit or "1", c.doc + ("" if c.positive or c.many else ", any sign"))
            for c in law.constants
        ]
        return section(law.name, f"law-{law.name}", shown, _with_formulas(rows), _about(law))


class Catalogue(SphinxDirective):
    """``{rotatum-catalogue}``: the devices that come with the package."""

    def run(self) -> list[nodes.Node]:
        """Make one row per device."""
        rows = []
        for name in device_names():
            joints = load_device(name).joints
            springs = [spring for joint in joints for spring in joint.transmissions]
            laws = dict.fromkeys(f"`{s.law}`" if s.law else "not known" for s in springs)
            kinds = dict.fromkeys(joint.actuation for joint in joints)
            row = (f"`{name}`", ", ".join(kinds), ", ".join(laws), str(len(joints)))
            rows.append(row)
        return [table(("Name", "Actuation", "Law", "Joints"), rows)]


def _about(law: Law) -> nodes.paragraph:
    """Say where a law is from and what else is to know of it."""
    words = [f"From: {law.source}."]
    words.append("Alike in both directions." if law.odd else "Not alike in both directions.")
    if law.uses_setpoint:
        words.append(f"Set-point in {law.setpoint_unit}; serial joints only.")
    made = nodes.paragraph()
    made += text(" ".join(words))
    return made


def _with_formulas(rows: list[tuple[str, str, str]]) -> nodes.table:
    """Build a table whose cells may hold formulas between dollars."""
    made = table(_HEAD, rows)
    for node in list(made.findall(nodes.Text)):
        parts = node.astext().split("$")
        if len(parts) > 1:
            pieces = [
                nodes.math(part, part) if odd % 2 else nodes.Text(part)
                for odd, part in enumerate(parts)
                if part
            ]
            node.parent.replace(node, pieces)
    return made


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("rotatum-laws", Laws)
    app.add_directive("rotatum-catalogue", Catalogue)
    return {"parallel_read_safe": True}
