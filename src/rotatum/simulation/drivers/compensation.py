"""Gravity as a controller reckons it, to be held by the motors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, nearest
from rotatum.simulation.drivers.feedback import Seen

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["GravityCompensation", "Pendulums", "Weighty", "gravity_of"]

Array = NDArray[np.float64]
AT = ("link", "motor")


class Weighty(Protocol):
    """Anything that knows its gravity torques, as `rotatum.models.robot.interface.Robot` does."""

    def gravity(self, q: Array, /) -> Array:
        """Return g(q), (n,) N m, of positions (n,) rad."""


@dataclass(frozen=True)
class Pendulums:
    """Links that hang each on its own: ``g_i = G_i sin(q_i)``, q = 0 hanging down."""

    torques: tuple[float, ...]  # (n,) G [N m]

    def gravity(self, q: Array) -> Array:
        """Return g(q), (n,) N m."""
        held: Array = np.asarray(self.torques) * np.sin(q)
        return held


@dataclass(eq=False)
class GravityCompensation:
    """Gravity torques of all joints, reckoned once an instant however many motors ask.

    Parameters
    ----------
    arm
        What weighs.
    joints
        Names, in the order of the device.
    at
        The angles it is reckoned at: "link", g(q), or "motor", g(theta), of two motors their mean
        (a controller without link encoders).
    """

    arm: Weighty
    joints: tuple[str, ...]
    at: str = "link"
    _seen: Seen | None = field(default=None, init=False, repr=False)
    _torques: Array = field(default_factory=lambda: np.empty(0), init=False, repr=False)

    def __post_init__(self) -> None:
        """Raise `RotatumError` for an unknown place."""
        if self.at not in AT:
            close = nearest(self.at, AT)
            hint = f"Did you mean {close!r}?" if close else None
            raise RotatumError(
                "gravity is compensated at the link's or the motor's angle",
                where="gravity",
                value=self.at,
                allowed=AT,
                hint=hint,
            )

    def torques(self, seen: Seen) -> Array:
        """Return g, (n,) N m at the joints."""
        if seen is not self._seen:
            self._torques = self.arm.gravity(self._angles(seen))
            self._seen = seen
        return self._torques

    def _angles(self, seen: Seen) -> Array:
        if self.at == "link":
            return seen.q
        return np.array([float(np.mean(seen.theta[name])) for name in self.joints])


def gravity_of(
    joints: Sequence[Joint], robot: Weighty | None = None, *, at: str = "link"
) -> GravityCompensation:
    """Return the gravity compensation of a device.

    Parameters
    ----------
    joints
        Of the device, in its order.
    robot
        The arm; None: each link is a pendulum, by its `gravity_torque`.
    at
        As in `GravityCompensation`.
    """
    pendulums = Pendulums(tuple(j.link.gravity_torque if j.link else 0.0 for j in joints))
    names = tuple(joint.name for joint in joints)
    return GravityCompensation(pendulums if robot is None else robot, names, at)
