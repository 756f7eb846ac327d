"""Sensors read in the simulator's loop: what a controller gets instead of the truth."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.sensing.channel import Channel
from rotatum.simulation.sensing.inertial import (
    InertialFaults,
    Links,
    arm_under,
    check_inertial,
    inertial_units,
)
from rotatum.simulation.sensing.joint_log import encoder_counts
from rotatum.simulation.sensing.sensors import Sensors

if TYPE_CHECKING:
    from rotatum.models.device import Device

__all__ = ["LiveSensors", "Readings"]

Array = NDArray[np.float64]

# Of the channels a log has: those that feedback sees.
_ANGLES = {"series": ("theta",), "antagonistic": ("theta1", "theta2"), "serial": ("theta",)}
_TORQUES = {"series": ("tau",), "antagonistic": ("tau1", "tau2"), "serial": ("tau",)}
# Drawn over a whole log, or of its rows: a loop has neither.
_OF_LOGS = (
    "stale", "nans", "repeats", "dropouts", "delay_jitter", "stuck", "jitter", "clock_rate",
)  # fmt: skip


@dataclass(frozen=True)
class Readings:
    """What the sensors of a device show at an instant.

    Attributes
    ----------
    time
        s.
    joints
        role -> (n,) rad and N m, in the device's order: "q", "theta" ("theta1", "theta2") and the
        torques that acted until now, "tau" ("tau1", "tau2"); nan for joints without the role.
    acc, gyro
        (A,) m/s^2 and (G,) rad/s: axes of the accelerometers and gyroscopes, in the device's order.
    """

    time: float
    joints: Mapping[str, Array]
    acc: Array
    gyro: Array

    @property
    def theta(self) -> Array:
        """Motor positions of joints with one motor, (n,) rad."""
        return self.joints["theta"]

    @property
    def tau(self) -> Array:
        """Torques that acted on them until now, (n,) N m."""
        return self.joints["tau"]


class LiveSensors:
    """The sensors of a device, read once an instant of the simulator's loop.

    Readings have the faults a log would have, drawn from the same streams: with the same seed and
    period encoders show to the bit what a log of the run has, and inertial sensors that up to the
    accelerations, which a log takes just after each instant and these just before. Torques are
    those that acted until now: the log's of the row before.

    Parameters
    ----------
    device
        Says which sensors there are.
    sensors
        Joint -> faults; none but the device's encoder counts where not given.
    inertial
        Accelerometer or gyroscope -> faults.
    seed
        Of all noise.
    period
        Between two readings [s]; delays are whole multiples of it.

    Raises `RotatumError` for joints, sensors or channels that are not there, for faults of whole
    rows or logs (stale, nans, stuck, jitter, ...), and for delays of broken periods; `DeviceError`
    for a frame the arm does not have.
    """

    def __init__(
        self,
        device: Device,
        sensors: Mapping[str, Sensors] | None = None,
        inertial: Mapping[str, InertialFaults] | None = None,
        *,
        seed: int = 0,
        period: float,
    ) -> None:
        given, faults = dict(sensors or {}), dict(inertial or {})
        names = tuple(joint.name for joint in device.joints)
        check_names(given, names, what="the device has no such joint", where="sensors")
        check_inertial(device, faults)
        self._channels = [
            channel
            for place in range(len(names))
            for channel in _joint_channels(device, place, given, seed, period)
        ]
        self._size = len(names)
        self._units = [
            (unit, _whole(unit.faults.delay, period, f"inertial.{unit.sensor.name}.delay"))
            for unit in inertial_units(device, faults, seed=seed)
        ]
        self._robot = arm_under(device, device.build_robot()) if self._units else None
        self._roles = tuple(dict.fromkeys(channel.role for channel in self._channels))
        delays = [channel.delay for channel in self._channels] + [late for _, late in self._units]
        self._past = _Past(max(delays))
        self._seen: Seen | None = None
        self._readings: Readings | None = None

    def read(self, seen: Seen) -> Readings:
        """Return what the sensors show; asked again at the same instant, the same."""
        if self._readings is None or seen is not self._seen:
            self._past.add(seen)
            self._seen, self._readings = seen, self._look(seen.time)
        return self._readings

    def _look(self, time: float) -> Readings:
        joints = {role: np.full(self._size, np.nan) for role in self._roles}
        for channel in self._channels:
            then = self._past.before(channel.delay)
            joints[channel.role][channel.place] = channel.shown(then)
        felt: dict[str, list[Array]] = {"a": [np.empty(0)], "g": [np.empty(0)]}
        for unit, late in self._units:
            then = self._past.before(late)
            links = Links(then.q[np.newaxis], then.dq[np.newaxis], then.ddq[np.newaxis])
            assert self._robot is not None  # it was built for the units
            felt[unit.letter].append(unit.show(self._robot, links)[0])
        return Readings(time, joints, np.concatenate(felt["a"]), np.concatenate(felt["g"]))


@dataclass(frozen=True)
class _JointChannel:
    """A channel, the place of its joint and of its motor, and by how many readings it is late."""

    channel: Channel
    joint: str
    place: int
    motor: int
    delay: int

    @property
    def role(self) -> str:
        return self.channel.role

    def shown(self, then: Seen) -> float:
        """Return its reading of that instant [rad, N m]."""
        if self.role == "q":
            true = then.q[self.place]
        else:
            of = then.tau if self.role in _TORQUE_ROLES else then.theta
            true = of[self.joint][self.motor]
        return self.channel.show(np.array([true])).item()


_TORQUE_ROLES = {role for roles in _TORQUES.values() for role in roles}


def _joint_channels(
    device: Device, place: int, given: Mapping[str, Sensors], seed: int, period: float
) -> list[_JointChannel]:
    joint = device.joints[place]
    sensors = given.get(joint.name, Sensors())
    sensors.fit(joint.actuation)
    for fault in _OF_LOGS:
        if getattr(sensors, fault):
            raise RotatumError(
                "a fault of whole logs or of their rows; a loop reads live",
                where=f"{joint.name}, sensors.{fault}",
                value=getattr(sensors, fault),
            )
    counts = encoder_counts(joint, sensors)
    angles, torques = _ANGLES[joint.actuation], _TORQUES[joint.actuation]
    channels = []
    for motor, role in [(0, "q"), *enumerate(angles), *enumerate(torques)]:
        channel = Channel(
            role,
            sensors,
            counts=counts.get(role),
            of_motor=role in angles,
            seed=seed,
            number=place,
        )
        where = f"{joint.name}, sensors.delay.{role}"
        late = _whole(sensors.delay.get(role, 0.0), period, where)
        channels.append(_JointChannel(channel, joint.name, place, motor, late))
    return channels


def _whole(seconds: float, period: float, where: str) -> int:
    """Return a delay in periods; raise `RotatumError` unless it is a whole number of them."""
    late = round(seconds / period)
    if abs(seconds - late * period) > 1e-9 * max(seconds, period):
        allowed = f"multiples of the period, {period:g} s"
        what = "sensors in the loop are late by whole periods"
        raise RotatumError(what, where=where, value=seconds, allowed=allowed)
    return late


class _Past:
    """What was seen at the last instants; before the first one the device stood where it starts."""

    def __init__(self, most: int) -> None:
        self._seen: deque[Seen] = deque(maxlen=most + 1)
        self._start: Seen | None = None

    def add(self, seen: Seen) -> None:
        """Keep an instant."""
        angles = {name: x.copy() for name, x in seen.theta.items()}
        torques = {name: x.copy() for name, x in seen.tau.items()}
        if self._start is None:
            still, idle = np.zeros_like(seen.q), {name: 0.0 * x for name, x in torques.items()}
            q = seen.q.copy()
            self._start = Seen(seen.time, q, still, angles, {}, still, idle)
        now = Seen(seen.time, seen.q.copy(), seen.dq.copy(), angles, {}, seen.ddq.copy(), torques)
        self._seen.append(now)

    def before(self, readings: int) -> Seen:
        """Return what was there so many readings ago."""
        if readings < len(self._seen):
            return self._seen[-1 - readings]
        assert self._start is not None  # something was added before it is asked
        return self._start
