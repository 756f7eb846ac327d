"""From a device back to the tables of its file, and with some of their values replaced."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rotatum.errors import DeviceError, RotatumError, ScenarioError
from rotatum.models.device import Device, device_from_tables
from rotatum.models.joint import Joint
from rotatum.simulation.scenario.dotted import Key, assigned, path_of

__all__ = ["device_toml", "plain_channels", "replaced", "tables_of"]

_MANY = {"motors": "motor", "transmissions": "transmission"}
_SENSORS = {"accelerometers": "accelerometer", "gyroscopes": "gyroscope"}
# Keys of a [transmission] that belong to no law.
_OF_ANY_LAW = ("damping", "zero", "preload", "limit")


def tables_of(device: Device) -> dict[str, Any]:
    """Return the tables a device file would have; `device_from_tables` makes the device of them.

    Everything that differs from its default is in them, nothing else.
    """
    joints = [_joint(joint) for joint in device.joints]
    tables: dict[str, Any] = {"name": device.name}
    if device.time is not None:
        tables["channels"] = {"time": _plain(device.time)}
    if device.robot is not None:
        tables["robot"] = _plain(device.robot)
    for field, key in _SENSORS.items():
        sensors = [_plain(sensor) for sensor in getattr(device, field)]
        tables |= {key: sensors} if sensors else {}
    if len(joints) == 1 and device.joints[0].name == device.name:
        own = joints[0].pop("channels", {})
        channels = {**tables.pop("channels", {}), **own}
        return tables | joints[0] | ({"channels": channels} if channels else {})
    return tables | {"joint": joints}


def replaced(device: Device, values: Mapping[str, Any], *, source: str, place: str) -> Device:
    """Return a device with other values in its tables.

    Parameters
    ----------
    device : as its file describes it.
    values : dotted keys of its file -> value. Of several joints "motor.inertia" is that of every
        joint and "axis1.motor.inertia" that of one; "motor[1].inertia" is that of the second motor
        of two. Another law leaves the constants of the old one behind.
    source, place : file and table that ask for it, for messages.

    Raises
    ------
    ScenarioError for keys and values a device file cannot have.
    """
    if not values:
        return device
    tables = tables_of(device)
    names = tuple(joint.name for joint in device.joints)
    # Those of all joints first, so that one joint's wins; a law before its constants.
    ordered = sorted(values, key=lambda key: (path_of(key)[0] in names, not key.endswith("law")))
    try:
        for key in ordered:
            tables = _assigned(tables, path_of(key), values[key], names)
        return device_from_tables(tables, device.source)
    except (DeviceError, ScenarioError) as error:
        raise _refused(error, source, place) from None


def plain_channels(device: Device, held: Mapping[str, tuple[str, ...]]) -> Device:
    """Return the device that reads a log in canonical columns.

    Parameters
    ----------
    device : its own [channels], and those of its inertial sensors, describe other logs and are left
        out.
    held : joint -> roles that are kept until the next sample.
    """
    tables = tables_of(device)
    tables.pop("channels", None)
    for sensor in (sensor for key in _SENSORS.values() for sensor in tables.get(key, ())):
        sensor.pop("channels", None)
    for table in tables.get("joint", [tables]):
        name = table["name"] if "joint" in tables else device.joints[0].name
        roles = {role: {"hold": "held"} for role in held.get(name, ())}
        table.pop("channels", None)
        table |= {"channels": roles} if roles else {}
    return device_from_tables(tables, device.source)


def device_toml(device: Device, remarks: tuple[str, ...] = ()) -> str:
    """Return the text of a device file.

    Parameters
    ----------
    device : to be described.
    remarks : lines of a comment above it.
    """
    import tomli_w

    tables = tables_of(device)
    robot = tables.get("robot", {})
    beside = Path(device.source).parent / str(robot.get("urdf", ""))
    if "urdf" in robot and beside.is_file():
        robot["urdf"] = str(beside.absolute())
    head = "".join(f"# {line}\n" for line in remarks)
    return f"{head}{tomli_w.dumps(tables)}"


def _assigned(
    tables: dict[str, Any], key: Key, value: object, names: tuple[str, ...]
) -> dict[str, Any]:
    """Assign to one joint, to all, or beside them."""
    joints = tables.get("joint")
    if joints is None:
        own = key[1:] if key[0] == names[0] and len(key) > 1 else key
        return _in_joint(tables, own, value)
    if key[0] in names:
        at = names.index(str(key[0]))
        new = [_in_joint(t, key[1:], value) if k == at else t for k, t in enumerate(joints)]
        return tables | {"joint": new}
    if key[0] in ("name", "robot", *_SENSORS.values()):
        beside: dict[str, Any] = assigned(tables, key, value)
        return beside
    return tables | {"joint": [_in_joint(table, key, value) for table in joints]}


def _in_joint(table: dict[str, Any], key: Key, value: object) -> dict[str, Any]:
    """Assign in a joint's table; a new law begins without constants."""
    if key and key[0] == "transmission" and key[-1] == "law":
        springs = table.get("transmission", {})
        for spring in springs if isinstance(springs, list) else [springs]:
            for name in [name for name in spring if name not in _OF_ANY_LAW]:
                del spring[name]
    new: dict[str, Any] = assigned(table, key, value)
    return new


def _joint(joint: Joint) -> dict[str, Any]:
    """Return the table of a joint, in the order of its fields."""
    given, table = _plain(joint), {}
    for field in type(joint).model_fields:
        if field in _MANY:
            parts = [_plain(part) for part in getattr(joint, field)]
            if parts and (field == "motors" or any(parts)):
                table[_MANY[field]] = parts if len(parts) > 1 else parts[0]
        elif field in given:
            table[field] = given[field]
    return table


def _plain(table: BaseModel) -> dict[str, Any]:
    """Return what a table gives, as TOML has it."""
    told: dict[str, Any] = _toml(table.model_dump(exclude_defaults=True, exclude_none=True))
    return told


def _toml(value: Any) -> Any:
    """Write an uncertain value without std as the number it is, and tuples as lists."""
    if isinstance(value, Mapping):
        if set(value) == {"value"}:
            return value["value"]
        return {name: _toml(inner) for name, inner in value.items() if inner is not None}
    if isinstance(value, list | tuple):
        return [_toml(inner) for inner in value]
    return value


def _refused(error: RotatumError, source: str, place: str) -> ScenarioError:
    """Say that it is the scenario that asks for what a device cannot have."""
    return ScenarioError(
        f"[{place}]: {error.what}",
        where=source,
        value=error.value,
        allowed=error.allowed,
        hint=error.hint,
    )
