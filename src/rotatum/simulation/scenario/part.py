"""What all tables of a scenario's file share: frozen, no unknown keys, strict numbers."""

from __future__ import annotations

from rotatum.models.table import Table

__all__ = ["Part"]


class Part(Table):
    """A table of a scenario's file."""
