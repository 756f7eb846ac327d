"""Devices as a controller is told them: without friction, without payload, other springs."""

from __future__ import annotations

from dataclasses import replace

from rotatum.errors import DeviceError
from rotatum.models.device import Device
from rotatum.models.quantity import Uncertain
from rotatum.models.transmission import Transmission

__all__ = ["less_known", "without_friction"]


def without_friction(device: Device) -> Device:
    """Return the device with motors that rub nowhere."""
    none = {"damping": Uncertain(0.0), "coulomb": Uncertain(0.0)}
    joints = tuple(
        joint.model_copy(
            update={"motors": tuple(motor.model_copy(update=none) for motor in joint.motors)}
        )
        for joint in device.joints
    )
    return replace(device, joints=joints)


def less_known(device: Device, *, stiffness: float = 1.0) -> Device:
    """Return the device as one is told it who does not know its payload, nor its springs well.

    Args:
        device: an arm of joints with linear springs.
        stiffness: factor of theirs.

    Raises:
        DeviceError: a device without an arm, or a spring that is not linear.
    """
    if device.robot is None:
        raise DeviceError("a payload to leave out needs an arm", where=device.name)
    joints = []
    for joint in device.joints:
        spring = joint.transmission
        if spring.law != "linear":
            where = f"{joint.name}.transmission.law"
            raise DeviceError("not a linear spring", where=where, value=spring.law)
        told = {"law": "linear", "stiffness": spring.given["stiffness"][0] * stiffness}
        other = Transmission.model_validate(
            {**told, "damping": spring.damping, "zero": spring.zero}
        )
        joints.append(joint.model_copy(update={"transmissions": (other,)}))
    bare = device.robot.model_copy(update={"payload": None})
    names = tuple(joint.name for joint in device.joints)
    return replace(device, joints=tuple(joints), robot=bare.of(names, device.source))
