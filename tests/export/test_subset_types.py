"""Every rule that needs types is broken once, and reported where its author wrote it."""

from __future__ import annotations

from pathlib import Path

import pytest

from rotatum.export import SubsetError, translate
from rotatum.export.subset import in_stage
from rotatum.runtime.errors import StageError
from tests.export.stages import INPUT, stage_of

BROKEN = [
    ("out.x = state.n / 2  # !", "/ of ints"),
    ("x = 0\n    if u.x > 0.0:\n        x = 1.0  # !\n    out.x = x", "x is int and float"),
    ("x = 0\n    x += 0.5  # !\n    out.x = x", "x is int and float"),
    ("out.i = u.x  # !", "float stored in a field of int"),
    ("out.i = u.x > 0.0  # !", "bool stored in a field of int"),
    ("out.x = u.z  # !", "z"),
    ("out.x = u.x.x  # !", "float.x"),
    ("out.x = state.v  # !", "assignment to float"),
    ("state.v = state.v  # !", "assignment to float[3]"),
    ("out.x = state.v[u.x]  # !", "index"),
    ("out.x = state.v[3]  # !", "index 3"),
    ("out.x = state.v[-1]  # !", "index -1"),
    ("out.x = state.v[0, 1]  # !", "float[3][i, i]"),
    ("out.x = state.v + 1.0  # !", "float[3]"),
    ("out.i = int(u.x) | 2.0  # !", "bit operation on a float"),
    ("out.i = ~u.x  # !", "~ of a float"),
    ("if u.x:  # !\n        out.x = 0.0", "truth of a float or record"),
    ("out.i = state.n and 3  # !", "and/or of numbers"),
    ("out.x = u.x if u.x > 0.0 else 0  # !", "float if ... else int"),
    ("if (u.x > 0.0) == 1:  # !\n        out.x = 0.0", "comparison of bool and int"),
    ("for i in range(u.x):  # !\n        out.x = state.v[i]", "range() of a float"),
    ("out.x = len(u.x)  # !", "len of float"),
    ("out.i = abs(u.i)  # !", "abs of an int"),
    ("out.x = math.sqrt(u.x, u.y)  # !", "2 arguments"),
    ("out.x = twice(u.x, u.y)  # !", "twice() with 2 arguments"),
    ("out.x = fill(state)  # !", "fill()"),
    ("out.x = state.x + count(state)  # !", "count() beside other parts"),
    ("out.x = twice(count(state))  # !", "count() beside other parts"),
    ("state.v[state.n] = count(state)  # !", "count() beside other parts"),
    ("params.a = 0.0  # !", "params is written to"),
    ("u.x = 0.0  # !", "u is written to"),
    ("fill(u)  # !", "u is written to"),
    ("v = u\n    v.x = 0.0  # !", "u is written to"),
    ("P = state.v\n    P = state.v  # !\n    out.x = P[0]", "P names two records"),
    ("abs(u.x)  # !", "expression statement"),
]

HELPERS = """
def twice(x):
    return 2.0 * x

def fill(state):
    state.x = 0.0

def count(state):
    state.n = state.n + 1
    return 1.0

def step(params, state, u, out):
    """


@pytest.mark.parametrize(("body", "what"), BROKEN, ids=[what for _, what in BROKEN])
def test_every_typed_rule_is_reported_on_its_line(tmp_path: Path, body: str, what: str) -> None:
    stage = stage_of(tmp_path, f"{HELPERS}{body}\n")
    text = (tmp_path / "example.py").read_text()
    line = next(i for i, row in enumerate(text.split("\n"), 1) if "# !" in row)
    found = in_stage(stage)
    assert (str(tmp_path / "example.py"), line, what) in [(v.file, v.line, v.what) for v in found]
    with pytest.raises(SubsetError):
        translate(stage)


@pytest.mark.parametrize(
    ("kernel", "what"),
    [
        ("if x > 0.0:\n        return 1.0\n    return 0", "returns float and int"),
        ("return odd(x)", "odd() calls itself"),
    ],
)
def test_returns_have_one_type_and_no_recursion(tmp_path: Path, kernel: str, what: str) -> None:
    text = f"def odd(x):\n    {kernel}\n\ndef step(params, state, u, out):\n    out.x = odd(u.x)\n"
    assert what in [v.what for v in in_stage(stage_of(tmp_path, text))]


def test_kernels_take_the_four_records(tmp_path: Path) -> None:
    found = in_stage(stage_of(tmp_path, "def step(params, state, u):\n    state.x = u.x\n"))
    assert [(v.line, v.why) for v in found] == [(2, "takes params, state, u, out")]


def test_a_call_that_writes_may_stand_where_order_is_certain(tmp_path: Path) -> None:
    body = (
        "x = count(state)\n    if count(state) > x and 2.0 * count(state) > 0.0:\n"
        "        state.v[0] = -count(state)\n    out.x = x"
    )
    assert in_stage(stage_of(tmp_path, f"{HELPERS}{body}\n")) == []


def test_names_and_records_that_c_cannot_have_are_refused(tmp_path: Path) -> None:
    stage = stage_of(tmp_path, f"{HELPERS}out.x = u.x\n")
    for name in ("double", "two words", "größe"):
        with pytest.raises(StageError, match="C identifier"):
            translate(stage._replace(name=name))
    empty = type(INPUT)("Empty", "Nothing.", {})
    with pytest.raises(StageError, match="no fields"):
        translate(stage._replace(params=empty))
