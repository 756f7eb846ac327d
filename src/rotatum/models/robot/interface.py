"""What a rigid arm can be asked: one interface for closed forms and URDF files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["FrameMotion", "Pose", "Robot"]

Array = NDArray[np.float64]


class Pose(NamedTuple):
    """Where a frame is.

    Parameters
    ----------
    rotation : (3, 3), columns are the frame's axes in the world.
    position : (3,) m, of its origin in the world.
    """

    rotation: Array
    position: Array


class FrameMotion(NamedTuple):
    """How a frame moves, everything in the world's axes, of the frame's origin.

    Parameters
    ----------
    velocity : (3,) m/s.
    angular_velocity : (3,) rad/s.
    acceleration : (3,) m/s^2, d2p/dt2 (gravity is not in it).
    angular_acceleration : (3,) rad/s^2.
    """

    velocity: Array
    angular_velocity: Array
    acceleration: Array
    angular_acceleration: Array


class Robot(ABC):
    """A serial arm of rigid links on joints that turn: ``M(q) q'' + C(q, q') q' + g(q) = tau``.

    C is that of the Christoffel symbols, so that ``C + C^T = dM/dt``. All angles at the joints,
    (n,) rad; torques (n,) N m. Rotors and their gears are not in it.
    """

    names: tuple[str, ...]
    frames: tuple[str, ...]
    gravity_vector: Array

    @property
    def size(self) -> int:
        """Number of joints n."""
        return len(self.names)

    @abstractmethod
    def mass(self, q: Array) -> Array:
        """Return M(q), (n, n) kg m^2."""

    @abstractmethod
    def coriolis(self, q: Array, dq: Array) -> Array:
        """Return C(q, q'), (n, n) N m s/rad."""

    @abstractmethod
    def gravity(self, q: Array) -> Array:
        """Return g(q), (n,) N m."""

    @abstractmethod
    def bias(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') q' + g(q), (n,) N m."""

    @abstractmethod
    def coriolis_transposed(self, q: Array, dq: Array) -> Array:
        """Return C(q, q')^T q' = dT/dq, (n,) N m, without forming C where that is possible."""

    def momentum(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Return p = M(q) q' and C(q, q')^T q', (n,) N m s and (n,) N m: p' - C^T q' + g = tau."""
        return self.mass(q) @ dq, self.coriolis_transposed(q, dq)

    @abstractmethod
    def mass_rate(self, q: Array, dq: Array) -> Array:
        """Return dM/dt along the motion, (n, n) kg m^2/s."""

    @abstractmethod
    def gravity_gradient(self, q: Array) -> Array:
        """Return dg/dq, (n, n) N m/rad: row i is of g_i."""

    def gravity_rate(self, q: Array, dq: Array) -> Array:
        """Return dg/dt along the motion, (n,) N m/s."""
        return self.gravity_gradient(q) @ dq

    @abstractmethod
    def coriolis_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return (dC/dt) q' along the motion, (n,) N m/s; C q'' is not in it."""

    @abstractmethod
    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return M q'' + C q' + g, (n,) N m."""

    @abstractmethod
    def inverse_dynamics_rate(self, q: Array, dq: Array, ddq: Array, dddq: Array) -> Array:
        """Return d/dt (M q'' + C q' + g) along the motion, (n,) N m/s (trumic2022 eq. 9)."""

    @abstractmethod
    def accelerate(self, q: Array, dq: Array, torque: Array) -> Array:
        """Return q'' = M^-1 (torque - C q' - g), (n,) rad/s^2."""

    @abstractmethod
    def kinetic_energy(self, q: Array, dq: Array) -> float:
        """Return q'^T M q' / 2 [J]."""

    @abstractmethod
    def potential_energy(self, q: Array) -> float:
        """Return the links' energy of gravity [J], 0 at an arbitrary height."""

    @abstractmethod
    def pose(self, frame: str, q: Array) -> Pose:
        """Return where a frame of `frames` is."""

    @abstractmethod
    def jacobian(self, frame: str, q: Array) -> Array:
        """Return the (6, n) Jacobian of a frame's origin: velocity, then angular velocity."""

    def wrench_gradient(self, frame: str, q: Array, wrench: Array) -> Array:
        """Return d(J^T w)/dq at a constant wrench, J_q^T f of trumic2022's Remark 2.

        Of the unit axes z and the velocities v of the frame, the columns of J: dv_j/dq_i is
        ``z_a x v_b`` with a the nearer to the base of i and j, and b the other; dz_j/dq_i is
        ``z_i x z_j`` for i < j, else 0. Symmetric in a force, and not in a moment.

        Parameters
        ----------
        wrench : (6,) force [N] at the frame's origin and moment [N m], in the world's axes.

        Returns
        -------
        (n, n) N m/rad: row j is of the torque at joint j.
        """
        jacobian = self.jacobian(frame, q)
        velocities, axes = jacobian[:3].T, jacobian[3:].T
        by_force = axes @ np.cross(velocities, wrench[:3]).T
        by_moment = axes @ np.cross(axes, wrench[3:]).T
        gradient: Array = np.triu(by_force) + np.triu(by_force + by_moment, 1).T
        return gradient

    @abstractmethod
    def motion(self, frame: str, q: Array, dq: Array, ddq: Array) -> FrameMotion:
        """Return how a frame moves."""

    @abstractmethod
    def with_payload(
        self,
        frame: str,
        mass: float,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        inertia: Sequence[Sequence[float]] | None = None,
    ) -> Robot:
        """Return the arm with a body fixed to a frame.

        Parameters
        ----------
        mass : kg.
        position : (3,) m, of its centre of mass in the frame.
        inertia : (3, 3) kg m^2 about that centre, in the frame's axes; None: a point.
        """
