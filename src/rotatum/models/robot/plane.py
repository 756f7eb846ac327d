"""Arms in a vertical plane: what a pendulum and a planar 2R share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from math import cos, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.interface import FrameMotion, Pose, Robot
from rotatum.models.robot.names import no_such
from rotatum.models.robot.payload import Payload

__all__ = ["PlanarArm", "PlanarBody", "Spot"]

Array = NDArray[np.float64]


class PlanarBody(NamedTuple):
    """What of a link matters in the plane.

    Parameters
    ----------
    mass : kg.
    along : kg m, first moment along the link, away from its joint.
    across : kg m, first moment in the direction of a growing angle.
    inertia : kg m^2, about its joint.
    """

    mass: float
    along: float
    across: float
    inertia: float

    def with_point(self, mass: float, along: float, across: float, own: float) -> PlanarBody:
        """Return the body with a mass [kg] at a place [m], of an inertia [kg m^2] of its own."""
        return PlanarBody(
            self.mass + mass,
            self.along + mass * along,
            self.across + mass * across,
            self.inertia + mass * (along * along + across * across) + own,
        )


class Spot(NamedTuple):
    """Where a frame sits: on which link, and how far from its joint along it [m]."""

    link: int
    distance: float


class PlanarArm(Robot):
    """A chain of links in the plane of the world's x and z, z up, turning about -y.

    At ``q = 0`` it hangs down along gravity; a positive angle takes it towards +x; each further
    angle is relative to the link before. Link i points along ``u = (sin s, 0, -cos s)`` with
    ``s = q1 + ... + qi``. The axes of all frames are the world's at ``q = 0``: the link points
    along its -z.

    Attributes
    ----------
    bodies : of the links, from the base on.
    lengths : m, from joint to joint, the last to the tip.
    field : m/s^2, acceleration of gravity; 0: none.
    """

    bodies: tuple[PlanarBody, ...]
    lengths: tuple[float, ...]
    field: float
    _spots: dict[str, Spot]

    def _settle(
        self, names: Sequence[str], lengths: Sequence[float], spots: dict[str, Spot], field: float
    ) -> None:
        """Keep what does not depend on masses."""
        for length in lengths:
            if not (np.isfinite(length) and length >= 0.0):
                raise DeviceError("length of a link must be at least 0", value=length)
        if not (np.isfinite(field) and field >= 0.0):
            raise DeviceError("gravity must be at least 0", value=field)
        self.names, self.lengths = tuple(names), tuple(map(float, lengths))
        self.frames, self._spots = tuple(spots), spots
        self.field = float(field)
        self.gravity_vector = np.array([0.0, 0.0, -self.field])

    @abstractmethod
    def _with_bodies(self, bodies: tuple[PlanarBody, ...]) -> Robot:
        """Return the arm with other masses."""

    @abstractmethod
    def _coriolis_matrix_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return dC/dt along the motion, (n, n)."""

    def bias(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') q' + g(q), (n,) N m."""
        return self.coriolis(q, dq) @ dq + self.gravity(q)

    def coriolis_transposed(self, q: Array, dq: Array) -> Array:
        """Return C(q, q')^T q', (n,) N m."""
        return dq @ self.coriolis(q, dq)

    def mass_rate(self, q: Array, dq: Array) -> Array:
        """Return dM/dt along the motion, (n, n) kg m^2/s."""
        c = self.coriolis(q, dq)
        return c + c.T

    def coriolis_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return (dC/dt) q' along the motion, (n,) N m/s."""
        return self._coriolis_matrix_rate(q, dq, ddq) @ dq

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return M q'' + C q' + g, (n,) N m."""
        return self.mass(q) @ ddq + self.bias(q, dq)

    def inverse_dynamics_rate(self, q: Array, dq: Array, ddq: Array, dddq: Array) -> Array:
        """Return d/dt (M q'' + C q' + g) along the motion, (n,) N m/s (trumic2022 eq. 9)."""
        c = self.coriolis(q, dq)
        return (
            self.mass(q) @ dddq
            + (c + c.T + c) @ ddq
            + self._coriolis_matrix_rate(q, dq, ddq) @ dq
            + self.gravity_rate(q, dq)
        )

    def kinetic_energy(self, q: Array, dq: Array) -> float:
        """Return q'^T M q' / 2 [J]."""
        return 0.5 * float(dq @ self.mass(q) @ dq)

    def potential_energy(self, q: Array) -> float:
        """Return the energy of gravity [J], 0 with every centre of mass at the base's height."""
        angle = height = energy = 0.0
        for body, length, turn in zip(self.bodies, self.lengths, q, strict=True):
            angle += float(turn)
            energy += body.mass * height - body.along * cos(angle) + body.across * sin(angle)
            height -= length * cos(angle)
        return self.field * energy

    def pose(self, frame: str, q: Array) -> Pose:
        """Return where a frame is."""
        spot = self._spot(frame)
        s = float(np.sum(q[: spot.link + 1]))
        rotation = np.array([[cos(s), 0.0, -sin(s)], [0.0, 1.0, 0.0], [sin(s), 0.0, cos(s)]])
        position = np.zeros(3)
        for reach, angle in self._reaches(spot, q):
            position += reach * np.array([sin(angle), 0.0, -cos(angle)])
        return Pose(rotation, position)

    def jacobian(self, frame: str, q: Array) -> Array:
        """Return the (6, n) Jacobian of a frame's origin: velocity, then angular velocity."""
        spot = self._spot(frame)
        jacobian = np.zeros((6, self.size))
        for i, (reach, angle) in enumerate(self._reaches(spot, q)):
            # Angle s_i is the sum of the first i + 1 joints'.
            jacobian[:3, : i + 1] += reach * np.array([[cos(angle)], [0.0], [sin(angle)]])
            jacobian[4, i] = -1.0
        return jacobian

    def motion(self, frame: str, q: Array, dq: Array, ddq: Array) -> FrameMotion:
        """Return how a frame moves."""
        spot = self._spot(frame)
        velocity, acceleration = np.zeros(3), np.zeros(3)
        rates, changes = np.cumsum(dq), np.cumsum(ddq)
        for i, (reach, angle) in enumerate(self._reaches(spot, q)):
            u = np.array([sin(angle), 0.0, -cos(angle)])
            v = np.array([cos(angle), 0.0, sin(angle)])
            velocity += reach * rates[i] * v
            acceleration += reach * (changes[i] * v - rates[i] ** 2 * u)
        spin = np.array([0.0, -rates[spot.link], 0.0])
        return FrameMotion(velocity, spin, acceleration, np.array([0.0, -changes[spot.link], 0.0]))

    def with_payload(
        self,
        frame: str,
        mass: float,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        inertia: Sequence[Sequence[float]] | None = None,
    ) -> Robot:
        """Return the arm with a body fixed to a frame; of its inertia only that about y counts.

        Raises
        ------
        DeviceError if there is no such frame, or no such body.
        """
        load = Payload.checked(frame, mass, position, inertia, self.frames)
        spot = self._spots[frame]
        bodies = list(self.bodies)
        bodies[spot.link] = bodies[spot.link].with_point(
            load.mass,
            spot.distance - float(load.position[2]),
            float(load.position[0]),
            float(load.inertia[1, 1]),
        )
        return self._with_bodies(tuple(bodies))

    def _spot(self, frame: str) -> Spot:
        """Find a frame."""
        if frame not in self._spots:
            raise no_such("frame", frame, self.frames)
        return self._spots[frame]

    def _reaches(self, spot: Spot, q: Array) -> list[tuple[float, float]]:
        """Return how far it is along each link [m], and that link's angle from hanging [rad]."""
        angles = np.cumsum(q)
        reaches = (*self.lengths[: spot.link], spot.distance)
        return [(reach, float(angles[i])) for i, reach in enumerate(reaches)]
