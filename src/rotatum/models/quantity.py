"""A value with its standard deviation, as device files give them."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

__all__ = ["Uncertain"]


@dataclass(frozen=True)
class Uncertain:
    """A number and, where known, its standard deviation in the same unit.

    Parameters
    ----------
    value : the number, SI.
    std : its standard deviation, positive; None where it is not known.

    Raises
    ------
    ValueError if `value` is not finite or `std` is not positive and finite.
    """

    value: float
    std: float | None = None

    def __post_init__(self) -> None:
        """Refuse what no computation could use."""
        if not isfinite(self.value):
            raise ValueError(f"must be finite, not {self.value}")
        if self.std is not None and not (isfinite(self.std) and self.std > 0.0):
            raise ValueError(f"std must be positive and finite, not {self.std}")

    def scaled(self, factor: float) -> Uncertain:
        """Return the quantity times a constant, its std times the constant's magnitude."""
        std = None if self.std is None else self.std * abs(factor)
        return Uncertain(self.value * factor, std)
