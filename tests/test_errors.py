"""Errors are one readable sentence and keep their data."""

from __future__ import annotations

import pytest

from rotatum import errors
from rotatum.errors import DeviceError, ExtraError, RotatumError, nearest


def test_the_sentence_has_place_value_allowed_and_hint() -> None:
    error = DeviceError(
        "unknown unit", where="arm.toml", value="degg", allowed=("rad", "deg"), hint="Say deg."
    )
    assert str(error) == "arm.toml: unknown unit, got 'degg'; allowed: rad, deg. Say deg."
    assert (error.where, error.value, error.allowed) == ("arm.toml", "degg", ("rad", "deg"))


def test_a_long_list_is_cut_short() -> None:
    text = str(RotatumError("no", allowed=[f"n{i}" for i in range(30)]))
    assert "n11 and 18 more" in text
    assert "n12" not in text


def test_every_error_is_a_rotatum_error() -> None:
    kinds = [getattr(errors, name) for name in errors.__all__ if name.endswith("Error")]
    assert len(kinds) == 9
    assert all(issubclass(kind, RotatumError) for kind in kinds)


def test_an_extra_names_what_to_install() -> None:
    error = ExtraError("reading Parquet needs pyarrow", extra="parquet", where="run.parquet")
    assert 'pip install "rotatum[parquet]"' in str(error)
    assert error.extra == "parquet"


@pytest.mark.parametrize(
    ("given", "expected"), [("thet", "theta"), ("Theta", "theta"), ("xyz", None)]
)
def test_nearest(given: str, expected: str | None) -> None:
    assert nearest(given, ["q", "theta", "tau"]) == expected
