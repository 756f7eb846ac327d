"""Layouts: dtype, nesting, sizes, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.record import (
    Field,
    Layout,
    LayoutError,
    Record,
    integer,
    matrix,
    number,
    vector,
)


class Pair(Record):
    """Two kinds of numbers."""

    gain = number("what it multiplies", unit="N m", symbol="K")
    count = integer("how many")


class Solver(Record):
    """Sizes by name."""

    alpha = vector("p", "coefficients", unit="N m")
    P = matrix("p", "q", "covariance")
    kind = vector("q", "switches", kind="int")
    three = vector(3, "a fixed size")


def test_dtype_is_aligned_native_and_without_padding():
    layout = Solver.layout(p=2, q=3)
    assert layout.dtype.names == ("alpha", "P", "kind", "three")
    assert layout.dtype.itemsize == 8 * (2 + 6 + 3 + 3)
    assert layout.dtype.isalignedstruct
    assert layout.dtype["P"].shape == (2, 3)
    assert layout.dtype["alpha"].base == np.float64
    assert layout.dtype["kind"].base == np.int64


def test_fields_keep_the_order_of_the_class():
    assert list(Pair.fields()) == ["gain", "count"]
    assert Solver.dims() == ("p", "q")
    assert Pair.dims() == ()


def test_records_give_their_fields_as_attributes_and_write_through():
    records = Pair.layout().zeros(2)
    records[1].gain = 4.0
    assert records["gain"].tolist() == [0.0, 4.0]
    assert type(records[0]) is np.record


def test_nested_records_write_through_too():
    outer = Layout("outer", "Records in a record.", {"a": Field(Pair.layout()), "b": number("b")})
    state = outer.zeros(3)
    state[2].a.count = 7
    assert state["a"]["count"].tolist() == [0, 0, 7]
    assert outer.dtype.itemsize == 24


def test_a_snapshot_is_a_copy_of_the_bytes():
    records = Solver.layout(p=2, q=2).zeros(2)
    records["P"][1] = 3.0
    again = np.frombuffer(records.tobytes(), records.dtype)
    assert again["P"].tolist() == records["P"].tolist()


@pytest.mark.parametrize(
    "sizes", [{}, {"p": 2}, {"p": 2, "q": 3, "r": 1}, {"p": 0, "q": 1}, {"p": -1, "q": 1}]
)
def test_sizes_must_be_all_there_and_positive(sizes):
    with pytest.raises(LayoutError, match="Solver needs the sizes p, q"):
        Solver.layout(**sizes)


def test_what_is_no_field_is_refused():
    class Odd(Record):
        """Holds a stray value."""

        gain = number("a gain")
        stray = 3.0

    with pytest.raises(LayoutError, match=r"Odd may hold fields only, got \['stray'\]"):
        Odd.layout()


@pytest.mark.parametrize("name", ["shape", "std", "base", "size", "T", "item", "data", "real"])
def test_names_that_numpy_records_use_are_refused(name):
    # np.record looks among its own attributes first: a kernel would read those, interpreted only.
    fields = {"fine": number("fine"), name: number("taken")}
    with pytest.raises(LayoutError, match=name):
        Layout("odd", "Odd names.", fields)


def test_equal_layouts_are_equal_and_hash_alike():
    assert Solver.layout(p=2, q=1) == Solver.layout(p=2, q=1)
    assert hash(Solver.layout(p=2, q=1)) == hash(Solver.layout(p=2, q=1))
    assert Solver.layout(p=2, q=1) != Solver.layout(p=3, q=1)
    outer = [Layout("o", "o", {"a": Field(Solver.layout(p=n, q=1))}) for n in (2, 3)]
    assert outer[0] != outer[1]


def test_docs_units_and_symbols_survive_binding():
    gain = Pair.layout().fields["gain"]
    assert (gain.doc, gain.unit, gain.symbol) == ("what it multiplies", "N m", "K")
    assert Solver.layout(p=1, q=1).doc == "Sizes by name."
