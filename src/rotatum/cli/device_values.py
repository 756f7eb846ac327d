"""Every value of a joint with its SI unit, for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rotatum.models import Joint, Uncertain

__all__ = ["UNITS", "values"]

# Dotted key of the device file -> unit; what is not here has none.
UNITS: dict[str, str] = {
    "motor.inertia": "kg m^2, motor side",
    "motor.damping": "N m s/rad, motor side",
    "motor.coulomb": "N m, motor side",
    "motor.torque_limit": "N m, motor side",
    "setpoint.r0": "m",
    "setpoint.b": "m/rad",
    "transmission.stiffness": "N m/rad",
    "transmission.cubic": "N m/rad^3",
    "transmission.damping": "N m s/rad",
    "transmission.zero": "rad, or how it is found",
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
    "estimator.window": "s",
    "estimator.period": "s",
}


def values(joint: Joint) -> Iterator[tuple[str, str, str]]:
    """Yield key, value and unit of everything the joint says.

    Parameters
    ----------
    joint : as described.
    """
    yield "actuation", joint.actuation, ""
    for number, motor in enumerate(joint.motors):
        place = "motor" if len(joint.motors) == 1 else f"motor[{number}]"
        yield from _table(place, "motor", motor)
    for name in ("setpoint", "transmission", "link", "encoders", "basis", "estimator"):
        part = getattr(joint, name)
        if part is not None:
            yield from _table(name, name, part)
    for role, channel in joint.channels.items():
        told = [f"{k} = {v}" for k, v in channel.model_dump(exclude_defaults=True).items()]
        yield f"channels.{role}", ", ".join(told), ""


def _table(place: str, kind: str, table: Any) -> Iterator[tuple[str, str, str]]:
    for name in type(table).model_fields:
        value = getattr(table, name)
        if value is not None:
            yield f"{place}.{name}", _text(value), UNITS.get(f"{kind}.{name}", "")


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
