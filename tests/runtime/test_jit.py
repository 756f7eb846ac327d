"""The compiled cache: keyed by the whole text, rebuilt when damaged, usable by the next process."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from importlib import import_module, invalidate_caches
from pathlib import Path

import numpy as np
import pytest

import rotatum
from rotatum.record import Record, number
from rotatum.runtime import jit
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage
from tests.runtime.tiny import TOTAL

CALLEE = "FACTOR = {factor}\n\n\ndef scaled(x):\n    return FACTOR * x\n"
CALLER = (
    "from {callee} import scaled\n\n\n"
    "def init(params, state):\n    state.x = 0.0\n\n\n"
    "def step(params, state, u, out):\n    state.x = state.x + scaled(u.x)\n    out.x = state.x\n"
)


class One(Record):
    """One number."""

    x = number("a number")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache, and no memory of what this process has compiled."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("ROTATUM_CACHE_DIR", str(folder))
    jit._compiled.cache_clear()
    yield folder
    jit._compiled.cache_clear()


def stage_of(module):
    one = One.layout()
    return Stage("edited", one, one, one, one, module.init, module.step)


def answer(stage):
    bank = Bank(stage, stage.params.zeros(1), compile=True)
    u = stage.input.zeros(1)
    u["x"] = 1.0
    return float(bank.update(u)["x"][0])


def test_an_edit_in_a_callee_in_another_file_is_seen(tmp_path, monkeypatch, cache):
    # numba's own cache looks at the caller's file only and would return the old number.
    monkeypatch.syspath_prepend(str(tmp_path))
    found = []
    for turn, factor in enumerate((2.0, 3.0)):
        for name in ("edited_callee", "edited_caller"):
            sys.modules.pop(name, None)
        (tmp_path / "edited_callee.py").write_text(CALLEE.format(factor=factor) + "# " + "x" * turn)
        (tmp_path / "edited_caller.py").write_text(CALLER.format(callee="edited_callee"))
        invalidate_caches()
        import linecache

        linecache.checkcache()
        found.append(answer(stage_of(import_module("edited_caller"))))
    assert found == [2.0, 3.0]
    assert sum(path.is_dir() for path in cache.iterdir()) == 2  # two digests


def test_the_same_text_is_compiled_once(cache):
    answer_before = jit.compiled(TOTAL)
    assert jit.compiled(TOTAL) is answer_before
    jit._compiled.cache_clear()
    files = {p: p.stat().st_mtime_ns for p in cache.rglob("*") if p.is_file()}
    jit.compiled(TOTAL)
    assert {p: p.stat().st_mtime_ns for p in cache.rglob("*") if p.is_file()} == files


def damage_truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def damage_empty(path: Path) -> None:
    path.write_bytes(b"")


def damage_zeros(path: Path) -> None:
    path.write_bytes(bytes(path.stat().st_size))


def damage_noise(path: Path) -> None:
    path.write_bytes(random.Random(1).randbytes(path.stat().st_size))


@pytest.mark.parametrize("suffix", [".nbi", ".nbc", ".py"])
@pytest.mark.parametrize("damage", [damage_truncate, damage_empty, damage_zeros, damage_noise])
def test_a_damaged_cache_is_made_anew(cache, damage, suffix):
    bank = Bank(TOTAL, TOTAL.params.zeros(1), compile=True)
    u = TOTAL.input.zeros(1)
    good = bank.update(u).tolist()
    damaged = [
        p for p in cache.rglob(f"*{suffix}") if "__pycache__" not in p.parts or suffix != ".py"
    ]
    assert damaged
    for path in damaged:
        damage(path)
    jit._compiled.cache_clear()
    assert Bank(TOTAL, TOTAL.params.zeros(1), compile=True).update(u).tolist() == good


def test_a_cache_that_cannot_be_written_falls_back(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("ROTATUM_CACHE_DIR", str(blocked / "below"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", None)
    root = jit._cache_root()
    assert root.is_dir()
    assert root.is_relative_to(tmp_path)


SCRIPT = """
import sys
from tests.runtime.tiny import TOTAL
from rotatum.runtime import jit
from rotatum.runtime.bank import Bank
params = TOTAL.params.zeros(1)
params["gain"], params["start"] = 2.0, 1.0
u = TOTAL.input.zeros(1)
u["x"] = 4.0
bank = Bank(TOTAL, params)
print(bank.update(u)["x"][0])
if jit.enabled():
    stats = bank._loops.run.stats
    print("hits", sum(stats.cache_hits.values()), "misses", sum(stats.cache_misses.values()))
else:
    print("numba" in sys.modules)
"""


def in_new_process(project, **environment):
    env = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(Path(rotatum.__file__).parent.parent), str(project)]),
        **environment,
    }
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, env=env, check=True
    )
    return done.stdout.split("\n")[:2]


def test_the_next_process_loads_what_this_one_compiled(project, cache):
    here = {"ROTATUM_CACHE_DIR": str(cache)}
    assert in_new_process(project, **here) == ["9.0", "hits 0 misses 1"]
    assert in_new_process(project, **here) == ["9.0", "hits 1 misses 0"]


def test_compilation_can_be_switched_off(project, cache):
    off = in_new_process(project, ROTATUM_JIT="0", ROTATUM_CACHE_DIR=str(cache))
    assert off == ["9.0", "False"]  # the same number, and numba was not even imported
    assert not cache.exists()


def test_the_switch_is_read_when_a_bank_is_made(monkeypatch):
    monkeypatch.setenv("ROTATUM_JIT", "0")
    assert not jit.enabled()
    bank = Bank(TOTAL, TOTAL.params.zeros(1))
    assert type(bank._loops.run).__name__ == "function"
    monkeypatch.setenv("ROTATUM_JIT", "1")
    assert jit.enabled()


def test_interpreted_overflows_to_infinity_without_a_warning():
    params = TOTAL.params.zeros(1)
    params["gain"] = 1e308
    u = TOTAL.input.zeros(2, 1)
    u["x"] = 1e308
    out = Bank(TOTAL, params, compile=False).run(u)
    assert np.isinf(out["x"]).all()
