"""An accelerometer or gyroscope on a link: what it feels, and what goes wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.models.rotations import rotation_about, rotation_of
from rotatum.simulation.sensing.checks import NOT_NEGATIVE, POSITIVE, check_value, check_vector
from rotatum.simulation.sensing.streams import stream

if TYPE_CHECKING:
    from rotatum.models.robot.accelerations import Mounted
    from rotatum.models.robot.interface import Robot

__all__ = [
    "InertialFaults",
    "InertialUnit",
    "Links",
    "angular_rate",
    "specific_force",
    "with_faults",
]

Array = NDArray[np.float64]
_AXES = ("x", "y", "z")


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


class InertialUnit:
    """An accelerometer or gyroscope with its faults but the delay.

    Its noise goes on from one call to the next: sample by sample it shows what it shows at once.

    Parameters
    ----------
    sensor
        Where it sits, and which axes it measures.
    kind
        "accelerometer" or "gyroscope".
    faults
        What goes wrong.
    seed, number
        Of its noise, and of the sensor among those of its kind.
    """

    def __init__(
        self, sensor: Mounted, kind: str, faults: InertialFaults, *, seed: int, number: int = 0
    ) -> None:
        self.sensor, self.faults = sensor, faults
        self.letter = kind[0]
        self.axes = tuple(sensor.axes)
        self._measure = specific_force if kind == "accelerometer" else angular_rate
        self._noise = stream(seed, f"noise.{kind}", number)
        self._columns = [_AXES.index(axis) for axis in self.axes]

    def show(self, robot: Robot, links: Links) -> Array:
        """Return what it shows at the K instants that follow the last call's, (K, A) of its axes.

        Raises `DeviceError` for a frame the arm does not have.
        """
        true = self._measure(robot, self.sensor, links)
        shown = with_faults(true, self.faults, self._noise.standard_normal(true.shape))
        return shown[:, self._columns]


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
