"""One rigid link under gravity."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.plane import PlanarArm, PlanarBody, Spot

__all__ = ["Pendulum"]

Array = NDArray[np.float64]

_STANDARD_GRAVITY = 9.81


class Pendulum(PlanarArm):
    """A link on one joint: ``M q'' + G sin q = tau``, q = 0 hanging down.

    Frames "link", on the joint's axis, and "tip", `length` away; axes as in `PlanarArm`.

    Parameters
    ----------
    inertia : kg m^2, about the joint.
    gravity_torque : N m, G.
    length : m, from the joint to the tip.
    gravity : m/s^2, what a payload weighs by and an accelerometer feels.
    name : of the joint.

    Raises
    ------
    DeviceError for an inertia that is not positive, or a torque without gravity.
    """

    def __init__(
        self,
        inertia: float,
        gravity_torque: float = 0.0,
        length: float = 0.0,
        *,
        gravity: float = _STANDARD_GRAVITY,
        name: str = "joint",
    ) -> None:
        if not (np.isfinite(inertia) and inertia > 0.0):
            raise DeviceError("inertia must be greater than 0", where="pendulum", value=inertia)
        if not np.isfinite(gravity_torque) or (gravity_torque != 0.0 and gravity == 0.0):
            what = "gravity_torque must be a number, and 0 where there is no gravity"
            raise DeviceError(what, where="pendulum", value=gravity_torque)
        self._settle((name,), (length,), {"link": Spot(0, 0.0), "tip": Spot(0, length)}, gravity)
        along = gravity_torque / gravity if gravity_torque else 0.0
        # The mass alone is nowhere felt: a pendulum's axis does not move.
        self.bodies = (PlanarBody(0.0, along, 0.0, float(inertia)),)

    def _with_bodies(self, bodies: tuple[PlanarBody, ...]) -> Pendulum:
        arm = Pendulum(1.0, 0.0, self.lengths[0], gravity=self.field, name=self.names[0])
        arm.bodies = bodies
        return arm

    def mass(self, q: Array) -> Array:
        """Return M, (1, 1) kg m^2."""
        return np.array([[self.bodies[0].inertia]])

    def coriolis(self, q: Array, dq: Array) -> Array:
        """Return C = 0, (1, 1) N m s/rad."""
        return np.zeros((1, 1))

    def _coriolis_matrix_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        return np.zeros((1, 1))

    def gravity(self, q: Array) -> Array:
        """Return g(q), (1,) N m."""
        return np.array([self._torque(float(q[0]))])

    def gravity_gradient(self, q: Array) -> Array:
        """Return dg/dq, (1, 1) N m/rad."""
        body, angle = self.bodies[0], float(q[0])
        return np.array([[self.field * (body.along * cos(angle) - body.across * sin(angle))]])

    def accelerate(self, q: Array, dq: Array, torque: Array) -> Array:
        """Return q'' = (torque - g) / M, (1,) rad/s^2."""
        return np.array([(float(torque[0]) - self._torque(float(q[0]))) / self.bodies[0].inertia])

    def _torque(self, angle: float) -> float:
        body = self.bodies[0]
        return self.field * (body.along * sin(angle) + body.across * cos(angle))
