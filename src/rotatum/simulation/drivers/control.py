"""Position control of a motor: an honest inner loop, looking at the true motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.compensation import GravityCompensation
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.drivers.fields import refuse_infinite, refuse_not_positive
from rotatum.simulation.drivers.paths import Path
from rotatum.simulation.drivers.waves import Drive

__all__ = ["Gains", "PositionControl", "SampledControl"]

Array = NDArray[np.float64]
# D T / B below which three terms of its series are better than (x - (1 - exp(-x))) / x^2
_SERIES = 1e-3
_HALVINGS = 30


@dataclass(frozen=True)
class Gains:
    """Gains of a position controller, at the joint side."""

    kp: float  # [N m/rad]
    kd: float  # [N m s/rad]

    def __post_init__(self) -> None:
        """Raise `RotatumError` for gains that are negative or not finite."""
        refuse_infinite("gains", kp=self.kp, kd=self.kd)
        for name, gain in (("kp", self.kp), ("kd", self.kd)):
            if gain < 0.0:
                raise RotatumError("must not be negative", where=f"gains.{name}", value=gain)

    @classmethod
    def of_bandwidth(cls, inertia: float, bandwidth: float, damping: float = 1.0) -> Gains:
        """Return ``Kp = B w^2``, ``Kd = 2 zeta B w``: the rotor alone then swings at w.

        The spring pulls as ever: at rest under an elastic torque t the motor stands t / Kp off.

        Parameters
        ----------
        inertia
            B, of the rotor at the joint [kg m^2].
        bandwidth
            w [rad/s].
        damping
            zeta; 1: no overshoot.
        """
        refuse_not_positive("position", inertia=inertia, bandwidth=bandwidth, damping=damping)
        return cls(inertia * bandwidth**2, 2.0 * damping * inertia * bandwidth)

    def keep_steady(self, inertia: float, friction: float, period: float) -> bool:
        """Return whether a rotor stays where it is told with torques held over the period.

        Jury's criterion for ``B theta'' + D theta' = -Kp theta - Kd theta'`` with the right side
        held over T; without friction ``Kd T < 2 B`` and ``Kp T < 2 Kd``.

        Parameters
        ----------
        inertia, friction
            B [kg m^2] and D [N m s/rad].
        period
            T [s].
        """
        decay = friction / inertia * period
        # of the velocity: what friction takes, and how far it still carries
        fall = -math.expm1(-decay)
        drift = period * (fall / decay if decay > 0.0 else 1.0)
        # of a unit torque: the velocity it leaves, and how far it moves
        push = drift / inertia
        if decay > _SERIES:
            share = (decay - fall) / decay**2
        else:
            share = 0.5 - decay / 6.0 + decay**2 / 24.0
        shift = share * period**2 / inertia
        kept = 1.0 - fall
        swing = push * self.kd + fall - self.kp * (push * drift - shift * kept)
        flip = 2.0 * (1.0 + kept - push * self.kd)
        flip -= self.kp * (shift * (1.0 + kept) - push * drift)
        return swing >= 0.0 and flip > 0.0

    def longest_period(self, inertia: float, friction: float, within: float) -> float:
        """Return the longest period [s] up to `within` that keeps a rotor steady; 0: none does."""
        low, high = 0.0, within
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if self.keep_steady(inertia, friction, middle):
                low = middle
            else:
                high = middle
        return low


@dataclass(frozen=True)
class PositionControl:
    """A motor's position controller with what is known of its load fed forward.

    ``tau = Kp (theta_d - theta) + Kd (theta_d' - theta') + J theta_d'' + f(t) + share g_i``

    It sees the true state, without sensors: what moves the joint, not what is to be found out.

    Parameters
    ----------
    joint, motor
        Whose motor, and which of its motors.
    path
        theta_d [rad], joint side.
    gains
        Kp, Kd.
    inertia
        J [kg m^2], fed forward; the rotor's own, usually.
    feedforward
        f [N m], a function of time; None: nothing.
    gravity
        Of all joints; None: not compensated.
    index
        i, the joint's place among them.
    share
        Of the joint's gravity torque: a half for each of two motors.
    """

    joint: str
    path: Path
    gains: Gains
    motor: int = 0
    inertia: float = 0.0
    feedforward: Drive | None = None
    gravity: GravityCompensation | None = None
    index: int = 0
    share: float = 1.0

    def torque(self, seen: Seen) -> float:
        """Return the torque [N m] at the joint side."""
        return self.sampled(np.array([seen.time])).torque(seen)

    def sampled(self, time: Array) -> SampledControl:
        """Return the controller with its commands worked out for evenly spaced instants (N,) [s].

        Raises `RotatumError` for commands that are not finite numbers.
        """
        position, velocity = self.path.position(time), self.path.velocity(time)
        forward = self.inertia * self.path.acceleration(time)
        if self.feedforward is not None:
            forward = forward + self.feedforward(time)
        commands = (position, velocity, forward)
        if any(x.shape != time.shape or not np.all(np.isfinite(x)) for x in commands):
            raise RotatumError(
                "position, velocity and feedforward must be one finite number for each instant",
                where=f"{self.joint}, motor {self.motor + 1}",
                allowed=f"shape {time.shape}",
            )
        return SampledControl(self, time, position, velocity, forward)


@dataclass(frozen=True, eq=False)
class SampledControl:
    """A position controller at its control instants; in between, the nearest one's commands.

    Parameters
    ----------
    control
        The law.
    time
        (N,) s, evenly spaced.
    position, velocity, forward
        (N,) rad, rad/s and N m, desired there.
    """

    control: PositionControl
    time: Array
    position: Array
    velocity: Array
    forward: Array

    def torque(self, seen: Seen) -> float:
        """Return the torque [N m] at the joint side."""
        k, law = self._row(seen.time), self.control
        error = self.position.item(k) - seen.theta[law.joint].item(law.motor)
        slip = self.velocity.item(k) - seen.dtheta[law.joint].item(law.motor)
        tau = law.gains.kp * error + law.gains.kd * slip + self.forward.item(k)
        if law.gravity is not None:
            tau += law.share * law.gravity.torques(seen).item(law.index)
        return tau

    def _row(self, time: float) -> int:
        if self.time.size == 1:
            return 0
        start = self.time.item(0)
        nearest = round((time - start) / (self.time.item(1) - start))
        return min(max(nearest, 0), self.time.size - 1)
