"""Accelerometers and gyroscopes on the links of an arm, and what goes wrong with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.simulation.motion import Motion
from rotatum.simulation.sensing.checks import NOT_NEGATIVE, POSITIVE, check_value, check_vector
from rotatum.simulation.sensing.rotations import rotation_about, rotation_of
from rotatum.simulation.sensing.streams import stream

if TYPE_CHECKING:
    from rotatum.models.device import Device
    from rotatum.models.robot.interface import Robot

Array = NDArray[np.float64]
Readings = dict[str, dict[str, Array]]
_AXES = ("x", "y", "z")


class Mounted(Protocol):
    """An inertial sensor as its device file describes it."""

    @property
    def name(self) -> str:
        """What a log calls it."""

    @property
    def frame(self) -> str:
        """Frame of the arm it is fixed to."""

    @property
    def position(self) -> Sequence[float]:
        """Where in the frame, (3,) m."""

    @property
    def rpy(self) -> Sequence[float]:
        """How it is turned in the frame: roll, pitch, yaw, (3,) rad."""

    @property
    def axes(self) -> Sequence[str]:
        """Axes it measures, of "x", "y", "z"."""


@dataclass(frozen=True)
class InertialFaults:
    """What goes wrong with an accelerometer or gyroscope; by default nothing.

    The faults act in the order of this list. Units of a reading: m/s^2 or rad/s.

    Parameters
    ----------
    delay
        s: the reading is that of an earlier instant.
    misalignment
        (3,) rad: the sensor is turned by this rotation vector, in its own axes, against the pose
        the device file gives.
    bias
        (3,) added, along x, y, z.
    noise
        Standard deviation of white Gaussian noise.
    saturation
        Beyond it a reading is this limit; None: no limit.
    resolution
        Readings are multiples of it; None: as fine as numbers.

    Raises `RotatumError` for a value no sensor can have.
    """

    noise: float = 0.0
    bias: Sequence[float] = (0.0, 0.0, 0.0)
    misalignment: Sequence[float] = (0.0, 0.0, 0.0)
    delay: float = 0.0
    saturation: float | None = None
    resolution: float | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("noise", "delay"):
            check_value(f"inertial.{name}", getattr(self, name), NOT_NEGATIVE)
        for name in ("bias", "misalignment"):
            check_vector(f"inertial.{name}", getattr(self, name))
        for name in ("saturation", "resolution"):
            if getattr(self, name) is not None:
                check_value(f"inertial.{name}", getattr(self, name), POSITIVE)


@dataclass(frozen=True)
class Links:
    """Motion of an arm's links at instants, (K, n) each, in the order of the device's joints.

    Parameters
    ----------
    q, dq, ddq : rad, rad/s, rad/s^2.
    """

    q: Array
    dq: Array
    ddq: Array


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
    _check_names(device, faults)
    if not (device.accelerometers or device.gyroscopes):
        return {}
    robot = motion.robot
    if robot is None:
        raise RotatumError(
            "an inertial sensor sits on a frame of an arm, and this device describes no arm",
            where=device.name,
            hint="Give the device file a table [robot].",
        )
    found: Readings = {}
    for letter, kind, measure, sensors in (
        ("a", "accelerometer", specific_force, device.accelerometers),
        ("g", "gyroscope", angular_rate, device.gyroscopes),
    ):
        for number, sensor in enumerate(sensors):
            wrong = faults.get(sensor.name, InertialFaults())
            true = measure(robot, sensor, links_before(motion, device, wrong.delay - late, every))
            drawn = stream(seed, f"noise.{kind}", number).standard_normal(true.shape)
            shown = with_faults(true, wrong, drawn)
            axes = {f"{letter}{axis}": shown[:, _AXES.index(axis)].copy() for axis in sensor.axes}
            found.setdefault(sensor.name, {}).update(axes)
    return found


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


def specific_force(robot: Robot, sensor: Mounted, links: Links) -> Array:
    """Return what an ideal accelerometer shows, (K, 3) m/s^2 in its own axes.

    ``f = R^T (a - g)`` with the acceleration a of its place and the vector g of gravity: at rest
    it shows g upwards (deluca2007 eq. 9 with g0 pointing up).

    Raises `DeviceError` for a frame the arm does not have.
    """
    rotation, w, turned, a = _frame_motions(robot, sensor.frame, links)
    arm = rotation @ np.asarray(sensor.position, dtype=np.float64)
    a = a + np.cross(turned, arm) + np.cross(w, np.cross(w, arm))
    return _in_sensor(sensor, rotation, a - robot.gravity_vector)


def angular_rate(robot: Robot, sensor: Mounted, links: Links) -> Array:
    """Return what an ideal gyroscope shows, ``R^T w``, (K, 3) rad/s in its own axes.

    Raises `DeviceError` for a frame the arm does not have.
    """
    rotation, w, _, _ = _frame_motions(robot, sensor.frame, links)
    return _in_sensor(sensor, rotation, w)


def with_faults(true: Array, faults: InertialFaults, drawn: Array) -> Array:
    """Return readings (K, 3) with faults; `drawn` (K, 3) are standard normal numbers."""
    x: Array = true @ rotation_about(faults.misalignment)
    x = x + np.asarray(faults.bias, dtype=np.float64) + faults.noise * drawn
    if faults.saturation is not None:
        x = np.clip(x, -faults.saturation, faults.saturation)
    if faults.resolution is not None:
        x = faults.resolution * np.round(x / faults.resolution)
    return x


def _frame_motions(robot: Robot, frame: str, links: Links) -> tuple[Array, Array, Array, Array]:
    """Return axes (K, 3, 3), angular velocity, its rate, and acceleration (K, 3) of a frame."""
    rotation = np.array([robot.pose(frame, q).rotation for q in links.q])
    states = zip(links.q, links.dq, links.ddq, strict=True)
    moves = [robot.motion(frame, q, dq, ddq) for q, dq, ddq in states]
    w = np.array([move.angular_velocity for move in moves])
    turned = np.array([move.angular_acceleration for move in moves])
    return rotation, w, turned, np.array([move.acceleration for move in moves])


def _in_sensor(sensor: Mounted, rotation: Array, x: Array) -> Array:
    """Return vectors (K, 3) of the world in the sensor's own axes."""
    seen: Array = np.einsum("kij,ki->kj", rotation @ rotation_of(sensor.rpy), x)
    return seen


def _check_names(device: Device, faults: Mapping[str, InertialFaults]) -> None:
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
