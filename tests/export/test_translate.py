"""Statements and calls whose meaning C could change: C and interpreted Python agree bit for bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rotatum.export import CompilerError, build_shared, translate
from rotatum.runtime import jit
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage
from rotatum.testing.compare import differences
from tests.export.stages import INPUT, LOWPASS, OUTPUT, PARAMS, STATE, stage_of

TRICKY = {
    "loop bounds are read once": """
def step(params, state, u, out):
    n = 2
    for i in range(n):
        n = n + i
    state.n = 2
    for i in range(state.n + 1):
        state.n = state.n + i
    i = 1
    for i in range(i, 3):
        out.x = out.x + i * u.x
    out.i = n + state.n
""",
    "loops count down and in steps": """
def step(params, state, u, out):
    x = 1.0
    for i in range(2, -1, -1):
        x = x * 0.5 + state.v[i] * u.x
        state.v[i] = x
    for i in range(0, 3, 2):
        state.w[i] = state.w[i] + i
    out.x = x
""",
    "a name is a loop variable here and a local there": """
def step(params, state, u, out):
    for i in range(3):
        state.v[i] = state.v[i] + u.x
    for k in range(3):
        i = state.w[k] + 1
        state.w[k] = i
        out.y = out.y + i
    i = 7
    out.i = i
""",
    "break, continue, while, elif": """
def step(params, state, u, out):
    k = 0
    while k < 10:
        k = k + 1
        if k == 3:
            continue
        elif k == 8:
            break
        elif u.x > 0.0 and not k & 1:
            out.x = out.x + k
        else:
            out.x = out.x - u.y
    out.i = k
""",
    "locals stand for parts of records": """
def add(P, v, x):
    for i in range(len(P)):
        for j in range(len(v)):
            P[i, j] = P[i, j] + v[j] * x
    return P[0, 0]

def total(v):
    s = 0.0
    for i in range(len(v)):
        s += v[i]
    return s

def step(params, state, u, out):
    M = state.M
    part = state.part
    part.v[1] = u.x
    part.x -= u.y * 0.1
    out.x = add(M, part.v, u.x)
    row = M[1]
    row[2] = row[2] * 0.5
    out.y = total(M[2]) + total(row) + total(state.part.v)
""",
    "one kernel for ints and floats": """
def larger(a, b):
    if a > b:
        return a
    return b

def step(params, state, u, out):
    out.x = larger(u.x, u.y)
    out.y = larger(u.i, u.y) if False else larger(u.y, 0.5)
    out.i = larger(u.i, 3)
""".replace("larger(u.i, u.y) if False else ", ""),
    "flags, choices and chained comparisons": """
def step(params, state, u, out):
    good = u.x - u.x == 0.0
    if good and u.y > 0.0:
        good = False
    out.x = u.x if not good else -u.y
    out.i = 3 if -0.5 < u.x <= 0.5 else -4
    if good == (u.i > 0):
        out.y = (u.x + u.y) - (u.x - (u.y - 1.0))
""",
    "bits and wide integers": """
def step(params, state, u, out):
    state.n = (state.n | 4) & ~1 ^ u.i
    out.i = state.n | 5000000000 & 40000 * 50000
    out.x = -state.n * 2 - -3 + 2 * 3 * u.x
""",
    "names that C has taken": """
def register(auto, exp, asin):
    return auto * math.exp(exp) + math.asin(asin)

def step(params, state, u, out):
    default = register(u.x, -0.5, 0.25)
    state.double = default
    int64_t = u.i + 1
    out.x = state.double
    out.i = int64_t
""",
    "calls with effects keep their order": """
def count(state):
    state.n = state.n + 1
    return state.n

def step(params, state, u, out):
    if count(state) > 2 and count(state) > 3 or count(state) > 100:
        out.x = 1.0
    n = count(state)
    state.v[0] = count(state) + n
    out.i = state.n
    out.y = state.v[0]
""",
    "init is called to start again": """
def init(params, state):
    state.x = params.a
    state.n = 0

def step(params, state, u, out):
    state.n = state.n + 1
    state.y = state.y + 1.0
    if state.n == 4:
        init(params, state)
    out.x = state.x + state.y
""",
    "zeros keep their sign": """
def step(params, state, u, out):
    zero = 0.0
    out.x = (1.5 - 1.5) - math.fabs(u.x * zero)
    out.y = -(zero - zero) + u.x
    state.y = zero * -u.x
""",
    "numbers of math": """
def step(params, state, u, out):
    out.x = math.pi * u.x + 1e-300 + 1e22 - math.fabs(u.y)
    out.y = math.nan if u.x > 0.0 else -math.inf
    out.i = int(u.x * 10.0) + int(float(u.i) / 2.0)
""",
}


@pytest.mark.usefixtures("c_compiler")
@pytest.mark.parametrize("text", TRICKY.values(), ids=TRICKY.keys())
def test_c_does_what_python_does(tmp_path: Path, text: str) -> None:
    assert_c_is_python(stage_of(tmp_path, text))


def assert_c_is_python(stage: Stage) -> None:
    """Run three joints for 20 samples both ways and compare every byte of state and output."""
    rng = np.random.default_rng(1)
    params, u = PARAMS.zeros(3), INPUT.zeros(60)
    params["a"] = rng.normal(size=3)
    u["x"], u["y"], u["i"] = *rng.normal(size=(2, 60)), rng.integers(-5, 6, 60)
    results = []
    for loops in (jit.interpreted(stage), build_shared(stage)):
        state, out = STATE.zeros(3), OUTPUT.zeros(60)
        loops.start(params, state)
        loops.run(params, state, u, out)
        results.append((state, out))
    (state, out), (state_c, out_c) = results
    assert list(differences(state, state_c, STATE, ("Python", "C"))) == []
    assert list(differences(out, out_c, OUTPUT, ("Python", "C"))) == []
    assert any(np.any(out[name] != 0) for name in ("x", "y", "i"))


def test_functions_that_only_read_take_const(tmp_path: Path) -> None:
    source = translate(stage_of(tmp_path, TRICKY["locals stand for parts of records"])).source
    assert "static double total(const double *v)" in source or "_total(const double *v)" in source
    assert "(double (*P)[4], const double *v, double x)" in source


def test_init_zeroes_the_state_before_the_kernel() -> None:
    source = translate(LOWPASS).source
    assert "memset(state, 0, sizeof *state);\n    init(params, state);" in source


def test_records_shared_by_parts_are_one_struct() -> None:
    header = translate(LOWPASS).header
    assert "typedef lowpass_sample_t lowpass_input_t;" in header
    assert header.count("typedef struct") == 3


def test_no_memory_and_no_globals_in_c(tmp_path: Path) -> None:
    for text in TRICKY.values():
        source = translate(stage_of(tmp_path, text)).source
        assert "alloc" not in source
        code = [line for line in source.split("\n") if line and line[0] not in " /#*{}"]
        assert all("(" in line for line in code)  # at the left margin: heads of functions only


@pytest.mark.usefixtures("c_compiler")
def test_records_of_another_layout_are_refused() -> None:
    loops = build_shared(LOWPASS)
    with pytest.raises(StageError, match="LowpassState"):
        loops.start(LOWPASS.params.zeros(2), LOWPASS.state.zeros(3))
    with pytest.raises(StageError, match="do not fit"):
        loops.run(
            LOWPASS.params.zeros(2),
            LOWPASS.state.zeros(2),
            LOWPASS.input.zeros(3),
            LOWPASS.output.zeros(3),
        )


def test_a_missing_compiler_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompilerError, match=r"no-such-compiler.*cc, gcc or clang"):
        build_shared(LOWPASS)
