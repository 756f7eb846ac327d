"""Units and quantities."""

from __future__ import annotations

from math import nan, pi

import pytest

from rotatum.errors import DeviceError
from rotatum.models import Uncertain, find_unit, unit_names


@pytest.mark.parametrize("spelling", ["N m", "Nm", "N.m", "N*m", "N·m", "N-m"])
def test_spellings_of_one_unit(spelling: str) -> None:
    assert find_unit(spelling).name == "N m"


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        *(("deg", pi / 180), ("Nmm", 1e-3), ("mNm", 1e-3), ("µs", 1e-6), ("rpm", pi / 30)),
        *(("A", 1.0), ("g", 9.80665), ("mg", 9.80665e-3), ("dps", pi / 180), ("°/s", pi / 180)),
    ],
)
def test_factors(name: str, factor: float) -> None:
    # One rounding of a division is all that may differ.
    assert find_unit(name).factor == pytest.approx(factor, rel=1e-15)


def test_every_unit_is_found_by_its_name() -> None:
    assert [find_unit(name).name for name in unit_names()] == list(unit_names())


def test_unknown_unit_suggests() -> None:
    with pytest.raises(DeviceError, match='Did you mean "deg"'):
        find_unit("degs", "angle")


def test_wrong_kind_is_refused() -> None:
    with pytest.raises(DeviceError, match="a unit of time, and one of angle is needed"):
        find_unit("s", "angle")


def test_uncertain_scales_value_and_std() -> None:
    assert Uncertain(2.0, 0.5).scaled(-4.0) == Uncertain(-8.0, 2.0)


@pytest.mark.parametrize(("value", "std"), [(nan, None), (1.0, 0.0), (1.0, -1.0), (1.0, nan)])
def test_uncertain_refuses_what_cannot_be(value: float, std: float | None) -> None:
    with pytest.raises(ValueError, match="finite"):
        Uncertain(value, std)
