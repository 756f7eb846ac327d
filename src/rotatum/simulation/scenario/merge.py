"""One table over another: how a scenario extends one, and a joint what holds for all joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["merged"]

# Ways to do the same thing: what is given takes the place of the others.
_TORQUES = frozenset({"tau", "tau1", "tau2"})
_SETPOINTS = frozenset({"setpoint", "setpoint_angle", "tau_setpoint"})


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with what `over` gives, key by key and table by table.

    A table with a `kind` of its own replaces the other; so do lists. In a table `drives` a law for
    the `motors` replaces the torques and the other way round, and one way to move a set-point the
    others.

    >>> merged({"noise": {"q": 1.0, "tau": 2.0}}, {"noise": {"q": 3.0}})
    {'noise': {'q': 3.0, 'tau': 2.0}}
    """
    if "kind" in over:
        return dict(over)
    result = dict(base)
    for key, value in over.items():
        below = result.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            kept = _without_replaced(below, value) if key == "drives" else below
            result[key] = merged(kept, value)
        else:
            result[key] = value
    return result


def _without_replaced(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out the drives that those of `over` are given instead of."""
    gone: set[str] = set()
    if "motors" in over:
        gone |= _TORQUES
    if _TORQUES & set(over):
        gone.add("motors")
    if _SETPOINTS & set(over):
        gone |= _SETPOINTS
    return {role: drive for role, drive in base.items() if role not in gone or role in over}
