"""Accelerometers and gyroscopes on the links of an arm: readings along a motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.simulation.motion import Motion
from rotatum.simulation.sensing.inertial_unit import (
    InertialFaults,
    InertialUnit,
    Links,
    angular_rate,
    specific_force,
    with_faults,
)

if TYPE_CHECKING:
    from rotatum.models.device import Device
    from rotatum.models.robot.interface import Robot

__all__ = [
    "InertialFaults",
    "InertialUnit",
    "Links",
    "angular_rate",
    "arm_under",
    "check_inertial",
    "inertial_readings",
    "inertial_units",
    "links_before",
    "specific_force",
    "with_faults",
]

Array = NDArray[np.float64]
Readings = dict[str, dict[str, Array]]


def inertial_readings(
    motion: Motion,
    device: Device,
    faults: Mapping[str, InertialFaults],
    *,
    seed: int,
    every: int = 1,
    late: Array | float = 0.0,
) -> Readings:
    """Return sensor -> "ax", "ay", "az" or "gx", "gy", "gz" -> (K,) readings [m/s^2, rad/s].

    Parameters
    ----------
    motion
        Of the arm, with the accelerations of its links.
    device
        Says which sensors there are and where they sit.
    faults
        Sensor -> faults.
    seed, every, late
        Of the random faults; one in `every` instants is sampled; that much after it (K,) [s].

    Raises `RotatumError` for faults of a sensor the device does not have or of two sensors of one
    name, and for sensors without an arm; `DeviceError` for a frame the arm does not have.
    """
    check_inertial(device, faults)
    if not (device.accelerometers or device.gyroscopes):
        return {}
    robot = arm_under(device, motion.robot)
    found: Readings = {}
    for unit in inertial_units(device, faults, seed=seed):
        links = links_before(motion, device, unit.faults.delay - late, every)
        shown = unit.show(robot, links)
        axes = {
            f"{unit.letter}{axis}": x.copy() for axis, x in zip(unit.axes, shown.T, strict=True)
        }
        found.setdefault(unit.sensor.name, {}).update(axes)
    return found


def inertial_units(
    device: Device, faults: Mapping[str, InertialFaults], *, seed: int
) -> tuple[InertialUnit, ...]:
    """Return a device's accelerometers, then its gyroscopes, in its order, with their faults."""
    return tuple(
        InertialUnit(
            sensor, kind, faults.get(sensor.name, InertialFaults()), seed=seed, number=number
        )
        for kind, sensors in (
            ("accelerometer", device.accelerometers),
            ("gyroscope", device.gyroscopes),
        )
        for number, sensor in enumerate(sensors)
    )


def arm_under(device: Device, robot: Robot | None) -> Robot:
    """Return the arm a device's inertial sensors sit on; raise `RotatumError` if there is none."""
    if robot is None:
        raise RotatumError(
            "an inertial sensor sits on a frame of an arm, and this device describes no arm",
            where=device.name,
            hint="Give the device file a table [robot].",
        )
    return robot


def links_before(motion: Motion, device: Device, seconds: Array | float, every: int) -> Links:
    """Return the links `seconds` before each instant kept, as `Trajectory.before` does.

    Accelerations go straight from instant to instant.
    """
    time = motion.time
    instants = np.clip(time[::every] - seconds, time[0], time[-1])
    moving = time[::every] - seconds >= time[0]
    then = [motion.joints[joint.name].before(seconds, every) for joint in device.joints]
    ddq = [motion.acceleration[joint.name] for joint in device.joints]
    return Links(
        q=np.column_stack([x.position["q"] for x in then]),
        dq=np.column_stack([x.velocity["q"] for x in then]),
        ddq=np.column_stack([np.where(moving, np.interp(instants, time, x), 0.0) for x in ddq]),
    )


def check_inertial(device: Device, faults: Mapping[str, InertialFaults]) -> None:
    """Refuse faults of a sensor the device does not have, or of two sensors of one name."""
    accelerometers = [sensor.name for sensor in device.accelerometers]
    gyroscopes = [sensor.name for sensor in device.gyroscopes]
    names = (*accelerometers, *gyroscopes)
    what = "the device has no such accelerometer or gyroscope"
    check_names(faults, names, what=what, where="inertial")
    for name in faults:
        if name in accelerometers and name in gyroscopes:
            raise RotatumError(
                "faults of one name for an accelerometer and a gyroscope, whose units differ",
                where="inertial",
                value=name,
                hint="Give them two names in the device file.",
            )
