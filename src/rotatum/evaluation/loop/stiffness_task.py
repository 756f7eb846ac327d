"""What an antagonistic joint in a closed loop is to do: swings of position and stiffness."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.polynomial import Polynomial

from rotatum.control.decoupling import Target
from rotatum.control.motor_position import MotorMotion
from rotatum.control.trajectory import blend
from rotatum.errors import RotatumError

__all__ = ["CALM", "STAND", "Excitation", "StiffnessTask", "Swing"]

Derivatives = tuple[float, ...]
STAND = 0.1
"""Seconds at rest at the start of a run, in which an estimator reads where the springs relax."""

CALM = 1.0
"""Seconds in which an excitation dies away before the decoupling law may take over."""

_RISE = [blend(5).deriv(order) if order else blend(5) for order in range(5)]


@dataclass(frozen=True)
class Swing:
    """``middle + amplitude sin(2 pi frequency t + phase)``; Hz, and rad or N m/rad."""

    middle: float
    amplitude: float
    frequency: float
    phase: float = 0.0

    def derivatives(self, time: float, most: int) -> Derivatives:
        """Return it without its middle, and its derivatives to the order `most`."""
        w = 2.0 * math.pi * self.frequency
        at = w * time + self.phase
        return tuple(
            self.amplitude * w**order * math.sin(at + 0.5 * math.pi * order)
            for order in range(most + 1)
        )


@dataclass(frozen=True)
class Excitation:
    """Motions of the motors that tell their springs: two sines each, beside `home`.

    Attributes
    ----------
    home : (2,) rad, co-contracted.
    amplitude : of each sine [rad].
    frequencies : ((2,), (2,)) Hz, agonist's and antagonist's.
    """

    home: tuple[float, float]
    amplitude: float
    frequencies: tuple[tuple[float, float], tuple[float, float]]

    def at(self, time: float, still: float | None = None) -> MotorMotion:
        """Return it at a time [s].

        All stands for `STAND`, then the motors go home and the sines grow, in a second each; with
        `still` they die away in `CALM` before it.
        """
        go, speed = smooth(time, STAND, 1.0, 1)
        size, rate = smooth(time, STAND + 1.0, 1.0, 1)
        if still is not None:
            fall, decay = smooth(time, still - CALM, CALM, 1)
            size, rate = size - fall, rate - decay
        position, velocity = [], []
        for home, pair in zip(self.home, self.frequencies, strict=True):
            x = self.amplitude * sum(math.sin(2.0 * math.pi * f * time) for f in pair)
            v = sum(2.0 * math.pi * f * math.cos(2.0 * math.pi * f * time) for f in pair)
            position.append(go * home + size * x)
            velocity.append(speed * home + rate * x + size * self.amplitude * v)
        return MotorMotion((position[0], position[1]), (velocity[0], velocity[1]))


@dataclass(frozen=True)
class StiffnessTask:
    """An excitation, then swings that begin where the joint is, and a spell of rest among them.

    Times but `excite` count from the hand-over to the decoupling law.

    Attributes
    ----------
    excitation : until the hand-over.
    position, stiffness : what link and total stiffness are to do [rad, N m/rad].
    excite : the hand-over is not before this time of the run [s].
    approach : the references go from where the joint is to the swings' middles meanwhile, and the
        swings grow as long after [s].
    rest : begin and end of the spell in which both references stand [s]; the swings die away and
        come back in an `approach` each, within it.
    """

    excitation: Excitation
    position: Swing
    stiffness: Swing
    excite: float = 4.0
    approach: float = 1.0
    rest: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        """Refuse a rest with no room to come to it and from it."""
        if self.rest is not None and self.rest[1] - self.rest[0] < 2.0 * self.approach:
            what = "a rest needs room for the swings to die away and to come back"
            raise RotatumError(what, where="task.rest", value=self.rest)

    @property
    def settled(self) -> float:
        """From when on both references are the swings [s]."""
        return 2.0 * self.approach

    @property
    def standstill(self) -> tuple[float, float] | None:
        """When nothing moves [s]."""
        if self.rest is None:
            return None
        return self.rest[0] + self.approach, self.rest[1] - self.approach

    def target(self, time: float, q: float, sigma: float) -> Target:
        """Return the references.

        Parameters
        ----------
        time
            Since the hand-over [s].
        q, sigma
            Where the joint was then [rad, N m/rad].
        """
        return Target(
            self._reference(self.position, q, time, 4),
            self._reference(self.stiffness, sigma, time, 2),
        )

    def _reference(self, swing: Swing, start: float, time: float, most: int) -> Derivatives:
        come = smooth(time, 0.0, self.approach, most)
        size = list(smooth(time, self.approach, self.approach, most))
        if self.rest is not None:
            down = smooth(time, self.rest[0], self.approach, most)
            up = smooth(time, self.rest[1] - self.approach, self.approach, most)
            size = [a - b + c for a, b, c in zip(size, down, up, strict=True)]
        wave = swing.derivatives(time, most)
        found = [
            (swing.middle - start) * come[n]
            + sum(comb(n, k) * size[k] * wave[n - k] for k in range(n + 1))
            for n in range(most + 1)
        ]
        return (start + found[0], *found[1:])


def smooth(time: float, begin: float, seconds: float, most: int) -> Derivatives:
    """Return a rise from 0 to 1 and its derivatives; smooth to the fifth."""
    u = (time - begin) / seconds - 0.5
    if abs(u) >= 0.5:
        return (float(u > 0.0), *(0.0,) * most)
    return tuple(_value(_RISE[n], u) / seconds**n for n in range(most + 1))


def _value(x: Polynomial, at: float) -> float:
    return float(np.polynomial.polynomial.polyval(at, x.coef))
