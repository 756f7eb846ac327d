"""Constants of a joint's motor and transmission: all an observer that knows no links needs."""

from __future__ import annotations

import math
from typing import NamedTuple

from rotatum.errors import MethodError
from rotatum.models.joint import Joint


class Drivetrain(NamedTuple):
    """Motor and spring of one joint, at the joint.

    Args:
        inertia: of the motor, B [kg m^2].
        stiffness: K [N m/rad].
        damping: of the spring, D [N m s/rad].
        motor_damping: viscous friction of the motor [N m s/rad].
        coulomb: Coulomb friction of the motor [N m].
    """

    inertia: float
    stiffness: float
    damping: float = 0.0
    motor_damping: float = 0.0
    coulomb: float = 0.0

    def checked(self, where: str = "drivetrain") -> Drivetrain:
        """Return it if an observer can be built on it.

        Args:
            where: the joint, for messages.

        Raises:
            MethodError: inertia or stiffness is not positive, or a friction is negative.
        """
        for name, value in self._asdict().items():
            needed = name in ("inertia", "stiffness")
            if not math.isfinite(value) or value < 0.0 or (needed and value == 0.0):
                raise MethodError(
                    f"{name.replace('_', ' ')} must be {'positive' if needed else '0 or more'}",
                    where=where,
                    value=value,
                )
        return self


def drivetrain_of(joint: Joint, stiffness: float | None = None) -> Drivetrain:
    """Return the constants of a series or serial joint: spring at its rest, motor reflected.

    A law that depends on a set-point is taken at the middle of the range declared for it.

    Args:
        joint: its motor's inertia must be known.
        stiffness: [N m/rad]; None: that of the transmission's law at rest.

    Raises:
        MethodError: two transmissions on one link, no motor inertia, or no stiffness.
    """
    if joint.actuation == "antagonistic":
        raise MethodError(
            "the observer takes one motor and one transmission to a link",
            where=joint.name,
            value=joint.actuation,
            allowed=("series", "serial"),
        )
    inertia = joint.motors[0].reflected_inertia if joint.motors else None
    if inertia is None:
        raise MethodError("the observer needs the motor's inertia", where=joint.name,
                          hint="Give [motor] inertia.")  # fmt: skip
    spring, motor = joint.transmission, joint.motors[0]
    if stiffness is None:
        middle = _middle(joint)
        if spring.law is None or middle is None:
            raise MethodError(
                "the observer needs a stiffness",
                where=joint.name,
                hint="Give [transmission] a law, and [basis] setpoint_range where it depends on a "
                "set-point, or give the stiffness.",
            )
        stiffness = float(spring.stiffness(0.0, middle))
    return Drivetrain(
        inertia.value,
        stiffness,
        spring.damping,
        motor.reflected_damping.value,
        motor.reflected_coulomb.value,
    ).checked(joint.name)


def _middle(joint: Joint) -> float | None:
    """Return the set-point, in the law's unit, a joint's stiffness is said for; None: unknown."""
    spring, reach = joint.transmission, joint.basis.setpoint_range
    if spring.law is None or not spring.model.uses_setpoint:
        return 0.0
    return None if reach is None else 0.5 * (reach[0] + reach[1])
