"""The one table of units: what a log or a device file may declare, and its SI factor."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from rotatum.errors import DeviceError, nearest

__all__ = ["Unit", "find_unit", "unit_names"]

_G = 9.80665  # m/s^2, standard gravity


@dataclass(frozen=True)
class Unit:
    """A unit: SI value = factor times the number.

    Parameters
    ----------
    name : spelling shown to users.
    kind : "angle", "speed", "angular acceleration", "acceleration", "torque", "stiffness", "time"
        or "length".
    factor : SI units per unit.
    """

    name: str
    kind: str
    factor: float


# A current stays a current: where the torque constant is not known, "A" stands in for the torque
# and stiffness comes out in A/rad.
_UNITS = (
    Unit("rad", "angle", 1.0),
    Unit("mrad", "angle", 1e-3),
    Unit("deg", "angle", pi / 180.0),
    Unit("rev", "angle", 2.0 * pi),
    Unit("rad/s", "speed", 1.0),
    Unit("deg/s", "speed", pi / 180.0),
    Unit("rpm", "speed", 2.0 * pi / 60.0),
    Unit("rad/s^2", "angular acceleration", 1.0),
    Unit("deg/s^2", "angular acceleration", pi / 180.0),
    Unit("m/s^2", "acceleration", 1.0),
    Unit("g", "acceleration", _G),
    Unit("mg", "acceleration", 1e-3 * _G),
    Unit("N m", "torque", 1.0),
    Unit("N mm", "torque", 1e-3),
    Unit("mN m", "torque", 1e-3),
    Unit("N cm", "torque", 1e-2),
    Unit("kN m", "torque", 1e3),
    Unit("A", "torque", 1.0),
    Unit("mA", "torque", 1e-3),
    Unit("N m/rad", "stiffness", 1.0),
    Unit("N mm/rad", "stiffness", 1e-3),
    Unit("N m/deg", "stiffness", 180.0 / pi),
    Unit("A/rad", "stiffness", 1.0),
    Unit("s", "time", 1.0),
    Unit("ms", "time", 1e-3),
    Unit("us", "time", 1e-6),
    Unit("ns", "time", 1e-9),
    Unit("m", "length", 1.0),
    Unit("mm", "length", 1e-3),
)
_ALIASES = {
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "radians": "rad",
    "turn": "rev",
    "sec": "s",
    "°/s": "deg/s",
    "dps": "deg/s",
}


def unit_names(*kinds: str) -> tuple[str, ...]:
    """Return the names of all units, or of those of the given kinds."""
    return tuple(unit.name for unit in _UNITS if not kinds or unit.kind in kinds)


def find_unit(name: str, *kinds: str) -> Unit:
    """Return the unit of that name; "Nm", "N m", "N.m" and "N*m" are one spelling.

    Parameters
    ----------
    name : the unit as written in a file.
    kinds : kinds that are acceptable; none given: any.

    Raises
    ------
    DeviceError if the unit is unknown, or is of another kind than asked for.

    >>> find_unit("Nmm").factor
    0.001
    """
    by_spelling = {_spelling(unit.name): unit for unit in _UNITS}
    written = name.strip()
    unit = by_spelling.get(_spelling(_ALIASES.get(written, written)))
    if unit is None:
        close = nearest(written, unit_names(*kinds))
        hint = f'Did you mean "{close}"?' if close else None
        raise DeviceError("unknown unit", value=name, allowed=unit_names(*kinds), hint=hint)
    if kinds and unit.kind not in kinds:
        what = f"this is a unit of {unit.kind}, and one of {' or '.join(kinds)} is needed"
        raise DeviceError(what, value=name, allowed=unit_names(*kinds))
    return unit


def _spelling(name: str) -> str:
    """Reduce a unit's name to what its spellings have in common."""
    for written, plain in (("²", "2"), ("µ", "u"), ("μ", "u"), ("·", "")):
        name = name.replace(written, plain)
    return "".join(letter for letter in name if letter not in " .*^-_")
