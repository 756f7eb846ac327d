"""Two rigid links in a plane, in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.plane import PlanarArm, PlanarBody, Spot

__all__ = ["Planar"]

Array = NDArray[np.float64]


class Planar(PlanarArm):
    """A planar 2R arm (flacco2012 section 6.3), hanging down at ``q = 0``; axes as in `PlanarArm`.

    With the link's first moments P along and R across it (R of payloads only), J about its joint,
    the gravity g0 and ``h = l1 (P2 cos q2 - R2 sin q2)``::

        M = [[J1 + J2 + m2 l1^2 + 2 h, J2 + h], [J2 + h, J2]]
        C = [[h_q q2', h_q (q1' + q2')], [-h_q q1', 0]],  h_q = dh/dq2
        g2 = g0 (P2 sin(q1 + q2) + R2 cos(q1 + q2))
        g1 = g0 ((P1 + m2 l1) sin q1 + R1 cos q1) + g2

    Frames "link1" and "link2", on the links at their joints' axes, "elbow" and "tip" at their ends.

    Parameters
    ----------
    lengths : (2,) m, from joint to joint, and to the tip.
    masses : (2,) kg.
    centres : (2,) m, from the joint to the centre of mass; None: the middle.
    inertias : (2,) kg m^2, about the centre of mass; None: of a uniform thin rod, m l^2 / 12.
    motor_masses : kg, of the actuator at the elbow, a point fixed to the first link.
    gravity : m/s^2; 0: a horizontal plane, and none across it either.
    names : of the joints.

    Raises
    ------
    DeviceError for numbers that no arm has.
    """

    def __init__(
        self,
        lengths: Sequence[float],
        masses: Sequence[float],
        *,
        centres: Sequence[float] | None = None,
        inertias: Sequence[float] | None = None,
        motor_masses: Sequence[float] = (),
        gravity: float = 9.81,
        names: Sequence[str] = ("joint1", "joint2"),
    ) -> None:
        middle = [0.5 * length for length in lengths] if centres is None else centres
        given = {"lengths": lengths, "masses": masses, "centres": middle, "names": names}
        if inertias is not None:
            given["inertias"] = inertias
        for key, numbers in given.items():
            if len(numbers) != 2:
                what = f"a planar arm has two {key}"
                raise DeviceError(what, where="planar", value=list(numbers))
        spots = {
            "link1": Spot(0, 0.0), "link2": Spot(1, 0.0),
            "elbow": Spot(0, float(lengths[0])), "tip": Spot(1, float(lengths[1])),
        }  # fmt: skip
        self._settle(names, lengths, spots, gravity)
        bodies = [
            rod(lengths[i], masses[i], middle[i], None if inertias is None else inertias[i])
            for i in (0, 1)
        ]
        if len(motor_masses) > 1:
            what = "a planar arm has one actuator after the first joint"
            raise DeviceError(what, where="planar.motor_masses", value=list(motor_masses))
        for mass in motor_masses:
            if not (np.isfinite(mass) and mass >= 0.0):
                what = "mass of an actuator must be at least 0"
                raise DeviceError(what, where="planar", value=mass)
            bodies[0] = bodies[0].with_point(mass, self.lengths[0], 0.0, 0.0)
        self.bodies = tuple(bodies)

    def _with_bodies(self, bodies: tuple[PlanarBody, ...]) -> Planar:
        arm = Planar(self.lengths, (1.0, 1.0), gravity=self.field, names=self.names)
        arm.bodies = bodies
        return arm

    def mass(self, q: Array) -> Array:
        """Return M(q), (2, 2) kg m^2."""
        first, coupled, second = self._masses(float(q[1]))
        return np.array([[first, coupled], [coupled, second]])

    def coriolis(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') of the Christoffel symbols, (2, 2) N m s/rad."""
        slope = self._slope(float(q[1]))
        v1, v2 = float(dq[0]), float(dq[1])
        return np.array([[slope * v2, slope * (v1 + v2)], [-slope * v1, 0.0]])

    def _coriolis_matrix_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        angle, (v1, v2) = float(q[1]), (float(dq[0]), float(dq[1]))
        a1, a2 = float(ddq[0]), float(ddq[1])
        slope, change = self._slope(angle), -self._coupling(angle) * v2
        first = change * v2 + slope * a2
        return np.array(
            [[first, first + change * v1 + slope * a1], [-change * v1 - slope * a1, 0.0]]
        )

    def gravity(self, q: Array) -> Array:
        """Return g(q), (2,) N m."""
        return np.array(self._torques(float(q[0]), float(q[1])))

    def gravity_gradient(self, q: Array) -> Array:
        """Return dg/dq, (2, 2) N m/rad."""
        one, two = self.bodies
        s1, s2 = float(q[0]), float(q[0] + q[1])
        second = self.field * (two.along * cos(s2) - two.across * sin(s2))
        weight = one.along + two.mass * self.lengths[0]
        first = self.field * (weight * cos(s1) - one.across * sin(s1))
        return np.array([[first + second, second], [second, second]])

    def bias(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') q' + g(q), (2,) N m."""
        q1, q2 = q.tolist()
        return np.array(self._biases(q1, q2, dq))

    def accelerate(self, q: Array, dq: Array, torque: Array) -> Array:
        """Return q'' = M^-1 (torque - C q' - g), (2,) rad/s^2."""
        q1, q2 = q.tolist()
        b1, b2 = self._biases(q1, q2, dq)
        m11, m12, m22 = self._masses(q2)
        t1, t2 = torque.tolist()
        t1, t2 = t1 - b1, t2 - b2
        determinant = m11 * m22 - m12 * m12
        return np.array([(m22 * t1 - m12 * t2) / determinant, (m11 * t2 - m12 * t1) / determinant])

    def _biases(self, q1: float, q2: float, dq: Array) -> tuple[float, float]:
        """Return C q' + g."""
        v1, v2 = dq.tolist()
        slope = self._slope(q2)
        g1, g2 = self._torques(q1, q2)
        return slope * v2 * (2.0 * v1 + v2) + g1, g2 - slope * v1 * v1

    def _coupling(self, q2: float) -> float:
        """Return h."""
        two = self.bodies[1]
        return self.lengths[0] * (two.along * cos(q2) - two.across * sin(q2))

    def _slope(self, q2: float) -> float:
        """Return dh/dq2."""
        two = self.bodies[1]
        return -self.lengths[0] * (two.along * sin(q2) + two.across * cos(q2))

    def _masses(self, q2: float) -> tuple[float, float, float]:
        """Return M11, M12, M22."""
        one, two = self.bodies
        h = self._coupling(q2)
        first = one.inertia + two.inertia + two.mass * self.lengths[0] ** 2 + 2.0 * h
        return first, two.inertia + h, two.inertia

    def _torques(self, q1: float, q2: float) -> tuple[float, float]:
        """Return g1, g2."""
        one, two = self.bodies
        second = self.field * (two.along * sin(q1 + q2) + two.across * cos(q1 + q2))
        weight = one.along + two.mass * self.lengths[0]
        return self.field * (weight * sin(q1) + one.across * cos(q1)) + second, second


def rod(length: float, mass: float, centre: float, inertia: float | None) -> PlanarBody:
    """Return a link's body.

    Parameters
    ----------
    length : m.
    mass : kg.
    centre : m, from the joint to the centre of mass.
    inertia : kg m^2, about that centre; None: of a uniform thin rod.

    Raises
    ------
    DeviceError for numbers that no link has.
    """
    if not (np.isfinite(mass) and mass > 0.0):
        raise DeviceError("mass of a link must be greater than 0", value=mass)
    if not np.isfinite(centre):
        raise DeviceError("centre of mass of a link must be a number", value=centre)
    own = mass * length**2 / 12.0 if inertia is None else inertia
    if not (np.isfinite(own) and own >= 0.0):
        raise DeviceError("inertia of a link must be at least 0", value=inertia)
    whole = own + mass * centre**2
    if whole <= 0.0:
        what = "a link needs an inertia about its joint: give it an inertia, or a centre of mass"
        raise DeviceError(what, value=whole)
    return PlanarBody(mass, mass * centre, 0.0, whole)
