"""A stage as C99: a header with its structs and two prototypes, and a source file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from rotatum.export import c_functions
from rotatum.export.c_text import note, wrapped
from rotatum.export.checker import require_subset
from rotatum.export.header import header
from rotatum.export.infer import Inference, infer_stage
from rotatum.export.instance import Instance
from rotatum.export.names import RESERVED, identifier, unique
from rotatum.export.sources import FlatModule, flat_module
from rotatum.export.structs import ROLES, Structs
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage


class CSource(NamedTuple):
    """C99 of a stage.

    Args:
        name: the stage's; the files are ``name.h`` and ``name.c``.
        header: structs, sizes, status bits, prototypes.
        source: the functions.
        structs: names of the structs.
    """

    name: str
    header: str
    source: str
    structs: Structs


def translate(stage: Stage) -> CSource:
    """Translate a stage to C99.

    ``NAME_init(params, state)`` and ``NAME_step(params, state, u, out)`` compute what the kernels
    compute, bit for bit on one machine's libm, given a compiler that neither contracts nor
    reorders floating-point operations: see ``compiler.FLAGS``.

    Raises:
        SubsetError: a kernel leaves the exportable subset.
        StageError: the stage's name or layouts cannot be C, or its kernels cannot be read.
    """
    for role in ROLES:
        if not getattr(stage, role).fields:
            raise StageError(f"{role} of {stage.name} has no fields: C has no such struct")
    if not (stage.name.isidentifier() and stage.name.isascii()) or stage.name in RESERVED:
        raise StageError("a stage's name must be a C identifier", value=stage.name)
    require_subset(stage)
    flat = flat_module(stage)
    inference = infer_stage(stage, flat)
    structs = Structs(stage)
    names = _names(stage, inference)
    functions = [_function(i, names, structs, flat) for i in inference.instances]
    functions.append(_initialiser(stage, inference))
    source = "\n\n".join([_preamble(stage), *functions]) + "\n"
    return CSource(stage.name, wrapped(header(stage, inference, structs)), wrapped(source), structs)


def _names(stage: Stage, inference: Inference) -> dict[Instance, str]:
    step = inference.entries["step"]
    taken = {f"{stage.name}_init", f"{stage.name}_step", *RESERVED}
    return {
        i: f"{stage.name}_step" if i is step else unique(i.kernel, taken)
        for i in inference.instances
    }


def _function(
    instance: Instance, names: Mapping[Instance, str], structs: Structs, flat: FlatModule
) -> str:
    name, stage = names[instance], structs.stage.name
    if name == f"{stage}_step":
        head = c_functions.entry_prototype(instance, stage)
    else:
        head = f"static inline {c_functions.prototype(instance, name, structs)}"
    return f"{_note(instance, flat)}{head}\n{c_functions.body(instance, structs, names)}"


def _initialiser(stage: Stage, inference: Inference) -> str:
    entry = inference.entries["init"]
    params, state = map(identifier, entry.arguments)
    head = c_functions.entry_prototype(entry, stage.name)
    return f"{head}\n{{\n    memset({state}, 0, sizeof *{state});\n    init({params}, {state});\n}}"


def _note(instance: Instance, flat: FlatModule) -> str:
    """Return a comment: where the kernel comes from, and what its docstring says first."""
    source = flat.sources.get(instance.kernel)
    if source is None:
        return ""
    value = getattr(getattr(source.node.body[0], "value", None), "value", None)
    said = value.strip().partition("\n\n")[0] if isinstance(value, str) else ""
    return note(f"{source.origin}: {said}" if said else source.origin) + "\n"


def _preamble(stage: Stage) -> str:
    return (
        f"/* Written by rotatum from the kernels of stage {stage.name}; see {stage.name}.h. */\n\n"
        f'#include "{stage.name}.h"\n\n'
        "#include <math.h>\n#include <stdbool.h>\n#include <string.h>"
    )
