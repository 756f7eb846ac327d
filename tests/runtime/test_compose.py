"""Composition writes a straight-line module, and says which wire is wrong."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from rotatum.record import Record, matrix, vector
from rotatum.runtime.bank import Bank
from rotatum.runtime.compose import Part, chain, copy_lines
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage
from tests.runtime.tiny import TOTAL, TWICE, Signal

PARTS = (
    Part("first", TOTAL),
    Part("second", TWICE, {"x": "first.x", "y": "u.x"}),
    Part("third", TOTAL, "second"),
)


def test_a_chain_is_its_parts_one_after_the_other():
    stage = chain("three", "Three parts.", PARTS, input=Signal.layout())
    params = stage.params.zeros(1)
    params["first"]["gain"], params["third"]["gain"] = 1.0, 10.0
    params["first"]["start"], params["third"]["start"] = 100.0, 0.5
    u = stage.input.zeros(2, 1)
    u["x"] = [[1.0], [2.0]]
    expected = [[0.5 + 10.0 * (2 * 101.0 + 1.0)], [0.5 + 10.0 * (203.0 + 2 * 103.0 + 2.0)]]
    for compile in (False, True):
        assert Bank(stage, params, compile=compile).run(u)["x"].tolist() == expected
    assert stage.cites == ("one2000", "two2001")
    assert stage.output == TOTAL.output


def test_state_holds_every_part_what_it_reads_and_what_it_writes():
    stage = chain("three", "Three parts.", PARTS, input=Signal.layout())
    fields = ["first", "first_out", "second", "second_in", "second_out", "third"]
    assert list(stage.state.fields) == fields
    assert list(stage.params.fields) == ["first", "second", "third"]


def test_a_chain_is_a_stage_like_any_other():
    inner = chain("inner", "Two parts.", PARTS[:2], input=Signal.layout())
    outer = chain(
        "outer", "Nested.", [Part("a", inner), Part("b", TOTAL, "a")], input=Signal.layout()
    )
    flat = chain("three", "Three parts.", PARTS, input=Signal.layout())
    one, other = outer.params.zeros(1), flat.params.zeros(1)
    one["a"]["first"]["gain"] = other["first"]["gain"] = 2.0
    one["b"]["gain"] = other["third"]["gain"] = 3.0
    u = outer.input.zeros(5, 1)
    u["x"][:, 0] = np.arange(5.0)
    nested = Bank(outer, one, compile=False).run(u)
    assert nested.tolist() == Bank(flat, other, compile=False).run(u).tolist()


def test_the_text_written_can_be_read():
    stage = chain("three", "Three parts.", PARTS, input=Signal.layout())
    text = inspect.getsource(stage.step)
    assert "state.second_in.x = state.first_out.x" in text
    assert "third_step(params.third, state.third, state.second_out, out)" in text


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ([Part("a", TWICE)], "a reads Both; 'u' is a Signal"),
        (
            [Part("a", TOTAL, "b"), Part("b", TOTAL)],
            "a reads 'b', which is neither u nor an earlier",
        ),
        ([Part("a", TOTAL, "nobody")], "'nobody'"),
        ([Part("a", TWICE, {"x": "u.x"})], r"wires of a do not match.*\['y'\]"),
        ([Part("a", TOTAL, {"x": "u.x", "z": "u.x"})], r"wires of a do not match.*\['z'\]"),
        ([Part("a", TOTAL, {"x": "u.speed"})], r"state.a_in.x cannot be wired from 'u.speed'.*: x"),
        ([Part("a", TOTAL, {"x": "u"})], "state.a_in.x cannot be wired from 'u'"),
        ([Part("a", TOTAL), Part("b", TOTAL, {"x": "a.total"})], "'a.total'"),
        ([Part("a", TOTAL), Part("a", TOTAL)], "a"),
        ([Part("a b", TOTAL)], "a b"),
        ([], "label"),
    ],
)
def test_a_wrong_wire_is_named(parts, words):
    with pytest.raises(StageError, match=words):
        chain("wrong", "Wrong.", parts, input=Signal.layout())


class Vectors(Record):
    """A vector on its way."""

    v = vector("n", "numbers")


class Matrices(Record):
    """A matrix on its way."""

    m = matrix(2, 2, "numbers")


def total_of_vector(params, state, u, out):
    """Sum the elements."""
    out.x = 0.0
    for i in range(len(u.v)):
        out.x = out.x + u.v[i]


def sum_stage(n):
    one = Signal.layout()
    return Stage("sum", one, one, Vectors.layout(n=n), one, nothing_init, total_of_vector)


def nothing_init(params, state):
    """Nothing to do."""
    state.x = 0.0


def test_vectors_are_wired_element_by_element_and_only_to_their_own_size():
    parts = [Part("a", sum_stage(3), {"v": "u.v"})]
    stage = chain("v", "A vector.", parts, input=Vectors.layout(n=3))
    u = stage.input.zeros(1)
    u["v"] = [1.0, 2.0, 4.0]
    assert Bank(stage, stage.params.zeros(1), compile=False).update(u)["x"].tolist() == [7.0]
    with pytest.raises(StageError, match=r"cannot be wired from 'u\.v'"):
        chain("v", "A vector.", parts, input=Vectors.layout(n=4))


def test_matrices_are_not_copied_between_stages():
    with pytest.raises(StageError, match="matrices are not copied"):
        copy_lines(Matrices.layout().fields["m"], "state.a_in.m", "u.m")
