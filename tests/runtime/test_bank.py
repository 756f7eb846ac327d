"""The bank: what it computes, how it resets and restores, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.runtime.bank import Bank
from rotatum.runtime.errors import StageError
from tests.runtime.tiny import TOTAL, Both, Signal

COMPILE = pytest.mark.parametrize("compile", [True, False], ids=["compiled", "interpreted"])


def bank(n=3, compile=False):
    params = TOTAL.params.zeros(n)
    params["gain"] = np.arange(1.0, n + 1.0)
    params["start"] = 10.0 * np.arange(1.0, n + 1.0)
    return Bank(TOTAL, params, compile=compile)


def inputs(*shape):
    u = TOTAL.input.zeros(*shape)
    u["x"] = np.arange(1.0, u.size + 1.0).reshape(shape)
    return u


@COMPILE
def test_update_takes_a_sample_of_every_joint(compile):
    b = bank(compile=compile)
    assert b.update(inputs(3))["x"].tolist() == [11.0, 24.0, 39.0]
    out = TOTAL.output.zeros(3)
    assert b.update(inputs(3), out) is out
    assert out["x"].tolist() == [12.0, 28.0, 48.0]
    assert b.state["count"].tolist() == [2, 2, 2]


@COMPILE
def test_run_is_update_in_a_loop(compile):
    u = inputs(7, 3)
    one, other = bank(compile=compile), bank(compile=compile)
    batch = one.run(u)
    loop = [other.update(u[k]).tolist() for k in range(7)]
    assert batch.tolist() == loop
    assert one.state.tobytes() == other.state.tobytes()


@COMPILE
def test_an_empty_batch_changes_nothing(compile):
    b = bank(compile=compile)
    before = b.state.copy()
    assert b.run(TOTAL.input.zeros(0, 3)).shape == (0, 3)
    assert b.state.tobytes() == before.tobytes()


@COMPILE
@pytest.mark.parametrize(
    ("joints", "totals"),
    [
        (None, [10.0, 20.0, 30.0]),
        ([1], [11.0, 20.0, 39.0]),
        ([0, 2], [10.0, 24.0, 30.0]),
        ([-1], [11.0, 24.0, 30.0]),
        ([], [11.0, 24.0, 39.0]),
        ([False, True, False], [11.0, 20.0, 39.0]),
    ],
)
def test_reset_is_for_all_or_some(compile, joints, totals):
    b = bank(compile=compile)
    b.update(inputs(3))
    b.reset(joints)
    assert b.state["total"].tolist() == totals


@COMPILE
@pytest.mark.parametrize("joints", [[3], [-4], [0, 7]])
def test_reset_of_a_joint_that_is_not_there_is_an_error_and_touches_nothing(compile, joints):
    b = bank(compile=compile)
    b.update(inputs(3))
    with pytest.raises(IndexError):
        b.reset(joints)
    assert b.state["total"].tolist() == [11.0, 24.0, 39.0]


@COMPILE
def test_snapshot_and_restore(compile):
    b = bank(compile=compile)
    b.update(inputs(3))
    snapshot = b.state.copy()
    first = b.run(inputs(5, 3)).tolist()
    b.state[:] = snapshot
    assert b.run(inputs(5, 3)).tolist() == first


def test_params_are_copied():
    params = TOTAL.params.zeros(1)
    b = Bank(TOTAL, params, compile=False)
    params["gain"] = 99.0
    assert b.update(inputs(1))["x"].tolist() == [0.0]


@COMPILE
@pytest.mark.parametrize(
    ("u", "words"),
    [
        (TOTAL.input.zeros(2), r"input has shape \(2,\)"),
        (TOTAL.input.zeros(1, 3), r"input has shape \(1, 3\)"),
        (Both.layout().zeros(2), r"input is not an array of Signal records"),
    ],
)
def test_update_refuses_what_does_not_fit(compile, u, words):
    with pytest.raises(StageError, match=words):
        bank(compile=compile).update(u)


def test_update_refuses_other_records_and_gaps_between_records():
    b = bank(compile=True)
    with pytest.raises(StageError, match="is not an array of Signal records"):
        b.update(Both.layout().zeros(3))
    with pytest.raises(StageError, match="C-contiguous"):
        b.update(TOTAL.input.zeros(6)[::2])
    with pytest.raises(StageError, match="output is not an array of Signal records"):
        b.update(TOTAL.input.zeros(3), Both.layout().zeros(3))


@COMPILE
@pytest.mark.parametrize(
    "u",
    [
        TOTAL.input.zeros(3),
        TOTAL.input.zeros(4, 2),
        TOTAL.input.zeros(4, 6)[:, ::2],
        TOTAL.input.zeros(3, 4).T,
        np.zeros((4, 3)),
    ],
    ids=["one sample", "joints", "gaps", "fortran order", "no records"],
)
def test_run_refuses_what_does_not_fit(compile, u):
    with pytest.raises(StageError, match=r"total\.run"):
        bank(compile=compile).run(u)


def test_a_refused_batch_leaves_the_state():
    b = bank(compile=True)
    before = b.state.copy()
    with pytest.raises(StageError):
        b.run(Both.layout().zeros(4, 3))
    assert b.state.tobytes() == before.tobytes()


@pytest.mark.parametrize(
    "params", [TOTAL.params.zeros(0), TOTAL.params.zeros(2, 2), Signal.layout().zeros(2)]
)
def test_refuses_params_of_another_shape_or_record(params):
    with pytest.raises(StageError, match="params of total"):
        Bank(TOTAL, params)


def test_has_a_length_and_names_itself():
    assert len(bank(5)) == 5
    assert repr(bank(2)) == "Bank(total, 2 joints, 32 bytes of state)"
