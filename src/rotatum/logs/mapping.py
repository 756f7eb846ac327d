"""From a device's channels and a file's names to what is read and how it becomes SI values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.source import CLOCK, Pick
from rotatum.models import Channel, Device, Joint, Reading, find_unit
from rotatum.models.channel import STATES

__all__ = ["Column", "Mapped", "map_channels"]

_ANGLES = ("theta", "theta1", "theta2", "setpoint")


@dataclass(frozen=True)
class Column:
    """A channel of the log: value = slope * number + intercept.

    Parameters
    ----------
    owner, role : the joint or the inertial sensor, and what it is of it.
    pick : where the file keeps it.
    slope, intercept : the channel's factor, offset, sign, unit and side in one line.
    hold : "sampled" or "held".
    """

    owner: str
    role: str
    pick: Pick
    slope: float
    intercept: float
    hold: str

    def convert(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return SI values at the joint or in the sensor's axes, (N,), beside the numbers."""
        if self.slope == 1.0 and self.intercept == 0.0:
            return numbers
        values = numbers * self.slope
        if self.intercept != 0.0:
            values += self.intercept
        return values


@dataclass(frozen=True)
class Mapped:
    """All channels of a log.

    Parameters
    ----------
    clock : the sample clock; None: the file has none, the device's period stands in.
    columns : of all joints.
    inertial : of the accelerometers and gyroscopes.
    """

    clock: Column | None
    columns: tuple[Column, ...]
    inertial: tuple[Column, ...] = ()


def map_channels(
    device: Device,
    names: Sequence[str],
    path: str,
    *,
    inertial: bool = True,
    true_states: bool = False,
) -> Mapped:
    """Find the channels of every joint of a device, and of its inertial sensors, in a file.

    Roles whose entry in [channels] names a column are taken from there; others from the canonical
    column `<joint>.<role>` if the file has it: an entry without a name says how it is kept where
    there is one. With one joint in the device, no names in its [channels]
    and one prefix in the file, that prefix is the joint. An inertial sensor's axes go the same way,
    its name being the prefix; a file may have none of them.

    Parameters
    ----------
    device : the device.
    names : names of the file's columns or arrays.
    path : the file, for messages.
    inertial : whether accelerometers and gyroscopes are wanted.
    true_states : whether the true positions and rates that a simulator writes are.

    Raises
    ------
    LogError if a joint has no channel at all, or there is neither a clock nor a period.
    """
    columns: list[Column] = []
    for joint in device.joints:
        name = _joint_name(joint, device, names)
        found = [
            _column(joint, name, role, joint.channels.get(role, Channel()))
            for role in joint.roles
            if true_states or role not in STATES[joint.actuation]
            if _found(name, role, joint.channels, names)
        ]
        if not found:
            what = f"no channel of joint {name}; the device needs [channels], or the log columns"
            what += f" such as {name}.q"
            raise LogError(what, where=path, hint=f"The log has: {', '.join(names[:12])}.")
        columns.extend(found)
    axes = (
        _axis(sensor.name, role, sensor.channels.get(role, Reading()))
        for sensor in (device.inertial if inertial else ())
        for role in sensor.roles
        if _found(sensor.name, role, sensor.channels, names)
    )
    return Mapped(_clock(device, names, path), columns=tuple(columns), inertial=tuple(axes))


def _clock(device: Device, names: Sequence[str], path: str) -> Column | None:
    """Find the sample clock."""
    if device.time is None and CLOCK not in names:
        if device.period is not None:
            return None
        what = f'no column "{CLOCK}", and the device gives neither channels.time nor'
        raise LogError(
            f"{what} estimator.period",
            where=path,
            hint=f"The log has: {', '.join(names[:12])}.",
        )
    channel = device.time or Channel()
    factor = _after(channel)
    pick = _pick(CLOCK, channel)
    return Column("", CLOCK, pick, channel.factor * factor, channel.offset * factor, channel.hold)


def _column(joint: Joint, name: str, role: str, channel: Channel) -> Column:
    """Turn a channel into a straight line: factor, offset, sign, then unit, then side."""
    after = _after(channel)
    if channel.side == "motor":
        ratio = joint.gear_ratio(role)
        after = after / ratio if role in _ANGLES else after * ratio
    pick = _pick(f"{name}.{role}", channel)
    return Column(name, role, pick, channel.factor * after, channel.offset * after, channel.hold)


def _axis(name: str, role: str, reading: Reading) -> Column:
    """Turn an axis of a sensor into a straight line: factor, offset, sign, then unit."""
    after = _after(reading)
    pick = _pick(f"{name}.{role}", reading)
    return Column(name, role, pick, reading.factor * after, reading.offset * after, "sampled")


def _after(reading: Reading) -> float:
    """Return what comes after factor and offset, the side aside."""
    return reading.sign * (find_unit(reading.unit).factor if reading.unit else 1.0)


def _pick(label: str, reading: Reading) -> Pick:
    """Say where the file keeps a channel; without a name and an index in the canonical column."""
    return Pick(label, reading.name if reading.named else label, reading.index)


def _found(owner: str, role: str, channels: Mapping[str, Reading], names: Sequence[str]) -> bool:
    """Whether a channel has a place in the file: the one its entry says, or the canonical one."""
    return (role in channels and channels[role].named) or f"{owner}.{role}" in names


def _joint_name(joint: Joint, device: Device, names: Sequence[str]) -> str:
    """Return the prefix of a joint's canonical columns."""
    if len(device.joints) > 1 or any(c.named for c in joint.channels.values()):
        return joint.name
    prefixes = {name.rpartition(".")[0] for name in names if name.rpartition(".")[2] in joint.roles}
    prefixes.discard("")
    return prefixes.pop() if len(prefixes) == 1 else joint.name
