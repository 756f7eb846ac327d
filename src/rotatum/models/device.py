"""Device files: TOML in, one immutable Device out, errors that name the key."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from rotatum.errors import DeviceError, nearest
from rotatum.models.arm import ARM_KEYS, arm_of
from rotatum.models.channel import Channel
from rotatum.models.explain import explain, key_names
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.models.joint import Clocked, Joint
from rotatum.models.robot.description import RobotTable

if TYPE_CHECKING:
    from rotatum.models.robot.interface import Robot

__all__ = ["Device", "device_from_tables", "device_names", "load_device"]

_SHARED = ("name", "channels", "estimator", "sources", "joint", *ARM_KEYS)  # keys beside [[joint]]
_PLURALS = {"motor": "motors", "transmission": "transmissions"}


@dataclass(frozen=True)
class Device:
    """A device: its joints and where its description came from.

    Parameters
    ----------
    name : the device's name.
    joints : its elastic joints, in the order of the file.
    source : path of the file, or "catalogue:NAME".
    time : where logs keep the sample clock; None: the canonical column `time`.
    robot : the rigid arm whose joints these are; None: every link is a pendulum of its own.
    accelerometers, gyroscopes : sensors on the arm's links.
    """

    name: str
    joints: tuple[Joint, ...]
    source: str
    time: Channel | None = None
    robot: RobotTable | None = None
    accelerometers: tuple[Accelerometer, ...] = ()
    gyroscopes: tuple[Gyroscope, ...] = ()

    def build_robot(self) -> Robot | None:
        """Return the rigid arm, its joints in the order of `joints`; None without [robot].

        Raises
        ------
        DeviceError for numbers that no arm has; ExtraError where a URDF file needs pinocchio.
        """
        return None if self.robot is None else self.robot.build()

    def only(self, names: Sequence[str] | None) -> Device:
        """Return the device with only these joints; None or nothing: all.

        An arm stays only with all of its joints, which then keep their order; the sensors on its
        links go with it.

        Raises
        ------
        DeviceError if there is no such joint; it suggests the nearest.
        """
        if not names:
            return self
        known = {joint.name: joint for joint in self.joints}
        for name in names:
            if name not in known:
                close = nearest(name, known)
                hint = f'Did you mean "{close}"?' if close else None
                what = "no such joint in the device"
                raise DeviceError(
                    what, where=self.source, value=name, allowed=tuple(known), hint=hint
                )
        if self.robot is not None and set(names) == set(known):
            return self
        joints = tuple(known[name] for name in dict.fromkeys(names))
        return replace(self, joints=joints, robot=None, accelerometers=(), gyroscopes=())

    @property
    def inertial(self) -> tuple[Accelerometer | Gyroscope, ...]:
        """Its accelerometers, then its gyroscopes."""
        return (*self.accelerometers, *self.gyroscopes)

    @property
    def period(self) -> float | None:
        """Sample period its logs must have [s], where the device declares one."""
        return next((j.estimator.period for j in self.joints if j.estimator.period), None)


def device_names() -> tuple[str, ...]:
    """Return the names of the catalogue, sorted."""
    entries = (files("rotatum.models") / "catalogue").iterdir()
    return tuple(sorted(e.name.removesuffix(".toml") for e in entries if e.name.endswith(".toml")))


def load_device(name_or_path: str | Path) -> Device:
    """Read a device from the catalogue or from a TOML file.

    Parameters
    ----------
    name_or_path : a name of `device_names()`, or a path.

    Raises
    ------
    DeviceError if there is no such device, or the file does not describe one; it names the file,
    the key, the value, what is allowed and the nearest known key.
    """
    text = str(name_or_path)
    if text in device_names():
        entry = files("rotatum.models") / "catalogue" / f"{text}.toml"
        return _from_text(entry.read_text("utf-8"), f"catalogue:{text}")
    path = Path(name_or_path)
    try:
        return _from_text(path.read_text("utf-8"), text)
    except FileNotFoundError:
        raise _no_such_device(text) from None
    except UnicodeDecodeError as error:
        raise DeviceError("is not a text file in UTF-8", where=text) from error
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise DeviceError(f"cannot be read ({reason})", where=text) from error


def device_from_tables(tables: Mapping[str, Any], source: str) -> Device:
    """Build a device from the tables of its file.

    Parameters
    ----------
    tables : the parsed TOML.
    source : where they came from, for messages.

    Raises
    ------
    DeviceError as in `load_device`.
    """
    name = tables.get("name")
    if not isinstance(name, str) or not name:
        raise DeviceError('needs name = "..."', where=source, value=name)
    if "joint" not in tables:
        time, channels = _split_time(tables.get("channels", {}), source, "")
        own = {key: value for key, value in tables.items() if key not in ARM_KEYS}
        joint = _joint({**own, "channels": channels}, source, "")
        device = Device(name=name, joints=(joint,), source=source, time=time)
    else:
        device = _of_joints(name, tables, source)
    arm = arm_of(tables, tuple(joint.name for joint in device.joints), source)
    return replace(
        device, robot=arm.robot, accelerometers=arm.accelerometer, gyroscopes=arm.gyroscope
    )


def _of_joints(name: str, tables: Mapping[str, Any], source: str) -> Device:
    """Build a device of several [[joint]] tables, which share [estimator], [sources], the clock."""
    for key in tables:
        if key not in _SHARED:
            raise _unknown_key(key, _SHARED, source)
    if not isinstance(tables["joint"], list) or not tables["joint"]:
        raise DeviceError("joint must be an array of tables: [[joint]]", where=source)
    time, others = _split_time(tables.get("channels", {}), source, "")
    if others:
        key = f"channels.{next(iter(others))}"
        raise DeviceError(f"{key} belongs into a [joint.channels] table", where=source)
    joints: list[Joint] = []
    for number, table in enumerate(tables["joint"]):
        place = f"joint[{number}]."
        own_time, channels = _split_time(table.get("channels", {}), source, place)
        if own_time is not None and time is not None and own_time != time:
            what = f"{place}channels.time differs from that before it: a log has one clock"
            raise DeviceError(what, where=source)
        time = own_time or time
        settings = {**tables.get("estimator", {}), **table.get("estimator", {})}
        sources = {**tables.get("sources", {}), **table.get("sources", {})}
        merged = {**table, "channels": channels, "estimator": settings, "sources": sources}
        joints.append(_joint(merged, source, place))
    names = [joint.name for joint in joints]
    if len(set(names)) < len(names):
        raise DeviceError("two joints have the same name", where=source, value=names)
    return Device(name=name, joints=tuple(joints), source=source, time=time)


def _joint(table: Mapping[str, Any], source: str, place: str) -> Joint:
    """Build one joint; `motor` and `transmission` are one table or an array of them."""
    fields = dict(table)
    for one, many in _PLURALS.items():
        if many in fields:
            raise _unknown_key(f"{place}{many}", key_names(Joint), source)
        if one in fields:
            given = fields.pop(one)
            fields[many] = given if isinstance(given, list) else [given]
    try:
        return Joint.model_validate(fields)
    except ValidationError as error:
        raise explain(error, Joint, source=source, place=place) from None


def _split_time(raw: object, source: str, place: str) -> tuple[Channel | None, dict[str, Any]]:
    """Take the clock's channel out of a [channels] table."""
    if not isinstance(raw, Mapping):
        raise DeviceError(f"{place}channels must be a table", where=source, value=raw)
    channels = dict(raw)
    if "time" not in channels:
        return None, channels
    try:
        return Clocked.model_validate({"time": channels.pop("time")}).time, channels
    except ValidationError as error:
        raise explain(error, Clocked, source=source, place=f"{place}channels.") from None


def _from_text(text: str, source: str) -> Device:
    """Parse TOML, saying where it is wrong."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DeviceError(f"is not valid TOML: {error}", where=source) from None
    return device_from_tables(tables, source)


def _no_such_device(text: str) -> DeviceError:
    """Say that neither the catalogue nor the disk has it."""
    names = device_names()
    close = nearest(text, names)
    hint = f'Did you mean "{close}"?' if close else None
    what = "no such device file, and no such name in the catalogue"
    return DeviceError(what, value=text, allowed=names, hint=hint)


def _unknown_key(key: str, allowed: tuple[str, ...], source: str) -> DeviceError:
    """Say which key is unknown and which is nearest."""
    close = nearest(key.rpartition(".")[2], allowed)
    hint = f'Did you mean "{close}"?' if close else None
    return DeviceError(f'unknown key "{key}"', where=source, allowed=allowed, hint=hint)
