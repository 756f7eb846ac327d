"""Errors of whoever builds stages: raised when one is put together, never in the loop."""

from __future__ import annotations

from rotatum.errors import RotatumError


class StageError(RotatumError):
    """Stages cannot be wired as asked, or a bank was given records of another layout."""
