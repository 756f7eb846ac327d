"""What accelerometers and gyroscopes on an arm's links show: linear in q'' and in q'."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rotatum.models.robot.interface import Robot
from rotatum.models.robot.names import no_such
from rotatum.models.rotations import rotation_of

__all__ = ["AccelerometerMap", "GyroscopeMap", "Mounted"]

Array = NDArray[np.float64]
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


class _Fixed(NamedTuple):
    """Readings of one frame: constant rows against what the frame does, in the frame's axes.

    `rows` are of the readings; `linear` (m, 6) of an acceleration and an angular acceleration,
    `quadratic` (m, 9) of the products of the angular velocity's components.
    """

    frame: str
    rows: NDArray[np.intp] | slice
    linear: Array
    quadratic: Array


class AccelerometerMap:
    """Readings of accelerometers on the links: ``y = T(q) q'' + W(q, q')`` (deluca2007 eq. 10).

    A reading is ``v^T R^T (p'' - g)``, the specific force at the sensor's place p along its axis v,
    the vector of gravity g pointing down: at rest it shows gravity upwards. (Equation 9 prints
    ``+ g0``: its g0 points up.)

    Parameters
    ----------
    robot : the arm.
    sensors : where they sit; those of a device are its `accelerometers`.

    Attributes
    ----------
    columns : (M,) names of the readings as in logs, ``<name>.ax``, sensor by sensor.

    Raises
    ------
    DeviceError for a frame the arm does not have.
    """

    def __init__(self, robot: Robot, sensors: Sequence[Mounted]) -> None:
        self.robot = robot
        self.columns = tuple(f"{s.name}.a{axis}" for s in sensors for axis in s.axes)
        self._fixed = _by_frame(robot, sensors)
        self._still = np.zeros(robot.size)

    def matrix(self, q: Array) -> Array:
        """Return T(q), (M, n) m: lever arms of the joints' accelerations."""
        found = np.empty((len(self.columns), self.robot.size))
        for at in self._fixed:
            rotation = self.robot.pose(at.frame, q).rotation
            found[at.rows] = at.linear @ _turned(rotation, self.robot.jacobian(at.frame, q))
        return found

    def rest(self, q: Array, dq: Array) -> Array:
        """Return W(q, q'), (M,) m/s^2: what they show where no joint accelerates."""
        return self.both(q, dq)[1]

    def both(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Return T(q), (M, n) m, and W(q, q'), (M,) m/s^2: one look at each frame.

        Parameters
        ----------
        q, dq : (n,) rad, rad/s.
        """
        robot, moved = self.robot, np.empty(6)
        matrix, rest = np.empty((len(self.columns), robot.size)), np.empty(len(self.columns))
        for at in self._fixed:
            rotation = robot.pose(at.frame, q).rotation
            motion = robot.motion(at.frame, q, dq, self._still)
            w = motion.angular_velocity.dot(rotation)
            moved[:3] = (motion.acceleration - robot.gravity_vector).dot(rotation)
            moved[3:] = motion.angular_acceleration.dot(rotation)
            matrix[at.rows] = at.linear.dot(_turned(rotation, robot.jacobian(at.frame, q)))
            rest[at.rows] = at.linear.dot(moved) + at.quadratic.dot((w[:, None] * w).ravel())
        return matrix, rest

    def readings(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return what they show, (M,) m/s^2, of q, q', q'' (n,) [rad, rad/s, rad/s^2]."""
        matrix, rest = self.both(q, dq)
        shown: Array = matrix @ ddq + rest
        return shown


class GyroscopeMap:
    """Readings of gyroscopes on the links: ``y = J(q) q'``.

    Parameters
    ----------
    robot : the arm.
    sensors : where they sit; those of a device are its `gyroscopes`.

    Attributes
    ----------
    columns : (G,) names of the readings as in logs, ``<name>.gx``, sensor by sensor.

    Raises
    ------
    DeviceError for a frame the arm does not have.
    """

    def __init__(self, robot: Robot, sensors: Sequence[Mounted]) -> None:
        self.robot = robot
        self.columns = tuple(f"{s.name}.g{axis}" for s in sensors for axis in s.axes)
        # A rate is along the axis of a turn as an acceleration is along that of a push.
        self._fixed = _by_frame(robot, sensors)

    def matrix(self, q: Array) -> Array:
        """Return J(q), (G, n), without unit."""
        found = np.empty((len(self.columns), self.robot.size))
        for at in self._fixed:
            turns = self.robot.jacobian(at.frame, q)[3:]
            found[at.rows] = at.linear[:, :3] @ (self.robot.pose(at.frame, q).rotation.T @ turns)
        return found


def _turned(rotation: Array, jacobian: Array) -> Array:
    """Return a Jacobian (6, n) in the frame's axes."""
    n = jacobian.shape[1]
    turned: Array = (rotation.T @ jacobian.reshape(2, 3, n)).reshape(6, n)
    return turned


def _by_frame(robot: Robot, sensors: Sequence[Mounted]) -> tuple[_Fixed, ...]:
    """Return the constant rows of all readings, frame by frame."""
    frames: dict[str, list[tuple[int, Array, Array]]] = {}
    row = 0
    for sensor in sensors:
        if sensor.frame not in robot.frames:
            raise no_such("frame", sensor.frame, robot.frames, where=f"sensor {sensor.name}")
        turn, place = rotation_of(sensor.rpy), np.asarray(sensor.position, dtype=np.float64)
        for axis in sensor.axes:
            direction = turn[:, _AXES.index(axis)]
            frames.setdefault(sensor.frame, []).append((row, direction, place))
            row += 1
    return tuple(_of_frame(frame, rows) for frame, rows in frames.items())


def _of_frame(frame: str, rows: Sequence[tuple[int, Array, Array]]) -> _Fixed:
    """``v . (w' x r) = (r x v) . w'`` and ``v . (w x (w x r)) = w . (v r^T - (v . r)) w``."""
    linear = [np.concatenate([v, np.cross(r, v)]) for _, v, r in rows]
    quadratic = [(np.outer(v, r) - v @ r * np.eye(3)).ravel() for _, v, r in rows]
    places = [row for row, _, _ in rows]
    first, end = places[0], places[-1] + 1
    # A slice is written to in a tenth of the time.
    joined = slice(first, end) if end - first == len(places) else np.array(places)
    return _Fixed(frame, joined, np.array(linear), np.array(quadratic))
