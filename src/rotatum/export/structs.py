"""Layouts as C structs."""

from __future__ import annotations

from collections.abc import Iterator

from rotatum.export.c_text import WIDTH, note, plain
from rotatum.export.names import identifier, snake, unique
from rotatum.export.types import FLOAT, INT, Array, Record, Scalar, Type, of_field, of_layout
from rotatum.record import Field, Layout
from rotatum.runtime.stage import Stage

ROLES = ("params", "state", "input", "output")

_COLUMN = 36  # members longer than this do not push everybody's comment to the right


class Structs:
    """Names and definitions of a stage's structs; one per distinct layout.

    A layout that plays one part only is named by it (``NAME_state_t``); one that is shared has a
    name of its own, and the parts it plays are type definitions.
    """

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.roles = {role: of_layout(getattr(stage, role)) for role in ROLES}
        self.order: list[Record] = []
        for record in self.roles.values():
            self._collect(record)
        self._names = self._name()

    def tag(self, record: Record) -> str:
        """Return a struct's name without the ending ``_t``."""
        return self._names[record]

    def c_type(self, kind: Scalar | Record) -> str:
        """Return the C type of a scalar or a record."""
        return kind.c if isinstance(kind, Scalar) else f"{self.tag(kind)}_t"

    def definitions(self) -> str:
        """Return every definition, sizes first, what is nested before what nests it."""
        parts = [self._definition(record) for record in self.order]
        aliases = [
            f"typedef {self.tag(record)}_t {self.stage.name}_{role}_t;"
            for role, record in self.roles.items()
            if self.tag(record) != f"{self.stage.name}_{role}"
        ]
        return "\n\n".join(parts + (["\n".join(aliases)] if aliases else []))

    def _collect(self, record: Record) -> None:
        for f in record.layout.fields.values():
            if isinstance(f.kind, Layout):
                self._collect(of_layout(f.kind))
        if record not in self.order:
            self.order.append(record)

    def _name(self) -> dict[Record, str]:
        nested = {
            of_layout(f.kind)
            for record in self.order
            for f in record.layout.fields.values()
            if isinstance(f.kind, Layout)
        }
        taken = {f"{self.stage.name}_{role}" for role in ROLES}
        names = {}
        for record in self.order:
            played = [role for role, other in self.roles.items() if other == record]
            if len(played) == 1 and record not in nested:
                names[record] = f"{self.stage.name}_{played[0]}"
            else:
                own = f"{self.stage.name}_{snake(record.layout.name)}"
                names[record] = unique(own, taken)
        return names

    def _definition(self, record: Record) -> str:
        tag, fields = self.tag(record), record.layout.fields
        sizes = [line for name, f in fields.items() for line in self._sizes(tag, name, f)]
        head = [note(record.layout.doc)] if record.layout.doc else []
        body = _aligned([self._member(tag, name, f) for name, f in fields.items()])
        return "\n".join([*sizes, *head, f"typedef struct {tag} {{", *body, f"}} {tag}_t;"])

    def _sizes(self, tag: str, name: str, f: Field) -> Iterator[str]:
        for macro, size in zip(_macros(tag, name, f), f.dims, strict=True):
            yield f"#define {macro} {size}"

    def _member(self, tag: str, name: str, f: Field) -> tuple[str, str]:
        kind = of_field(f)
        item = kind.item if isinstance(kind, Array) else kind
        brackets = "".join(f"[{macro}]" for macro in _macros(tag, name, f))
        symbol = f"; {f.symbol}" if f.symbol else ""
        unit = f" [{f.unit}]" if f.unit else ""
        return f"{self.c_type(item)} {identifier(name)}{brackets};", f"{f.doc}{symbol}{unit}"


def _aligned(members: list[tuple[str, str]]) -> list[str]:
    """Put each comment behind its member if that fits, and above it if not."""
    width = max((len(code) for code, _ in members if len(code) <= _COLUMN), default=0)
    lines = []
    for code, about in members:
        line = f"    {code:{width}} /* {plain(about)} */" if about else f"    {code}"
        lines += [line] if len(line) <= WIDTH else [note(about, "    "), f"    {code}"]
    return lines


def _macros(tag: str, name: str, f: Field) -> list[str]:
    stem = f"{tag.upper()}_{name}"  # fields may differ in case only: F, f
    ends = {0: (), 1: ("_SIZE",), 2: ("_ROWS", "_COLUMNS")}
    fallback = tuple(f"_SIZE{axis}" for axis in range(len(f.dims)))
    return [f"{stem}{end}" for end in ends.get(len(f.dims), fallback)]


def words(kind: Type, name: str = "") -> Iterator[tuple[str, Scalar]]:
    """Yield every 8-byte number of a type in the order of memory: C expression and type."""
    if isinstance(kind, Array):
        size, rest = kind.dims[0], kind.dims[1:]
        for i in range(size):
            yield from words(Array(kind.item, rest) if rest else kind.item, f"{name}[{i}]")
    elif isinstance(kind, Record):
        for field_name, f in kind.layout.fields.items():
            inner = identifier(field_name)
            yield from words(of_field(f), f"{name}.{inner}" if name else inner)
    else:
        assert kind in (FLOAT, INT)  # layouts hold nothing else
        yield name, kind
