"""A stage's exported C, compiled and loaded: the same loops as ``runtime.jit.Loops``."""

from __future__ import annotations

import ctypes
import tempfile
from pathlib import Path

from rotatum.export.compiler import CompilerError, compile_shared
from rotatum.export.translate import CSource, translate
from rotatum.record import Layout, Records
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage

_DRIVERS = """\
#include "{name}.h"

#include <stddef.h>

const size_t {name}_sizes[4] = {{
    sizeof({name}_params_t), sizeof({name}_state_t), sizeof({name}_input_t), sizeof({name}_output_t)
}};

void {name}_start(const {name}_params_t *params, {name}_state_t *state, size_t joints);
void {name}_run(const {name}_params_t *params, {name}_state_t *state, const {name}_input_t *u,
                {name}_output_t *out, size_t samples, size_t joints);

void {name}_start(const {name}_params_t *params, {name}_state_t *state, size_t joints)
{{
    for (size_t j = 0; j < joints; ++j) {{
        {name}_init(&params[j], &state[j]);
    }}
}}

void {name}_run(const {name}_params_t *params, {name}_state_t *state, const {name}_input_t *u,
                {name}_output_t *out, size_t samples, size_t joints)
{{
    for (size_t k = 0; k < samples; ++k) {{
        for (size_t j = 0; j < joints; ++j) {{
            {name}_step(&params[j], &state[j], &u[k * joints + j], &out[k * joints + j]);
        }}
    }}
}}
"""


class CompiledC:
    """The loops of ``runtime.jit.Loops`` over numpy records, run by exported C.

    Args:
        stage: what runs.
        source: its C.
        library: the loaded shared library.
    """

    def __init__(self, stage: Stage, source: CSource, library: ctypes.CDLL) -> None:
        self.stage, self.source = stage, source
        self._start = library[f"{stage.name}_start"]
        self._run = library[f"{stage.name}_run"]
        self._start.restype = self._run.restype = None
        layouts = (stage.params, stage.state, stage.input, stage.output)
        sizes = (ctypes.c_size_t * 4).in_dll(library, f"{stage.name}_sizes")
        if list(sizes) != [layout.dtype.itemsize for layout in layouts]:
            raise CompilerError("structs and records differ in size", value=list(sizes))

    def __repr__(self) -> str:
        """Name the stage."""
        return f"CompiledC({self.stage.name})"

    def start(self, params: Records, state: Records) -> None:
        """Initialise the states of ``(n,)`` joints."""
        n = len(params)
        self._start(
            _pointer(params, self.stage.params, (n,)),
            _pointer(state, self.stage.state, (n,)),
            ctypes.c_size_t(n),
        )

    def run(self, params: Records, state: Records, u: Records, out: Records) -> None:
        """Take samples: ``(N n,)`` or ``(N, n)``, the joints of one sample next to each other."""
        n = len(params)
        if u.shape != out.shape or u.size % n != 0:
            raise StageError(f"{u.shape} samples and {out.shape} outputs of {n} joints do not fit")
        self._run(
            _pointer(params, self.stage.params, (n,)),
            _pointer(state, self.stage.state, (n,)),
            _pointer(u, self.stage.input, u.shape),
            _pointer(out, self.stage.output, u.shape),
            ctypes.c_size_t(u.size // n),
            ctypes.c_size_t(n),
        )


def build_shared(stage: Stage) -> CompiledC:
    """Translate a stage to C, compile it with the flags of an exported project, and load it.

    Raises:
        CompilerError: there is no C compiler.
        SubsetError: the stage is outside the exportable subset.
    """
    source = translate(stage)
    with tempfile.TemporaryDirectory(prefix="rotatum-c-") as name:
        directory = Path(name)
        (directory / f"{stage.name}.h").write_text(source.header)
        files = {f"{stage.name}.c": source.source, "drivers.c": _DRIVERS.format(name=stage.name)}
        for file, text in files.items():
            (directory / file).write_text(text)
        library = directory / f"{stage.name}.so"
        compile_shared([directory / file for file in files], library)
        # Once loaded the library no longer needs its file.
        return CompiledC(stage, source, ctypes.CDLL(str(library)))


def _pointer(array: Records, layout: Layout, shape: tuple[int, ...]) -> ctypes.c_void_p:
    fits = array.dtype == layout.dtype and array.shape == shape
    if not fits or not array.flags.c_contiguous:
        raise StageError(f"C needs contiguous {layout.name} records of shape {shape}")
    return ctypes.c_void_p(array.ctypes.data)
