"""One text of all kernels: constants written out, callees renamed, everything else refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from rotatum.kernels import lowpass, udrls
from rotatum.kernels.lowpass import smooth
from rotatum.kernels.status import SETTLING as SETTLES
from rotatum.runtime.errors import StageError
from rotatum.runtime.flatten import flatten

GAIN = 2.5
BELOW = -3
ORDERED = True
LISTED = [1.0, 2.0]
NUMPY = np.float64(1.5)


def init(params: Any, state: Any) -> None:
    """Use a constant of this module."""
    state.a = GAIN
    state.b = BELOW


def run_text(step, first=init):
    namespace: dict[str, Any] = {}
    exec(flatten(first, step), namespace)
    return namespace


class Box:
    """Anything with attributes."""


def test_constants_become_literals_and_docstrings_and_annotations_go():
    def step(params: Any, state: Any, u: Any, out: Any) -> None:
        """Say nothing of this."""
        out.x = smooth(0.5, 1.0, u.x) + SETTLES * math.sqrt(GAIN) + lowpass.smooth(0.5, 0.0, 1.0)

    text = flatten(init, step)
    assert "state.a = 2.5" in text
    assert "state.b = -3" in text
    assert "256 * math.sqrt(2.5)" in text
    assert text.count("def lowpass_smooth") == 1  # reached twice, written once
    assert "Say nothing" not in text
    assert "Any" not in text
    assert text.index("def lowpass_smooth") < text.index("def step")
    out, u = Box(), Box()
    u.x = 3.0
    run_text(step)["step"](None, None, u, out)
    assert out.x == 2.0 + 256 * math.sqrt(2.5) + 0.5


def test_a_local_name_hides_a_constant():
    def step(params, state, u, out):
        GAIN = u.x
        out.x = GAIN

    assert "out.x = GAIN" in flatten(init, step)


def test_callees_of_callees_come_first():
    text = flatten(udrls.init, udrls.update)
    order = [text.index(f"def {n}(") for n in ("udrls__absorb", "udrls_absorb", "step")]
    assert order == sorted(order)


def test_init_may_be_called_by_step_and_is_written_once():
    def step(params, state, u, out):
        init(params, state)
        out.x = state.a

    text = flatten(init, step)
    assert text.count("def init(") == 1
    state, out = Box(), Box()
    run_text(step)["step"](None, state, None, out)
    assert out.x == 2.5


def test_numbers_of_numpy_are_written_as_numbers():
    def step(params, state, u, out):
        out.x = NUMPY

    out = Box()
    run_text(step)["step"](None, None, None, out)
    assert out.x == 1.5


def uses_list(params, state, u, out):
    out.x = LISTED[0]


def uses_bool(params, state, u, out):
    out.x = ORDERED


def uses_numpy(params, state, u, out):
    out.x = np.exp(u.x)


def uses_print(params, state, u, out):
    print(u.x)


def uses_class(params, state, u, out):
    out.x = Box


@pytest.mark.parametrize(
    ("kernel", "name"),
    [
        (uses_list, "LISTED"),
        (uses_bool, "ORDERED"),
        (uses_numpy, "np"),
        (uses_print, "print"),
        (uses_class, "Box"),
    ],
)
def test_what_cannot_be_exported_is_refused_by_name_and_line(kernel, name):
    with pytest.raises(StageError, match=rf"{kernel.__name__} uses '{name}', line 2"):
        flatten(init, kernel)


def test_a_closure_cannot_be_flattened():
    scale = 3.0

    def step(params, state, u, out):
        out.x = scale

    with pytest.raises(StageError, match="uses 'scale'"):
        flatten(init, step)


def test_only_functions_with_a_source_are_kernels():
    with pytest.raises(StageError, match="plain Python function"):
        flatten(init, math.sqrt)
    namespace: dict[str, Any] = {}
    exec("def step(params, state, u, out):\n    out.x = 1.0\n", namespace)
    with pytest.raises(StageError, match="define it in a file"):
        flatten(init, namespace["step"])


def test_two_modules_of_one_name_keep_their_functions_apart(tmp_path, monkeypatch):
    for folder, value in (("one", 1.0), ("two", 2.0)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "__init__.py").write_text("")
        text = f"def same(x):\n    return x + {value}\n"
        (tmp_path / folder / "twin_kernel.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    from importlib import import_module

    first = import_module("one.twin_kernel").same
    second = import_module("two.twin_kernel").same
    namespace = {"first": first, "second": second}
    (tmp_path / "twin_user.py").write_text(
        "from one.twin_kernel import same as first\n"
        "from two.twin_kernel import same as second\n"
        "def step(params, state, u, out):\n    out.x = 10.0 * first(u.x) + second(u.x)\n"
    )
    step = import_module("twin_user").step
    assert namespace  # both are functions named `same` of a module named `twin_kernel`
    out, u = Box(), Box()
    u.x = 0.0
    run_text(step)["step"](None, None, u, out)
    assert out.x == 12.0
