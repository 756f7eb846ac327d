"""How the cases are estimated: what the command line asks for, over what the scenario says."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

__all__ = ["Choices"]


@dataclass(frozen=True)
class Choices:
    """Settings of the estimate, as ``rotatum.evaluation.estimate`` takes them; None: not chosen."""

    method: str | None = None
    side: str | None = None
    torque: str | None = None
    cutoff: float | None = None
    window: float | None = None
    order: int | None = None
    stride: int | None = None
    fit: tuple[str, ...] | None = None
    forgetting: float | None = None
    solver: str | None = None
    shrinkage: bool | None = None
    selective: float | None = None
    start: float | None = None

    def over(self, filed: object) -> Choices:
        """Return these, and where nothing is chosen what is filed.

        Args:
            filed: the scenario's ``[estimate]``; a name it lacks is not chosen.
        """
        chosen = {name: _first(value, getattr(filed, name, None)) for name, value in self._items()}
        fit = chosen["fit"]
        return Choices(
            method=chosen["method"],
            side=chosen["side"],
            torque=chosen["torque"],
            cutoff=chosen["cutoff"],
            window=chosen["window"],
            order=chosen["order"],
            stride=chosen["stride"],
            fit=None if fit is None else tuple(fit),
            forgetting=chosen["forgetting"],
            solver=chosen["solver"],
            shrinkage=chosen["shrinkage"],
            selective=chosen["selective"],
            start=chosen["start"],
        )

    def chosen(self) -> dict[str, Any]:
        """Return those that are chosen, by name."""
        return {name: value for name, value in self._items() if value is not None}

    def _items(self) -> list[tuple[str, Any]]:
        return [(field.name, getattr(self, field.name)) for field in fields(self)]


def _first(mine: Any, filed: Any) -> Any:
    return filed if mine is None else mine
