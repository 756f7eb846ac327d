"""The C header of a stage."""

from __future__ import annotations

from collections.abc import Iterator

from rotatum.export.c_functions import entry_prototype
from rotatum.export.c_text import note, plain
from rotatum.export.infer import Inference
from rotatum.export.structs import Structs
from rotatum.kernels import status
from rotatum.runtime.stage import Stage

_ABOUT = {
    "init": "Put a state, whatever it holds, into its initial values.",
    "step": "Take one sample of one joint. Allocates nothing and always returns.",
}


def header(stage: Stage, inference: Inference, structs: Structs) -> str:
    """Return the text of ``NAME.h``."""
    guard = f"{stage.name}_H".upper()
    cites = f"\n * After: {plain(', '.join(stage.cites))}." if stage.cites else ""
    parts = [
        f"/* Stage {stage.name}, written by rotatum.{cites}\n"
        " * SI units; fields name theirs. Compile with -ffp-contract=off -frounding-math. */",
        f"#ifndef {guard}\n#define {guard}",
        "#include <stdint.h>",
        '#ifdef __cplusplus\nextern "C" {\n#endif',
        *_status_bits(stage),
        structs.definitions(),
        *_prototypes(stage, inference),
        "#ifdef __cplusplus\n}\n#endif",
        f"#endif /* {guard} */",
    ]
    return "\n\n".join(parts) + "\n"


def _prototypes(stage: Stage, inference: Inference) -> Iterator[str]:
    for kernel, about in _ABOUT.items():
        yield f"/* {about} */\n{entry_prototype(inference.entries[kernel], stage.name)};"


def _status_bits(stage: Stage) -> list[str]:
    """Return the bits of ``status`` with their sentences, where the output has such a field."""
    if "status" not in stage.output.fields:
        return []
    stem = f"{stage.name}_status".upper()
    lines = [
        f"{note(row.sentence)}\n#define {stem}_{row.name.upper()} {row.bit}" for row in status.TABLE
    ]
    return ["\n".join(["/* Bits of `status` in the output. */", *lines])]
