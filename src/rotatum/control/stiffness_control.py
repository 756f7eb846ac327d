"""Position and stiffness on an estimate: the decoupling law while it may, else motor positions."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.control.antagonistic_joint import JointState
from rotatum.control.decoupling import Decoupled, DecouplingLaw, Target
from rotatum.control.motor_position import MotorMotion, MotorPosition
from rotatum.control.preset import preset
from rotatum.control.switching import (
    ASTRAY,
    BLIND,
    LIMITED,
    SINGULAR,
    UNTRUSTED,
    Switching,
)
from rotatum.models.elastic import ElasticLaw

__all__ = ["Command", "StiffnessControl"]

Array = NDArray[np.float64]
Laws = tuple[ElasticLaw, ElasticLaw]


class Command(NamedTuple):
    """What the controller says at an instant.

    Parameters
    ----------
    torques : (2,) at the joint side, within the motors' limits [N m].
    decoupled : whether they are the decoupling law's; False: motor position control.
    flags : of `rotatum.control.switching`; set whichever law is in charge.
    motors : (2,) positions the motors are told in motor position control, nan else [rad].
    """

    torques: Array
    decoupled: bool
    flags: int
    motors: tuple[float, float]


@dataclass
class StiffnessControl:
    """One joint's controller: the decoupling law, and motor position control when it must not act.

    Position control follows `search` until there has been a law to trust; from then on it goes to
    the preset of the last trusted law for the target's q_d and sigma_d (`preset`), as if all stood,
    on the side of the singularity where it was. A switch never jumps: the difference of the torques
    at that instant is added to the new law's and dies away. It is a loop's part: it raises nothing,
    and keeps the torques before where it is blind.

    Attributes
    ----------
    law : input-output linearisation.
    motor : position control.
    period : between two calls [s].
    switching : when to change.
    """

    law: DecouplingLaw
    motor: MotorPosition
    period: float
    switching: Switching = field(default_factory=Switching)

    def __post_init__(self) -> None:
        """Begin in position control, with no law trusted yet."""
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._side = 0.0  # sign of the steerability where the first trusted law was; 0: none yet
        self._decoupled = False
        self._trusted: Laws | None = None
        self._steerable = False
        self._well = 0.0  # seconds
        self._limited = 0.0  # seconds
        self._motors = (0.0, 0.0)
        self._deflections = (0.0, 0.0)
        self._torques = np.zeros(2)
        self._jump = np.zeros(2)

    def step(
        self,
        state: JointState,
        laws: Laws,
        target: Target,
        *,
        trusted: bool,
        search: MotorMotion | None = None,
    ) -> Command:
        """Return the torques of now, to be held for a period.

        Parameters
        ----------
        state
            Where the joint is.
        laws
            Of both transmissions, as known now.
        target
            What position and stiffness are to do.
        trusted
            Whether the estimate behind `laws` is one to build on.
        search
            Of the motors, before there has been a law to trust; None: they stay.
        """
        if not state.finite:
            self._well = 0.0
            return Command(self._torques, self._decoupled, BLIND, (math.nan, math.nan))
        x, y = state.deflections
        says = self.law.torques(state, (laws[0].evaluate(x), laws[1].evaluate(y)), target)
        flags = self._judge(says, trusted)
        if abs(target.q[0] - state.q) > self.switching.astray:
            flags |= ASTRAY
        before = self._decoupled
        if before:
            self._motors = state.theta
        if self._steerable and (before or self._trusted is None):
            # position control looks for its preset from here: on the same side of the singularity
            self._deflections = x, y
        if trusted and not flags & BLIND:
            self._trusted = laws
        self._choose(flags)
        fresh = says.wanted if self._decoupled else self._position(state, target, search)
        if before != self._decoupled:
            self._jump = self._torques - fresh
        return self._give(fresh, flags)

    def _judge(self, says: Decoupled, trusted: bool) -> int:
        """Return the flags of now; steerability has a hysteresis."""
        s = self.switching
        least = s.low if self._steerable else s.high
        if trusted and self._side == 0.0 and abs(says.steerability) > s.high:
            self._side = math.copysign(1.0, says.steerability)
        self._steerable = self._side * says.steerability > least
        flags = (0 if trusted else UNTRUSTED) | (0 if self._steerable else SINGULAR)
        if not np.all(np.isfinite(says.wanted)):
            return flags | BLIND
        asked = says.wanted + self._jump if self._decoupled else says.wanted
        over = bool(np.any(np.abs(asked) > np.array(self.law.joint.limits)))
        return flags | (LIMITED if over else 0)

    def _choose(self, flags: int) -> None:
        """Decide which law is in charge."""
        s, T = self.switching, self.period
        # a whole number of periods is not one in floating point
        slack = 0.5 * T
        self._limited = self._limited + T if flags & LIMITED else 0.0
        self._well = 0.0 if flags else self._well + T
        if self._decoupled:
            bad = (
                flags & (UNTRUSTED | SINGULAR | ASTRAY | BLIND)
                or self._limited > s.patience + slack
            )
            self._decoupled = not bad
        elif self._well > s.wait - slack:
            self._decoupled = True

    def _position(self, state: JointState, target: Target, search: MotorMotion | None) -> Array:
        """Return motor position control's torques, its set-points on the way to the preset."""
        if self._trusted is None:
            to = search or MotorMotion(self._motors)
            self._motors = to.position
            return self.motor.torques(state, to)
        load = -self.law.joint.gravity_torque * math.sin(target.q[0])
        found = preset(self._trusted, load, target.sigma[0], self._deflections, self.law.reach)
        self._deflections = found or self._deflections
        x, y = self._deflections
        a, b = self._trusted
        first_spring, second_spring = a.evaluate(x), b.evaluate(y)
        held = (
            -first_spring.torque - first_spring.offset,
            -second_spring.torque - second_spring.offset,
        )
        fade = self.switching.fade
        share = -math.expm1(-self.period / fade)
        # where they are to go, less where they are told to be
        first = target.q[0] - x - self._motors[0]
        second = target.q[0] - y - self._motors[1]
        self._motors = self._motors[0] + share * first, self._motors[1] + share * second
        to = MotorMotion(self._motors, (first / fade, second / fade))
        return self.motor.torques(state, to, held)

    def _give(self, fresh: Array, flags: int) -> Command:
        limits = np.array(self.law.joint.limits)
        torques = np.clip(fresh + self._jump, -limits, limits)
        self._jump = self._jump * math.exp(-self.period / self.switching.fade)
        self._torques = torques
        motors = (math.nan, math.nan) if self._decoupled else self._motors
        return Command(torques, self._decoupled, flags, motors)
