"""From a device's channels and a file's names to what is read and how it becomes SI values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.logs.source import CLOCK, Pick
from rotatum.models import Channel, Device, Joint, find_unit

__all__ = ["Column", "Mapped", "map_channels"]

_ANGLES = ("theta", "theta1", "theta2", "setpoint")


@dataclass(frozen=True)
class Column:
    """A channel of the log: value = slope * number + intercept.

    Parameters
    ----------
    joint, role : what it is.
    pick : where the file keeps it.
    slope, intercept : the channel's factor, offset, sign, unit and side in one line.
    hold : "sampled" or "held".
    """

    joint: str
    role: str
    pick: Pick
    slope: float
    intercept: float
    hold: str

    def convert(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return SI values at the joint, (N,); the input is left as it is."""
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
    """

    clock: Column | None
    columns: tuple[Column, ...]


def map_channels(device: Device, names: Sequence[str], path: str) -> Mapped:
    """Find the channels of every joint of a device in a file.

    Roles whose entry in [channels] names a column are taken from there; others from the canonical
    column `<joint>.<role>` if the file has it: an entry without a name says how it is kept where
    there is one. With one joint in the device, no names in its [channels]
    and one prefix in the file, that prefix is the joint.

    Parameters
    ----------
    device : the device.
    names : names of the file's columns or arrays.
    path : the file, for messages.

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
            if _named(joint.channels.get(role)) or f"{name}.{role}" in names
        ]
        if not found:
            what = f"no channel of joint {name}; the device needs [channels], or the log columns"
            what += f" such as {name}.q"
            raise LogError(what, where=path, hint=f"The log has: {', '.join(names[:12])}.")
        columns.extend(found)
    return Mapped(clock=_clock(device, names, path), columns=tuple(columns))


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
    unit = find_unit(channel.unit).factor if channel.unit else 1.0
    pick = _pick(CLOCK, channel)
    factor = channel.sign * unit
    return Column("", CLOCK, pick, channel.factor * factor, channel.offset * factor, channel.hold)


def _column(joint: Joint, name: str, role: str, channel: Channel) -> Column:
    """Turn a channel into a straight line: factor, offset, sign, then unit, then side."""
    after = channel.sign * (find_unit(channel.unit).factor if channel.unit else 1.0)
    if channel.side == "motor":
        ratio = joint.gear_ratio(role)
        after = after / ratio if role in _ANGLES else after * ratio
    label = f"{name}.{role}"
    pick = _pick(label, channel)
    return Column(name, role, pick, channel.factor * after, channel.offset * after, channel.hold)


def _pick(label: str, channel: Channel) -> Pick:
    """Say where the file keeps a channel; without a name and an index in the canonical column."""
    return Pick(label, channel.name if _named(channel) else label, channel.index)


def _named(channel: Channel | None) -> bool:
    """Whether an entry says where the file keeps the channel."""
    return channel is not None and (channel.name is not None or channel.index is not None)


def _joint_name(joint: Joint, device: Device, names: Sequence[str]) -> str:
    """Return the prefix of a joint's canonical columns."""
    if len(device.joints) > 1 or any(_named(c) for c in joint.channels.values()):
        return joint.name
    prefixes = {name.rpartition(".")[0] for name in names if name.rpartition(".")[2] in joint.roles}
    prefixes.discard("")
    return prefixes.pop() if len(prefixes) == 1 else joint.name
