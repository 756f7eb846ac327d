"""Devices of the catalogue with another encoder, basis or spring."""

from __future__ import annotations

from dataclasses import replace

from rotatum.models import Device

__all__ = ["at_rest_zero", "with_basis", "with_counts", "with_spring"]


def at_rest_zero(device: Device) -> Device:
    """Return the device with its deflections' zeros at 0 rad, as its encoders read at rest.

    The papers' motions begin at once, so that there is no rest in which to read it.
    """
    (joint,) = device.joints
    springs = tuple(s.model_copy(update={"zero": 0.0}) for s in joint.transmissions)
    return replace(device, joints=(joint.model_copy(update={"transmissions": springs}),))


def with_basis(
    device: Device,
    *,
    orders: int | None = None,
    full: bool | None = None,
    setpoint_range: tuple[float, float] | None = None,
    deflection_range: float | None = None,
) -> Device:
    """Return the device with another basis; what is None stays.

    Args:
        device: of one joint.
        orders: how many odd powers.
        full: whether all powers from 0 on instead.
        setpoint_range: lowest and highest set-point.
        deflection_range: half range of the deflection, rad.
    """
    (joint,) = device.joints
    asked = {
        "orders": orders,
        "full": full,
        "setpoint_range": setpoint_range,
        "deflection_range": deflection_range,
    }
    told = {name: value for name, value in asked.items() if value is not None}
    basis = joint.basis.model_copy(update=told)
    return replace(device, joints=(joint.model_copy(update={"basis": basis}),))


def with_counts(device: Device, counts: float) -> Device:
    """Return the device with encoders of so many counts per turn on link and motors."""
    (joint,) = device.joints
    encoders = joint.encoders.model_copy(update={"link": float(counts), "motor": float(counts)})
    return replace(device, joints=(joint.model_copy(update={"encoders": encoders}),))


def with_spring(device: Device, spring: float) -> Device:
    """Return the device with another constant ``spring`` in the law of its transmissions."""
    (joint,) = device.joints
    springs = []
    for each in joint.transmissions:
        told = each.model_dump(exclude_none=True) | {"spring": spring}
        springs.append(type(each).model_validate(told))
    return replace(device, joints=(joint.model_copy(update={"transmissions": tuple(springs)}),))
