"""Every rule that shows without types is broken once, and reported on the line that breaks it."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest

from rotatum.export import subset
from rotatum.export.subset import in_file, in_kernels, in_text, main
from tests.export.stages import LOWPASS, load

# Body of a kernel; the line marked `!` is the one that must be reported, for the reason given.
BROKEN = [
    ("state.x = u.x ** 2.0  # !", "**"),
    ("state.x = u.x @ u.y  # !", "@"),
    ("n = 3\nstate.n = n // 2  # !", "//"),
    ("state.x = u.x % 2.0  # !", "%"),
    ("state.n = 1 << 3  # !", "<<"),
    ("state.n = state.n >> 1  # !", ">>"),
    ("state.x = sum(state.v)  # !", "sum()"),
    ("state.x = min(u.x, u.y)  # !", "min()"),
    ("state.x = max(u.x, u.y)  # !", "max()"),
    ("state.x = sorted(state.v)  # !", "sorted()"),
    ("state.x = pow(u.x, 2.0)  # !", "pow()"),
    ("state.x = round(u.x)  # !", "round()"),
    ("state.x = np.exp(u.x)  # !", "np.exp()"),
    ("state.x = other(u.x)  # !", "other()"),
    ("state.x = math.tan(u.x)  # !", "math.tan()"),
    ("state.x = math.tau  # !", "math.tau"),
    ("state.x = elsewhere  # !", "elsewhere"),
    ("state.x = TABLE  # !", "TABLE"),
    ("state.v[:2] = u.x  # !", "slice"),
    ("state.v = [0.0, 1.0]  # !", "list"),
    ("state.v = {0: 1.0}  # !", "dict"),
    ("state.v = {0.0}  # !", "set"),
    ("state.v = (0.0, 1.0)  # !", "tuple"),
    ("state.v = [0.0 for i in range(3)]  # !", "comprehension"),
    ("state.x = 0.0\ntry:  # !\n    state.x = 1.0\nfinally:\n    state.x = 2.0", "try"),
    ("raise ValueError  # !", "raise"),
    ("assert u.x > 0.0  # !", "assert"),
    ("with u.x:  # !\n    state.x = 0.0", "with"),
    ("global g  # !", "global"),
    ("f = lambda: 0.0  # !\nstate.x = f", "lambda"),
    ("def f():  # !\n    pass", "nested function"),
    ("class A:  # !\n    pass", "class"),
    ("import os  # !", "import"),
    ("state.x = 0.0 - math.fabs(u.x)  # !", "0.0 in a sum"),
    ("state.x = 'a'  # !", "string"),
    ("state.x = f'{u.x}'  # !", "f-string"),
    ("state.x = None  # !", "None"),
    ("state.x = 1e999  # !", "constant overflow"),
    ("state.n = 9223372036854775808  # !", "constant overflow"),
    ("kernel(*u)  # !", "star argument"),
    ("state.x = helper(x=u.x)  # !", "keyword argument x"),
    ("state.x = u.get()  # !", "u.get()"),
    ("state.x = range(3)  # !", "range()"),
    ("for x in state.v:  # !\n    state.x = x", "for over a sequence"),
    ("for x in helper(u.x):  # !\n    state.x = x", "for over a call"),
    ("for i in range(0, 3, state.n):  # !\n    state.x = state.v[i]", "step of range()"),
    ("for i, j in range(3):  # !\n    state.x = state.v[i + j]", "loop target"),
    ("for i in range(3):\n    pass\nelse:\n    state.x = 0.0  # !", "for ... else"),
    ("while True:  # !\n    break", "while without a bound"),
    ("while state.n > 0:\n    break\nelse:\n    state.x = 0.0  # !", "while ... else"),
    ("state.x = state.y = 0.0  # !", "a = b = ..."),
    ("state.n = (n := 3)  # !", ":="),
    ("if state.n is 3:  # !\n    state.x = 0.0", "is"),
    ("if state.n in state.v:  # !\n    state.x = 0.0", "in"),
    ("if 0.0 < helper(u.x) < 1.0:  # !\n    state.x = 0.0", "chained comparison of a call"),
    ("u.x  # !", "expression statement"),
    ("x: float  # !\nstate.x = 0.0", "declaration without a value"),
    ("if u.x > 0.0:\n    y = 1.0\nstate.x = y  # !", "y"),
    ("for i in range(3):\n    y = 1.0\nstate.x = y  # !", "y"),
    ("for i in range(3):\n    state.x = 1.0\nstate.n = i  # !", "i"),
    ("for i in range(3):\n    i = 2  # !\n    state.n = i", "i"),
    ("y = 1.0  # !", "y"),
    ("state.x = 0.0\nreturn\nstate.x = 1.0  # !", "unreachable statement"),
    ("if u.x > 0.0:\n    return 1.0\nreturn  # !", "return"),
    ("del state.x  # !", "del"),
    ("match state.n:  # !\n    case 1:\n        state.x = 0.0", "match"),
]

MODULE = """\
import math

