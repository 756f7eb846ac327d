"""Compile a stage's flat text with numba, or run it interpreted. The only place numba is imported.

The cache directory is keyed by a digest of the text and the versions of numba, numpy and this
package, because numba's own check looks at one file's time stamp only.
Environment: ``ROTATUM_CACHE_DIR`` moves the cache, ``ROTATUM_JIT=0`` switches compilation off.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from rotatum.record import Init, Step
from rotatum.runtime.flatten import DRIVERS, flatten
from rotatum.runtime.stage import Stage

# SVML's exp and sin differ from the C library's in the last bit; exported C uses the latter.
os.environ.setdefault("NUMBA_DISABLE_INTEL_SVML", "1")


class Loops(NamedTuple):
    """The drivers of a stage over arrays of records.

    ``start(params, state)``; ``run(params, state, u, out)`` with ``u`` and ``out`` flat, the
    joints of one sample next to each other: one sample is a batch of length n.
    """

    start: Callable[..., None]
    run: Callable[..., None]


def enabled() -> bool:
    """Whether stages are compiled unless asked otherwise (``ROTATUM_JIT`` is not ``0``)."""
    return os.environ.get("ROTATUM_JIT", "1") != "0"


def text_of(stage: Stage) -> str:
    """The stage's whole text: its kernels, flat, and the drivers around ``step``."""
    return _text(stage.init, stage.step)


@lru_cache(maxsize=256)
def _text(init: Init, step: Step) -> str:
    # Reading and writing sources takes longer than a short run; a stage's functions do not change.
    return flatten(init, step) + DRIVERS


def interpreted(stage: Stage) -> Loops:
    """The drivers as plain Python. Slow (about a millisecond a sample); for checking."""
    import numpy as np

    namespace: dict[str, Any] = {"__name__": f"rotatum.flat.{stage.name}"}
    exec(compile(text_of(stage), f"<flat {stage.name}>", "exec"), namespace)

    def quiet(loop: Callable[..., None]) -> Callable[..., None]:
        def call(*args: Any) -> None:
            # Python scalars of numpy warn where compiled code returns inf or nan.
            with np.errstate(all="ignore"):
                loop(*args)

        return call

    return Loops(*(quiet(namespace[name]) for name in Loops._fields))


def compiled(stage: Stage) -> Loops:
    """The drivers compiled for exactly this stage's layouts; other records are refused."""
    key = (stage.params.dtype, stage.state.dtype, stage.input.dtype, stage.output.dtype)
    return _compiled(stage.name, text_of(stage), key)


@lru_cache(maxsize=256)
def _compiled(name: str, text: str, key: tuple[Any, ...]) -> Loops:
    import numba
    import numpy as np
    from filelock import FileLock

    versions = f"{numba.__version__} {np.__version__} {sys.version}"
    digest = hashlib.sha256(f"{versions}\n{key!r}\n{text}".encode()).hexdigest()[:20]
    directory = _cache_root() / digest
    # Processes that start together would each compile the same text: one does, the others load.
    with FileLock(directory.with_suffix(".lock")):
        try:
            return _compile(numba, directory, name, text, key)
        except Exception:
            # A cache cut off while it was written, or damaged: unpickling it may raise anything.
            # Made anew; what was no fault of the cache is raised again.
            shutil.rmtree(directory, ignore_errors=True)
            return _compile(numba, directory, name, text, key)


def _compile(numba: Any, directory: Path, name: str, text: str, key: tuple[Any, ...]) -> Loops:
    module = _load(directory, name, text)
    params, state, u, out = (numba.from_dtype(d) for d in key)

    def array(record: Any) -> Any:
        return numba.types.Array(record, 1, "C")

    signatures = {
        "start": (array(params), array(state)),
        "run": (array(params), array(state), array(u), array(out)),
    }
    options = {"nogil": True, "error_model": "numpy", "fastmath": False}
    # Kernels are called by kernels only, and their code is in the driver's: no wrapper, no cache.
    # Inlined, the sizes of fields are constants and loops unroll: twice as fast, same bits.
    inner = {
        **options,
        "no_cpython_wrapper": True,
        "no_cfunc_wrapper": True,
        "forceinline": True,
    }
    for function in [n for n in vars(module) if callable(vars(module)[n]) and n not in signatures]:
        setattr(module, function, numba.njit(**inner)(getattr(module, function)))
    loops = []
    for loop, signature in signatures.items():
        loops.append(
            numba.njit([numba.void(*signature)], cache=True, **options)(getattr(module, loop))
        )
    return Loops(*loops)


def _cache_root() -> Path:
    if "ROTATUM_CACHE_DIR" in os.environ:
        root = Path(os.environ["ROTATUM_CACHE_DIR"])
    else:
        base = os.environ.get("XDG_CACHE_HOME")
        root = (Path(base) if base else Path.home() / ".cache") / "rotatum" / "kernels"
    try:
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=root):
            return root
    except OSError:  # read-only home: compile once per process, where nobody else writes
        return _own_folder()


@lru_cache(maxsize=1)
def _own_folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="rotatum-kernels-"))


def _load(directory: Path, name: str, text: str) -> ModuleType:
    path = directory / f"{name}.py"
    if not path.exists() or path.read_bytes() != text.encode():
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=directory, suffix=".tmp", delete=False) as file:
            file.write(text)
        os.replace(file.name, path)
    module_name = f"rotatum_kernels_{directory.name}"
    spec = importlib.util.spec_from_file_location(module_name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load {path}")
    module = importlib.util.module_from_spec(spec)
    # numba looks the module up by name when it reads its cache.
    sys.modules[module_name] = module
    spec.loader.exec_module(module)
    return module
