"""The plants of a device's joints, links apart where an arm has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rotatum.models.parts import Link
from rotatum.models.quantity import Uncertain
from rotatum.simulation.plant.bodies import Plant, plant_of
from rotatum.simulation.plant.effects import Effects

if TYPE_CHECKING:
    from rotatum.models.device import Device
    from rotatum.models.joint import Joint

__all__ = ["plants_of"]


def plants_of(
    device: Device, effects: Mapping[str, Effects], *, smoothing: float
) -> tuple[Plant, ...]:
    """Return the plant of each joint; in an arm its link has inertia 1 and no weight.

    Raises `DeviceError` for a missing motor inertia, transmission law or, without an arm, link
    inertia.
    """
    joints = device.joints if device.robot is None else tuple(map(_without_link, device.joints))
    return tuple(
        plant_of(joint, smoothing=smoothing, effects=effects.get(joint.name)) for joint in joints
    )


def _without_link(joint: Joint) -> Joint:
    link = joint.link if joint.link is not None else Link()
    bare = link.model_copy(update={"inertia": Uncertain(1.0), "gravity_torque": 0.0})
    return joint.model_copy(update={"link": bare})