import numpy as np

TABLE = [1.0, 2.0]


def helper(x: float) -> float:
    return x


def kernel(params, state, u, out):
"""


@pytest.mark.parametrize(("body", "what"), BROKEN, ids=[what for _, what in BROKEN])
def test_every_rule_is_reported_on_its_line(body: str, what: str) -> None:
    text = MODULE + textwrap.indent(body, "    ")
    line = next(i for i, row in enumerate(text.split("\n"), 1) if "# !" in row)
    found = in_text(text, "k.py")
    assert (line, what) in [(v.line, v.what) for v in found]
    assert all(v.why and v.column >= 1 and v.file == "k.py" for v in found)


@pytest.mark.parametrize(
    ("head", "what"),
    [
        ("def kernel(params, state=None):", "default argument"),
        ("def kernel(params, *rest):", "star or keyword-only parameter"),
        ("@decorated\ndef kernel(params):", "decorator"),
    ],
)
def test_heads_of_functions_are_checked(head: str, what: str) -> None:
    assert what in [v.what for v in in_text(f"{head}\n    pass\n")]


def test_what_the_subset_allows_is_not_reported() -> None:
    text = MODULE + textwrap.indent(
        textwrap.dedent("""\
        i = 3
        for i in range(len(state.v)):
            if i == 0 or not state.n & 1:
                continue
            state.v[i] = -helper(u.x) * math.sqrt(2.0) if u.x > 0.0 else math.pi
        while 0.0 < state.x <= 1.0:
            state.x += state.M[1, 2]
            break
        i = ~state.n | 4
        state.n = int(u.x) + i
        """),
        "    ",
    )
    assert in_text(text) == []


def test_functions_without_records_belong_to_python() -> None:
    assert in_text("def gains(bandwidth: float) -> float:\n    return bandwidth ** 2\n") == []


def test_a_function_a_kernel_calls_is_a_kernel() -> None:
    text = (
        "def square(x: float) -> float:\n    return x ** 2\n\n\ndef k(u):\n    u.x = square(u.x)\n"
    )
    assert [(v.line, v.what) for v in in_text(text)] == [(2, "**")]


def test_kernels_reached_in_other_files_are_reported_where_they_are(tmp_path: Path) -> None:
    module = load(
        tmp_path,
        "def square(x):\n    return x ** 2\n\n\n"
        "def init(params, state):\n    state.x = square(1.0)\n",
        "reached",
    )
    found = in_kernels(module.init)
    assert [(v.file, v.line, v.column) for v in found] == [(str(tmp_path / "reached.py"), 2, 12)]


def test_the_kernels_of_the_package_are_inside() -> None:
    assert in_kernels(LOWPASS.init, LOWPASS.step) == []
    assert main([]) == 0


def test_the_command_prints_and_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "k.py"
    path.write_text("def k(u):\n    u.x = u.x ** 2\n")
    assert main([str(path)]) == 1
    assert capsys.readouterr().out.startswith(f"{path}:2:11: **: ")
    path.write_text("def k(u):\n    u.x = u.x * u.x\n")
    assert main([str(path)]) == 0
    assert in_file(path) == []


def test_the_error_shows_some_and_carries_all() -> None:
    text = "def k(u):\n" + "    u.x = u.x ** 2\n" * 9
    error = subset.SubsetError(in_text(text, "k.py"))
    assert len(error.violations) == 9
    assert "k.py:2:11: **" in str(error)
    assert "and 4 more" in str(error)
