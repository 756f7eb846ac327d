"""What the papers' cases are made of: frozen laws, spreading over processes, naming cases."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.columns import Power
from rotatum.evaluation.papers.case import Outcome, Value
from rotatum.evaluation.papers.catalogue import PAPERS, asked_for
from rotatum.evaluation.papers.frozen import FrozenLaw, raw_powers
from rotatum.evaluation.parallel import spread

LAW = FrozenLaw(
    (Power(1, 0), Power(1, 1), Power(1, 2), Power(3, 1)), np.array([2.0, -1.0, 5.0, 30.0]), 0.7
)


def test_raw_powers_by_hand() -> None:
    # 3 phi (s - 2)^2 = 12 phi - 12 phi s + 3 phi s^2
    found = raw_powers([Power(1, 2)], [3.0], 2.0)
    assert found == {Power(1, 0): 12.0, Power(1, 1): -12.0, Power(1, 2): 3.0}


def test_raw_powers_are_the_same_polynomial() -> None:
    phi, s = np.linspace(-0.4, 0.4, 9)[:, None], np.linspace(0.3, 1.4, 7)[None, :]
    raw = sum(a * phi**i * s**j for (i, j), a in LAW.raw().items())
    np.testing.assert_allclose(raw, LAW.torque(phi, s), rtol=0.0, atol=1e-13)  # values below 10


def test_stiffness_is_the_slope_of_the_torque() -> None:
    phi, s, h = np.linspace(-0.4, 0.4, 9), 1.1, 1e-5
    slope = (LAW.torque(phi + h, s) - LAW.torque(phi - h, s)) / (2.0 * h)
    # h^2 tau'''/6 = 1e-10 * 30 * 6 * 0.4 / 6; rounding 1e-16 / h.
    np.testing.assert_allclose(LAW.stiffness(phi, s), slope, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("workers", [1, 2])
def test_spread_keeps_the_order_and_tells_progress(workers: int) -> None:
    told: list[tuple[int, int | None]] = []
    jobs = list(range(7))
    found = spread(math.factorial, jobs, lambda *done: told.append(done), workers=workers)
    assert found == [math.factorial(job) for job in jobs]
    assert told == [(number, 7) for number in range(1, 8)]


def test_spread_of_nothing() -> None:
    assert spread(math.factorial, []) == []


def test_workers_share_the_kernel_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    # Where the cache is, jit reads from the environment: workers must have it as it is now.
    monkeypatch.setenv("ROTATUM_CACHE_DIR", "somewhere-else")
    assert spread(os.getenv, ["ROTATUM_CACHE_DIR"] * 4, workers=2) == ["somewhere-else"] * 4


def test_an_error_in_a_worker_is_raised_here() -> None:
    with pytest.raises(ValueError, match="negative"):
        spread(math.factorial, [1, 2, -3, 4], workers=2)


def test_a_paper_or_one_of_its_cases() -> None:
    paper, cases = asked_for("flacco2012")
    assert cases == PAPERS["flacco2012"].cases
    assert [case.name for case in asked_for("flacco2012:table2")[1]] == ["table2"]
    names = [case.name for case in paper.cases]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("request_", "words"),
    [("flaco2012", 'Did you mean "flacco2012"'), ("flacco2012:tabel1", 'Did you mean "table1"')],
)
def test_a_misspelt_request_suggests(request_: str, words: str) -> None:
    with pytest.raises(MethodError, match=words):
        asked_for(request_)


def test_every_case_says_what_it_assumes() -> None:
    for paper in PAPERS.values():
        for case in paper.cases:
            assert case.assumed, case.name
            assert all(sentence.endswith(".") for sentence in (case.prints, *case.assumed))


def test_numbers_json_does_not_have_become_null() -> None:
    outcome = Outcome((Value("x", "%", 1.0, math.inf, math.nan, 2.0),), findings=("So.",))
    told: Any = outcome.to_json()
    assert told["values"][0] == {
        "label": "x", "unit": "%",
        "paper": 1.0, "paper_settings": None, "algebraic": 2.0, "rotatum": None, "weak": None,
    }  # fmt: skip
    with pytest.raises(KeyError):
        outcome.value("y")


def test_workers_end_with_a_killed_parent() -> None:
    code = (
        "import os, time\n"
        "from rotatum.evaluation.parallel import spread\n"
        "print(*spread(time.sleep, [0.3] * 6, workers=2))\n"
        "from joblib.externals.loky import get_reusable_executor\n"
        "print(*get_reusable_executor(max_workers=2, reuse=True)._processes, flush=True)\n"
        "time.sleep(60.0)\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    with parent.stdout as told:
        told.readline()
        workers = [int(pid) for pid in told.readline().split()]
        parent.kill()
        parent.wait()
    assert len(workers) == 2
    patience = time.monotonic() + 20.0
    while any(alive(pid) for pid in workers):
        assert time.monotonic() < patience
        time.sleep(0.1)


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    # Where nobody reaps orphans, a dead one stays as a zombie.
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] != "Z"
