"""C compiled with given flags and run over the arrays a bank runs over."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.export import translate
from rotatum.record import Records
from rotatum.runtime import Stage

HAND = Path(__file__).parent / "hand"
SAME_FLAGS = ("-O3", "-std=c99", "-ffp-contract=off")
NATIVE_FLAGS = ("-O3", "-march=native")


class Code(NamedTuple):
    """C to compile between the loops of ``hand/drivers.c``.

    Args:
        source: the file.
        names: what PARAMS, STATE, INPUT, OUTPUT, INIT and STEP are called in it.
    """

    source: Path
    names: dict[str, str]


def hand_code(name: str) -> Code:
    """Return a version written by hand: ``weak_series`` or ``weak_pair``."""
    types = {"PARAMS": "params", "STATE": "state", "INPUT": "input", "OUTPUT": "reading"}
    names = {key: f"joint_{word}" for key, word in types.items()}
    return Code(HAND / f"{name}.c", names | {"INIT": "joint_init", "STEP": "joint_step"})


def exported_code(stage: Stage, directory: Path) -> Code:
    """Translate a stage into a folder and return its code."""
    source = translate(stage)
    (directory / f"{stage.name}.h").write_text(source.header)
    path = directory / f"{stage.name}.c"
    path.write_text(source.source)
    words = ("params", "state", "input", "output")
    names = {word.upper(): f"{stage.name}_{word}_t" for word in words}
    return Code(path, names | {"INIT": f"{stage.name}_init", "STEP": f"{stage.name}_step"})


def compiler() -> str | None:
    """Return the path of ``CC``, or of cc, gcc or clang; None: there is no C compiler."""
    wanted = os.environ.get("CC")
    found = (shutil.which(name) for name in ([wanted] if wanted else ["cc", "gcc", "clang"]))
    return next((path for path in found if path), None)


class Native:
    """A compiled step, its constants and its state.

    Args:
        code: what to compile.
        flags: for the compiler.
        directory: for the library.
        params: one record of the constants; its bytes are the C struct.
    """

    def __init__(
        self, code: Code, flags: tuple[str, ...], directory: Path, params: NDArray[Any]
    ) -> None:
        library = directory / f"{code.source.stem}{'_'.join(flags)}.so".replace("=", "_")
        defined = [f"-D{key}={name}" for key, name in code.names.items()]
        command = [str(compiler()), *flags, "-fPIC", "-shared", "-o", str(library)]
        command += [f'-DSOURCE="{code.source.name}"', f"-I{code.source.parent}", *defined]
        subprocess.run([*command, str(HAND / "drivers.c"), "-lm"], check=True)
        self.shared = ctypes.CDLL(str(library))
        sizes = list((ctypes.c_size_t * 4).in_dll(self.shared, "sizes"))
        if params.nbytes != sizes[0]:
            raise AssertionError(f"params of {sizes[0]} B in C, of {params.nbytes} B here")
        self.sizes = sizes
        self.params = params
        self.state = np.zeros(sizes[1], np.uint8)

    def start(self) -> None:
        """Put the state in its initial condition."""
        self.shared.start(_pointer(self.params), _pointer(self.state))

    def run(self, u: Records, out: Records) -> None:
        """Take ``(N,)`` samples."""
        self._check(u, out)
        count = ctypes.c_int64(len(u))
        arrays = (self.params, self.state, u, out)
        self.shared.run(*map(_pointer, arrays), count)

    def run_timed(self, u: Records, out: Records, nanoseconds: NDArray[np.int64]) -> None:
        """Take ``(N,)`` samples; write how long each step took."""
        self._check(u, out)
        count = ctypes.c_int64(len(u))
        arrays = (self.params, self.state, u, out)
        self.shared.run_timed(*map(_pointer, arrays), count, _pointer(nanoseconds))

    def _check(self, u: Records, out: Records) -> None:
        if [u.itemsize, out.itemsize] != self.sizes[2:] or len(u) != len(out):
            raise AssertionError(f"{u.itemsize}, {out.itemsize} B here, {self.sizes[2:]} B in C")


def _pointer(array: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
