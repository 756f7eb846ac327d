"""What `rotatum observe` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rotatum.cli.tables import table_of
from rotatum.evaluation.observation import Observation
from rotatum.report.observation_lines import (
    NUMBERS,
    observation_rows,
    observation_sentences,
    observation_settings,
    titles,
)

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["print_observation"]


def print_observation(console: Console, found: Observation) -> None:
    """Print peaks and errors per joint, what the errors are against, the settings.

    Args:
        console: where to.
        found: what to tell.
    """
    head = titles(found)
    title = f"{found.device.name}: full state; {found.samples:,} samples, {found.seconds:.4g} s"
    table = table_of(*head, title=title, numbers=NUMBERS)
    table.padding = (0, 1, 0, 0)
    table.columns[0].no_wrap = True
    for row in observation_rows(found):
        table.add_row(*row)
    console.print(table)
    for text in observation_sentences(found):
        console.print(text)
    for text in observation_settings(found):
        console.print(text, style="dim")
