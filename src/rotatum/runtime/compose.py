"""Composition writes code: a chain of stages becomes a straight-line module calling their kernels.

Closures would never hit numba's disk cache in a new process; a text named by what it says does.
"""

from __future__ import annotations

import hashlib
import linecache
from collections.abc import Mapping, Sequence
from types import FunctionType
from typing import Any, NamedTuple

from rotatum.record import Field, Init, Layout, Step
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage


class Part(NamedTuple):
    """One stage of a chain.

    Args:
        label: what the part is called in the chain's params and state.
        stage: the stage.
        wires: where its input comes from. A string names a whole record (``"u"`` or an earlier
            part); a mapping gives a source per field, as ``"u.q"`` or ``"label.field"``.
    """

    label: str
    stage: Stage
    wires: str | Mapping[str, str] = "u"


def chain(name: str, doc: str, parts: Sequence[Part], *, input: Layout) -> Stage:
    """Compose stages in order; the last part's output is the chain's.

    State holds, per part, its own state, the record it reads where fields are wired one by one,
    and (but for the last) the record it writes. Raises ``StageError`` for a wire that names no
    field, a field left unwired, or records that do not fit.
    """
    labels = [part.label for part in parts]
    if not parts:
        raise StageError(f"chain {name} needs at least one part with a label")
    if len(set(labels)) < len(labels) or not all(n.isidentifier() and n != "u" for n in labels):
        raise StageError(f"labels of chain {name} must be identifiers, each once", value=labels)
    last = parts[-1]
    params = Layout(f"{name}_params", doc, {p.label: Field(p.stage.params) for p in parts})
    fields: dict[str, Field] = {}
    for part in parts:
        fields[part.label] = Field(part.stage.state)
        if not isinstance(part.wires, str):
            fields[f"{part.label}_in"] = Field(part.stage.input)
        if part is not last:
            fields[f"{part.label}_out"] = Field(part.stage.output)
    state = Layout(f"{name}_state", doc, fields)
    lines = [line for part in parts for line in _part_lines(part, parts, input, part is last)]
    init_lines = [f"{p.label}_init(params.{p.label}, state.{p.label})" for p in parts]
    kernels: dict[str, Any] = {f"{p.label}_init": p.stage.init for p in parts}
    kernels |= {f"{p.label}_step": p.stage.step for p in parts}
    init, step = write_kernels(name, doc, init_lines, lines, kernels)
    cites = tuple(dict.fromkeys(c for p in parts for c in p.stage.cites))
    return Stage(name, params, state, input, last.stage.output, init, step, cites)


def write_kernels(
    name: str,
    doc: str,
    init_lines: Sequence[str],
    step_lines: Sequence[str],
    kernels: Mapping[str, Any],
) -> tuple[Init, Step]:
    """Make ``init`` and ``step`` from lines of the exportable subset that call ``kernels``."""
    init = write_function("init(params, state)", name, doc, init_lines, kernels)
    step = write_function("step(params, state, u, out)", name, doc, step_lines, kernels)
    return init, step


def write_function(
    signature: str, module: str, doc: str, lines: Sequence[str], kernels: Mapping[str, Any]
) -> Any:
    """Make one kernel.

    Args:
        signature: as ``step(params, state, u, out)``.
        module: the composition it belongs to; part of its name in the flat text.
        doc: what the composition is, in a line.
        lines: its body.
        kernels: what the names in the body mean.
    """
    name = signature.partition("(")[0]
    body = "\n    ".join(lines)
    text = f'"""{doc}"""\n\n\ndef {signature}:\n    {body}\n'
    digest = hashlib.sha256(text.encode()).hexdigest()[:12]
    filename = f"<rotatum {module}.{name} {digest}>"
    namespace: dict[str, Any] = {"__name__": f"rotatum.composed.{module}", **kernels}
    exec(compile(text, filename, "exec"), namespace)  # the text was written three lines above
    # inspect.getsource finds the text of a function that is in no file through linecache.
    linecache.cache[filename] = (len(text), None, text.splitlines(keepends=True), filename)
    function = namespace[name]
    if not isinstance(function, FunctionType):
        raise StageError(f"kernel {module}.{name} could not be written")
    return function


def _part_lines(part: Part, parts: Sequence[Part], input: Layout, last: bool) -> list[str]:
    stage, label = part.stage, part.label
    lines = []
    if isinstance(part.wires, str):
        source, layout = _record(part.wires, part, parts, input)
        if layout != stage.input:
            raise StageError(
                f"{label} reads {stage.input.name}; {part.wires!r} is a {layout.name}",
            )
    else:
        source = f"state.{label}_in"
        missing = sorted(set(stage.input.fields) ^ set(part.wires))
        if missing:
            raise StageError(f"wires of {label} do not match its input record", value=missing)
        for field, origin in part.wires.items():
            lines += _copy(
                stage.input.fields[field], f"{source}.{field}", origin, part, parts, input
            )
    target = "out" if last else f"state.{label}_out"
    lines.append(f"{label}_step(params.{label}, state.{label}, {source}, {target})")
    return lines


def _record(wire: str, part: Part, parts: Sequence[Part], input: Layout) -> tuple[str, Layout]:
    if wire == "u":
        return "u", input
    for other in parts:
        if other is part:
            break
        if other.label == wire:
            return f"state.{wire}_out", other.stage.output
    raise StageError(f"{part.label} reads {wire!r}, which is neither u nor an earlier part")


def _copy(
    field: Field, target: str, origin: str, part: Part, parts: Sequence[Part], input: Layout
) -> list[str]:
    head, _, tail = origin.partition(".")
    source, layout = _record(head, part, parts, input)
    found = layout.fields.get(tail)
    if found is None or (found.kind, found.dims) != (field.kind, field.dims):
        raise StageError(
            f"{target} cannot be wired from {origin!r}", value=found, allowed=list(layout.fields)
        )
    return copy_lines(field, target, f"{source}.{tail}")


def copy_lines(field: Field, target: str, source: str) -> list[str]:
    """Lines that copy one field, element by element where it has axes."""
    if not field.dims:
        return [f"{target} = {source}"]
    if len(field.dims) == 1:
        return [f"for i in range({field.dims[0]}):", f"    {target}[i] = {source}[i]"]
    raise StageError(f"{target}: matrices are not copied between stages")
