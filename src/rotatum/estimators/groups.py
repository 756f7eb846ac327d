"""Joints that share a bank, and batches of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.armfront import ArmFront
from rotatum.estimators.shapes import roles
from rotatum.estimators.tuning import Prepared
from rotatum.record import Records
from rotatum.runtime.bank import Bank

Array = NDArray[np.float64]
Channels = Sequence[Mapping[str, Array]]
"""Per joint of the device, role to (N,)."""
ARM_BATCH = 4096  # samples of an arm at once: with room for bridged ones they are large


class Group:
    """Joints that share a stage: their bank, their places in the device, their input and output.

    ``roles`` are the channels of the log its input is made of.
    """

    def __init__(self, prepared: Sequence[Prepared], places: Sequence[int]) -> None:
        self.prepared = tuple(prepared)
        self.places = np.array(places)
        stage = prepared[0].stage
        self.bank = Bank(stage, np.concatenate([p.params for p in prepared]))
        self.u = stage.input.zeros(len(prepared))
        self.u["enable"] = 1
        self.out = stage.output.zeros(len(prepared))
        shape = prepared[0].shape
        self.roles = roles(shape.actuation, shape.torque, shape.side)


def batch_records(group: Group, samples: int) -> Records:
    """Input records for a batch of ``samples`` of a group, ``enable`` set."""
    u = group.bank.stage.input.zeros(samples, len(group.prepared))
    u["enable"] = 1
    return u


def run_alone(group: Group, time: Array, channels: Channels) -> Records:
    """Take a batch of joints that need nothing of each other.

    Args:
        group: of joints.
        time: (N,) s.
        channels: of all joints of the device.

    Returns:
        (N, m) records of readings.
    """
    u = batch_records(group, len(time))
    u["time"] = time[:, None]
    for i, place in enumerate(group.places):
        for role in group.roles:
            u[role][:, i] = channels[place][role]
    return group.bank.run(u)


def run_arm(
    groups: Sequence[Group], arm: ArmFront, time: Array, channels: Channels
) -> list[Records]:
    """Take a batch of joints that are moved by one arm.

    Args:
        groups: all of its joints.
        arm: what goes before them.
        time: (N,) s.
        channels: of all joints of the device.

    Returns:
        (N, m) records of readings per group.
    """
    pieces: list[list[Records]] = [[] for _ in groups]
    for first in range(0, len(time), ARM_BATCH):
        part = slice(first, first + ARM_BATCH)
        own = [{role: x[part] for role, x in logged.items()} for logged in channels]
        u, last = arm.expand(arm.batch(time[part], own), groups[0].bank.stage.input)
        for group, kept in zip(groups, pieces, strict=True):
            out = group.bank.run(np.ascontiguousarray(u[:, group.places]))
            kept.append(out[last])
    return [np.concatenate(kept) for kept in pieces]
