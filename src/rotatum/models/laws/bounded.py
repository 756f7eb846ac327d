"""Exponents kept where the exponential function, and its square, are numbers."""

from __future__ import annotations

__all__ = ["LARGEST", "bounded"]

LARGEST = 300.0  # exp(300) is 2e130


def bounded(x: float) -> float:
    """Return x, or the nearer of +-300 beyond it."""
    if x > LARGEST:
        x = LARGEST
    if x < -LARGEST:
        x = -LARGEST
    return x
