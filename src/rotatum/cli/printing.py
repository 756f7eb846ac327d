"""Standard output: JSON exactly as it is, tables as wide as there is room."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["print_json", "stdout"]

_PIPED_WIDTH = 120  # characters; a file has no width, and 80 folds the table of results


def print_json(value: Mapping[str, Any] | Sequence[Any]) -> None:
    """Print one JSON value; a number that JSON does not have is an error.

    Parameters
    ----------
    value : of finite numbers, texts, lists, mappings and None.
    """
    print(json.dumps(value, allow_nan=False, indent=2, ensure_ascii=False))


def stdout() -> Console:
    """Return a console that writes texts as they are: no markup, no colours for numbers."""
    from rich.console import Console

    fixed = None if sys.stdout.isatty() or "COLUMNS" in os.environ else _PIPED_WIDTH
    return Console(width=fixed, markup=False, highlight=False, emoji=False)
