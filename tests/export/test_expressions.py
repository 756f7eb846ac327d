"""Random expressions: Python and C agree bit for bit, whatever the grouping and the numbers."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotatum.export import build_shared
from rotatum.record import Layout, integer, number
from rotatum.runtime import jit
from rotatum.runtime.stage import Stage
from tests.export.stages import load

# Python raises where C returns inf or nan; kernels guard against that, and so do these.
HEAD = """\
import math

def over(a, b):
    if b == 0.0:
        return a
    return a / b

def root(x):
    if x < 0.0:
        return x
    return math.sqrt(x)

def grow(x):
    if x > 700.0 or x != x:
        return 1.0
    return math.exp(x)

def arc(x):
    if x != x:
        return 0.25
    if x > 1.0:
        x = 1.0
    if x < -1.0:
        x = -1.0
    return math.asin(x)

def wave(x):
    if x - x != 0.0:
        return 0.25
    return math.sin(x) - math.cos(x)
"""
COUNT = 12  # expressions compiled at once: the compiler's start is what costs
# A zero in a sum is outside the subset.
FLOATS = st.floats(allow_nan=False, allow_infinity=False).filter(lambda x: x != 0.0)
SPECIAL = [0.0, -0.0, 1.0, -1.0, 5e-324, 1e308, -1e308, np.inf, -np.inf, np.nan, 0.1, 1e-8]


def _constant(x: float) -> str:
    return repr(x) if x >= 0.0 and repr(x)[0] != "-" else f"(-{-x!r})"


ints = st.recursive(
    st.sampled_from(["u.i", "u.j", "3", "(-2)"]),
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from("+-*|&^"), inner),
        st.builds("(-{})".format, inner),
        st.builds("(~{})".format, inner),
    ),
    max_leaves=4,
)
floats = st.recursive(
    st.one_of(st.sampled_from(["u.x", "u.y", "u.z"]), st.builds(_constant, FLOATS)),
    lambda inner: st.one_of(
        st.builds("{} {} {}".format, inner, st.sampled_from("+-*"), inner),
        st.builds("({} {} {})".format, inner, st.sampled_from("+-*"), inner),
        st.builds("({} {} {})".format, ints, st.sampled_from("+-*"), inner),
        st.builds("{} - ({})".format, inner, inner),
        st.builds("-{}".format, inner),
        st.builds("over({}, {})".format, inner, inner),
        st.builds("root({})".format, inner),
        st.builds("grow({})".format, inner),
        st.builds("wave({})".format, inner),
        st.builds("arc({})".format, inner),
        st.builds("math.fabs({})".format, inner),
        st.builds("({} if {} < {} else {})".format, inner, inner, inner, inner),
        st.builds("({} if not {} <= {} or {} != {} else {})".format, *[inner] * 6),
    ),
    max_leaves=12,
)


@pytest.mark.usefixtures("c_compiler")
@settings(max_examples=25)
@given(
    st.lists(floats, min_size=COUNT, max_size=COUNT), st.lists(ints, min_size=COUNT, max_size=COUNT)
)
def test_expressions_agree(float_texts: list[str], int_texts: list[str]) -> None:
    body = [f"    out.f{i} = {text}" for i, text in enumerate(float_texts)]
    body += [f"    out.i{i} = {text}" for i, text in enumerate(int_texts)]
    text = f"{HEAD}\ndef init(params, state):\n    state.n = 0\n\n"
    text += "def step(params, state, u, out):\n    state.n = params.n\n" + "\n".join(body) + "\n"
    with tempfile.TemporaryDirectory() as folder:
        stage = _stage(load(Path(folder), text, "expressions"))
        u = _inputs()
        results = []
        for loops in (jit.interpreted(stage), build_shared(stage)):
            params, state = stage.params.zeros(1), stage.state.zeros(1)
            out = stage.output.zeros(len(u))
            loops.start(params, state)
            loops.run(params, state, u, out)
            results.append(out)
    for name in stage.output.fields:
        python, c = results[0][name], results[1][name]
        same = (python.view(np.int64) == c.view(np.int64)) | ((python != python) & (c != c))
        number_of = int(name[1:])
        expression = float_texts[number_of] if name[0] == "f" else int_texts[number_of]
        assert same.all(), f"{expression}: {python[~same][0]!r} != {c[~same][0]!r}"


def _inputs() -> np.ndarray:
    rng = np.random.default_rng(7)
    u = INPUT.zeros(80)
    for name in "xyz":
        u[name][:40] = rng.normal(size=40) * 10.0 ** rng.integers(-12, 12, 40)
        u[name][40:] = rng.choice(SPECIAL, 40)
    u["i"], u["j"] = rng.integers(-6, 7, (2, 80))
    return u


INPUT = Layout(
    "U", "In.", {n: number(n) for n in "xyz"} | {n: integer(n) for n in "ij"}
)  # fmt: skip
OUTPUT = Layout(
    "Y",
    "Out.",
    {f"f{i}": number("float") for i in range(COUNT)}
    | {f"i{i}": integer("int") for i in range(COUNT)},
)


def _stage(module: Any) -> Stage:
    one = Layout("N", "One.", {"n": integer("n")})
    return Stage("expressions", one, one, INPUT, OUTPUT, module.init, module.step)
