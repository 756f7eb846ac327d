"""Stages for the tests of the export: the low-pass, and stages from a text."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

from rotatum.kernels import lowpass
from rotatum.record import Field, Layout, integer, matrix, number, vector
from rotatum.runtime.stage import Stage

LOWPASS = Stage(
    "lowpass",
    lowpass.LowpassParams.layout(),
    lowpass.LowpassState.layout(),
    lowpass.Sample.layout(),
    lowpass.Sample.layout(),
    lowpass.init,
    lowpass.step,
)

PART = Layout("Part", "A nested record.", {"x": number("a number"), "v": vector(3, "a vector")})

PARAMS = Layout("P", "Params.", {"a": number("a"), "b": number("b"), "n": integer("n")})
STATE = Layout(
    "S",
    "State.",
    {
        "x": number("a number"),
        "y": number("another"),
        "n": integer("a count"),
        "v": vector(3, "a vector"),
        "w": vector(3, "integers", kind="int"),
        "M": matrix(3, 4, "a matrix"),
        "part": Field(PART),
        "double": number("a C keyword"),
    },
)
INPUT = Layout("U", "Input.", {"x": number("x"), "y": number("y"), "i": integer("i")})
OUTPUT = Layout("Y", "Output.", {"x": number("x"), "y": number("y"), "i": integer("i")})


def stage_of(folder: Path, text: str, name: str = "example") -> Stage:
    """Return a stage whose kernels are written in ``text``; ``init`` may be left out."""
    text = f"import math\n{text}"
    if "def init(" not in text:
        text += "\n\ndef init(params, state):\n    state.x = params.a\n"
    module = load(folder, text, name)
    return Stage(name, PARAMS, STATE, INPUT, OUTPUT, module.init, module.step)


def load(folder: Path, text: str, name: str) -> Any:
    """Write a module and import it."""
    path = folder / f"{name}.py"
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(f"example_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
