"""Records as C initialisers, and layouts as tables for people."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from rotatum.export.c_expressions import integer
from rotatum.export.c_text import note
from rotatum.export.names import identifier
from rotatum.record import Layout, Records


def params_header(name: str, layout: Layout, params: Records, joints: Sequence[str]) -> str:
    """Return ``NAME_params.h``: the constants of each joint as a constant array of structs."""
    guard = f"{name}_params_H".upper()
    rows = [
        f"{note(joint, '    ')}\n    {{\n{_fields(layout, row, '        ')}\n    }},"
        for joint, row in zip(joints, params, strict=True)
    ]
    lines = "\n".join(rows)
    return (
        f"/* Constants of stage {name} for {len(joints)} joint(s), written by rotatum. */\n\n"
        f"#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n\n"
        f'#include "{name}.h"\n\n#define {name.upper()}_JOINTS {len(joints)}\n\n'
        f"static const {name}_params_t {name}_params[{name.upper()}_JOINTS] = {{\n{lines}\n}};\n\n"
        f"#endif /* {guard} */\n"
    )


def field_table(layout: Layout) -> str:
    """Return a record's fields as a Markdown table."""
    lines = ["| field | unit | what |", "|---|---|---|"]
    for name, f in layout.fields.items():
        size = "".join(f"[{d}]" for d in f.dims)
        kind = " (int64_t)" if f.kind == "int" else ""
        lines.append(f"| `{identifier(name)}{size}`{kind} | {f.unit} | {f.doc} |")
    return "\n".join(lines)


def _fields(layout: Layout, row: Any, indent: str) -> str:
    lines: list[str] = []
    for name, f in layout.fields.items():
        value = row[name]
        kind = f.kind
        if isinstance(kind, Layout) and not f.dims:
            inner = _fields(kind, value, indent + "    ")
            lines.append(f"{indent}.{identifier(name)} = {{\n{inner}\n{indent}}},")
        elif isinstance(kind, Layout):
            records = [f"{{{_fields(kind, r, '').replace(chr(10), ' ')}}}" for r in value.flat]
            lines.append(f"{indent}.{identifier(name)} = {{{', '.join(records)}}},")
        else:
            lines.append(f"{indent}.{identifier(name)} = {_numbers(value.tolist())},")
    return "\n".join(lines)


def _numbers(value: Any) -> str:
    if isinstance(value, list):
        return "{" + ", ".join(_each(value)) + "}"
    if isinstance(value, int):
        return integer(value)
    if math.isfinite(value):
        return repr(value)
    return "NAN" if math.isnan(value) else ("INFINITY" if value > 0 else "-INFINITY")


def _each(values: list[Any]) -> Iterator[str]:
    for value in values:
        yield _numbers(value)
