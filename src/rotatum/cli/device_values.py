"""Every value of a joint with its SI unit and where it is from, for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from rotatum.models import Joint, Motor, Transmission, Uncertain

__all__ = ["UNITS", "Value", "values"]

# Dotted key of the device file -> unit; what is not here has none, or its law says it.
UNITS: dict[str, str] = {
    "motor.inertia": "kg m^2, motor side",
    "motor.damping": "N m s/rad, motor side",
    "motor.coulomb": "N m, motor side",
    "motor.torque_limit": "N m, motor side",
    "setpoint.r0": "m",
    "setpoint.b": "m/rad",
    "transmission.damping": "N m s/rad",
    "transmission.zero": "rad, or how it is found",
    "transmission.preload": "rad",
    "transmission.limit": "rad",
    "link.inertia": "kg m^2",
    "link.damping": "N m s/rad",
    "link.coulomb": "N m",
    "link.gravity_torque": "N m",
    "encoders.link": "counts per turn",
    "encoders.motor": "counts per turn of the joint",
    "encoders.setpoint": "counts per turn",
    "encoders.accuracy": "rad",
    "encoders.wrap_link": "rad",
    "encoders.wrap_motor": "rad",
    "basis.deflection_range": "rad",
    "estimator.cutoff": "rad/s",
    "estimator.selective": "rad/s",
    "estimator.window": "s",
    "estimator.period": "s",
}


_Entry = tuple[str, str, str, bool]  # key, value, unit, whether the file gives it


class Value(NamedTuple):
    """One value of a joint.

    Parameters
    ----------
    key : dotted key of the device file.
    text : the value.
    unit : its unit, or "".
    source : where it is from, as the file's [sources] says, or "default" where the file does not
        give the value; "": not said.
    """

    key: str
    text: str
    unit: str
    source: str


def values(joint: Joint) -> Iterator[Value]:
    """Yield everything the joint says.

    Parameters
    ----------
    joint : as described.
    """
    for key, text, unit, given in _entries(joint):
        yield Value(key, text, unit, (joint.source_of(key) or "") if given else "default")


def _entries(joint: Joint) -> Iterator[_Entry]:
    yield "actuation", joint.actuation, "", "actuation" in joint.model_fields_set
    for kind, parts in (("motor", joint.motors), ("transmission", joint.transmissions)):
        for number, part in enumerate(parts):
            place = kind if len(parts) == 1 else f"{kind}[{number}]"
            yield from _table(place, kind, part)
    for name in ("setpoint", "link", "encoders", "basis", "estimator"):
        part = getattr(joint, name)
        if part is not None:
            yield from _table(name, name, part)
    for role, channel in joint.channels.items():
        told = [f"{k} = {v}" for k, v in channel.model_dump(exclude_defaults=True).items()]
        yield f"channels.{role}", ", ".join(told), "", True


def _table(place: str, kind: str, table: Any) -> Iterator[_Entry]:
    for name in type(table).model_fields:
        value = getattr(table, name)
        if isinstance(value, Motor):
            yield from _table(f"{place}.{name}", "motor", value)
        elif name == "given":
            yield from _constants(place, table)
        elif value is not None:
            given = name in table.model_fields_set
            yield f"{place}.{name}", _text(value), UNITS.get(f"{kind}.{name}", ""), given


def _constants(place: str, transmission: Transmission) -> Iterator[_Entry]:
    if transmission.law is not None:
        for constant in transmission.model.constants:
            numbers = transmission.given[constant.name]
            yield f"{place}.{constant.name}", _text(numbers), constant.unit, True


def _text(value: object) -> str:
    if isinstance(value, Uncertain):
        return _text(value.value) + (f" +- {1.96 * value.std:.3g}" if value.std else "")
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, tuple):
        return ", ".join(_text(each) for each in value)
    return str(value)
