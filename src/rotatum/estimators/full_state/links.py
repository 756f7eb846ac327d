"""Where the accelerations of the links come from: accelerometers on an arm, or each joint's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError, check_names
from rotatum.estimators.full_state.accelerations import JointAccelerations
from rotatum.estimators.full_state.rest import links_at_rest
from rotatum.kernels.status import NOT_FINITE, UNSEEN
from rotatum.models import Device
from rotatum.models.joint import Joint
from rotatum.models.robot.interface import Robot
from rotatum.models.robot.pendulum import Pendulum

__all__ = ["ArmLinks", "Links", "OwnLinks", "Told", "links_of"]

Array = NDArray[np.float64]

SOURCES = ("accelerometers", "joints")


class Told(NamedTuple):
    """What the sensors tell of the links at one instant.

    Args:
        acceleration: (n,) rad/s^2.
        rate: (n,) rad/s, of gyroscopes.
        coupling: (n,) N m on the motors, ``S^T q''``.
        seen: (n,) whether a joint's acceleration is told at all.
        status: (n,) status bits.
    """

    acceleration: Array
    rate: Array
    coupling: Array
    seen: NDArray[np.bool_]
    status: NDArray[np.int64]


class ArmLinks:
    """Accelerometers, and perhaps gyroscopes, on the links of an arm.

    Args:
        device: with a robot and accelerometers.
        noise: sensor to the standard deviation of its readings; None: each kind has the same.
        gyroscopes: whether its gyroscopes take part.

    Raises:
        MethodError: noise of a sensor there is not.
        DeviceError: a frame the arm does not have.
    """

    def __init__(self, device: Device, noise: Mapping[str, float] | None, gyroscopes: bool) -> None:
        robot = device.build_robot()
        if robot is None or device.robot is None:
            raise MethodError(
                "accelerometers sit on the links of an arm, and this device describes no arm",
                where=device.source,
                hint="Give the device file a table [robot].",
            )
        self._robot, self._joints = robot, device.joints
        turning = device.gyroscopes if gyroscopes else ()
        self._sensors = JointAccelerations(robot, device.accelerometers, turning, noise=noise)
        self.columns, self.gyro_columns = self._sensors.columns, self._sensors.gyro_columns
        self.readings = len(self.columns) + len(self.gyro_columns)
        self.determined = self._sensors.determined
        self.gyro_determined = self._sensors.gyro_determined
        self._coupling = device.robot.coupling_matrix.T

    def joined(self, readings: ArrayLike | None, rates: ArrayLike | None) -> Array:
        """Return all readings in one array, (M + G,); what was not given is NaN."""
        return np.concatenate([
            _sized(readings, self.columns, "readings"), _sized(rates, self.gyro_columns, "rates")
        ])  # fmt: skip

    def tell(self, q: Array, dq: Array, inertial: Array) -> Told:
        """Return what the sensors tell at a pose (n,) rad and a speed (n,) rad/s."""
        first = len(self.columns)
        solved = self._sensors.solve(q, dq, inertial[:first])
        rate, status = dq, solved.status
        if self.gyro_columns:
            # What gyroscopes do not tell stays as observed: it corrects nothing.
            rate = self._sensors.rates(q, inertial[first:], prior=dq).motion
        return Told(solved.motion, rate, self._coupling @ solved.motion, self.determined, status)

    def rest(self, theta: Array, setpoint: Array) -> Array:
        """Return the links' positions at rest, (n,) rad; where that is not known, the motors'.

        Args:
            theta: (n,) rad, motors, from the springs' zeros.
            setpoint: (n,) in the laws' units.
        """
        return _at_rest(self._robot, self._joints, theta, setpoint)


class OwnLinks:
    """Each link's own acceleration, measured at its joint (deluca2007 section III).

    Args:
        device: joints, each on its own.
    """

    columns: tuple[str, ...]
    gyro_columns: tuple[str, ...] = ()

    def __init__(self, device: Device) -> None:
        self._joints = device.joints
        self.columns = tuple(f"{joint.name}.acc" for joint in device.joints)
        n = self.readings = len(device.joints)
        self.determined, self.gyro_determined = np.ones(n, dtype=bool), np.zeros(n, dtype=bool)
        own = device.robot
        self._coupling = np.zeros((n, n)) if own is None else own.coupling_matrix.T
        self._arm = device.build_robot()
        self._pendulums = [
            Pendulum(joint.link.inertia.value, joint.link.gravity_torque)
            if joint.link is not None and joint.link.inertia is not None
            else None
            for joint in device.joints
        ]

    def joined(self, readings: ArrayLike | None, rates: ArrayLike | None) -> Array:
        """Return the accelerations, (n,); there are no gyroscopes."""
        if rates is not None and np.size(rates):
            raise MethodError("no gyroscopes are used where links' accelerations are measured",
                              where="rates", value=int(np.size(rates)), allowed="none")  # fmt: skip
        return _sized(readings, self.columns, "readings")

    def tell(self, q: Array, dq: Array, inertial: Array) -> Told:
        """Return the accelerations; what is missing is taken for 0 and said."""
        seen = np.isfinite(inertial)
        acceleration = np.where(seen, inertial, 0.0)
        status = np.where(seen, 0, UNSEEN | NOT_FINITE)
        return Told(acceleration, dq, self._coupling @ acceleration, seen, status)

    def rest(self, theta: Array, setpoint: Array) -> Array:
        """Return the links' positions at rest, as `ArmLinks.rest`; of a pendulum for each joint."""
        if self._arm is not None:
            return _at_rest(self._arm, self._joints, theta, setpoint)
        q = theta.copy()
        for i, pendulum in enumerate(self._pendulums):
            if pendulum is not None:
                here = slice(i, i + 1)
                q[here] = _at_rest(pendulum, self._joints[here], theta[here], setpoint[here])
        return q


Links = ArmLinks | OwnLinks


def links_of(
    device: Device,
    source: str | None,
    noise: Mapping[str, float] | None,
    *,
    gyroscopes: bool = True,
) -> Links:
    """Return where a device's link accelerations come from.

    Args:
        device: with accelerometers on an arm, or joints whose links' accelerations are measured.
        source: one of `SOURCES`; None: accelerometers where it has any.
        noise, gyroscopes: of its sensors, as `ArmLinks`.

    Raises:
        MethodError: no such source, or accelerometers are asked for where there are none.
    """
    if source is not None:
        check_names(
            [source], SOURCES, what="no such source of accelerations", where="accelerations"
        )
    if source == "accelerometers" and not device.accelerometers:
        raise MethodError(
            "the device has no accelerometer",
            where=device.source,
            hint="Describe them in tables [[accelerometer]].",
        )
    if source == "joints" or not device.accelerometers:
        return OwnLinks(device)
    return ArmLinks(device, noise, gyroscopes)


def _sized(given: ArrayLike | None, columns: tuple[str, ...], name: str) -> Array:
    """Return one number for each column; NaN where nothing was given."""
    if given is None:
        return np.full(len(columns), np.nan)
    found = np.asarray(given, dtype=np.float64)
    if found.shape != (len(columns),):
        raise MethodError("every reading needs a number", where=name, value=found.shape,
                          allowed=columns)  # fmt: skip
    return found


def _at_rest(robot: Robot, joints: Sequence[Joint], theta: Array, setpoint: Array) -> Array:
    """Return the links at rest where that is certain, else the motors."""
    found = links_at_rest(robot, joints, theta, setpoint=setpoint)
    return found.q if found.trustworthy else theta.copy()
