"""What a joint is made of: motor, link, encoders, set-point."""

from __future__ import annotations

from math import inf, pi
from typing import Annotated, Literal, Self, overload

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from rotatum.models.quantity import Uncertain
from rotatum.models.table import (
    NonNegativeQuantity,
    NonZero,
    Positive,
    PositiveQuantity,
    Real,
    Table,
)

__all__ = ["Encoders", "Link", "Motor", "Setpoint"]

_ZERO = Uncertain(0.0)


class Motor(Table):
    """A motor with its gear; every constant on the motor's side of the gear.

    inertia [kg m^2] (may be absent: not known), damping [N m s/rad] viscous, coulomb [N m],
    gear_ratio (motor turns per joint turn, negative if the gear reverses), torque_limit [N m].
    """

    inertia: PositiveQuantity | None = None
    damping: NonNegativeQuantity = _ZERO
    coulomb: NonNegativeQuantity = _ZERO
    gear_ratio: NonZero = 1.0
    torque_limit: Positive | None = None

    @property
    def reflected_inertia(self) -> Uncertain | None:
        """Inertia at the joint, B = J n^2 [kg m^2]."""
        return None if self.inertia is None else self.inertia.scaled(self.gear_ratio**2)

    @property
    def reflected_damping(self) -> Uncertain:
        """Viscous friction at the joint, D n^2 [N m s/rad]."""
        return self.damping.scaled(self.gear_ratio**2)

    @property
    def reflected_coulomb(self) -> Uncertain:
        """Coulomb friction at the joint, c |n| [N m]."""
        return self.coulomb.scaled(abs(self.gear_ratio))

    @property
    def reflected_torque_limit(self) -> float:
        """The most it gives at the joint [N m]; infinite where nothing is said."""
        return inf if self.torque_limit is None else self.torque_limit * abs(self.gear_ratio)


class Setpoint(Table):
    """How a serial joint's set-point follows from what is logged, and the motor that moves it.

    law "lever": s = r0 - b * logged angle, r0 [m], b [m/rad] (flacco2012 eq. 51); "direct": the
    set-point is what is logged. motor: the secondary motor, its constants on its own side of its
    gear; the logged angle is behind the gear.
    """

    law: Literal["lever", "direct"]
    r0: Real | None = None
    b: NonZero | None = None
    motor: Motor | None = None

    @model_validator(mode="after")
    def _constants_of_the_law(self) -> Self:
        """A lever has two constants, a direct set-point none."""
        for name in ("r0", "b"):
            given = getattr(self, name) is not None
            if given and self.law == "direct":
                raise ValueError(f'law "direct" has no constant {name}')
            if not given and self.law == "lever":
                raise ValueError(f'law "lever" needs the constant {name}')
        return self

    @property
    def slope(self) -> float:
        """Derivative ds/dangle of the set-point: -b, or 1."""
        return 1.0 if self.b is None else -self.b

    @overload
    def value(self, angle: float) -> float: ...
    @overload
    def value(self, angle: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def value(self, angle: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Return the set-point at logged angles [rad], or at what is logged directly."""
        if self.r0 is None or self.b is None:
            return angle
        return self.r0 - self.b * angle


class Link(Table):
    """The link: inertia [kg m^2], damping [N m s/rad], coulomb [N m], gravity_torque [N m].

    Gravity acts as g(q) = gravity_torque * sin(q), q = 0 hanging down.
    """

    inertia: PositiveQuantity | None = None
    damping: NonNegativeQuantity = _ZERO
    coulomb: NonNegativeQuantity = _ZERO
    gravity_torque: Real = 0.0


class Encoders(Table):
    """Angle sensors as seen at the joint.

    link, motor, setpoint: counts per turn of the joint (a motor's counts times its gear ratio).
    accuracy: systematic error of q - theta [rad]: gear train, eccentricity, interpolation.
    wrap_link, wrap_motor: the angle [rad at the joint] at which a reading starts again from zero.
    """

    link: Positive | None = None
    motor: Positive | None = None
    setpoint: Positive | None = None
    accuracy: Positive | None = None
    wrap_link: Positive | None = None
    wrap_motor: Positive | None = None

    def resolution(self, side: Literal["link", "motor", "setpoint"]) -> float | None:
        """Return the angle of one count, 2 pi / counts [rad]; None where counts are not known."""
        counts: float | None = getattr(self, side)
        return None if counts is None else 2.0 * pi / counts


class Basis(Table):
    """The functions of deflection and set-point whose sum is the elastic torque.

    deflection_range: half range of the deflection [rad]; orders: how many odd powers 1, 3, 5, ...
    (full: powers 0 to orders - 1); setpoint_range: (lowest, highest); setpoint_orders: highest
    power of the set-point.
    """

    deflection_range: Positive | None = None
    orders: Annotated[int, Field(strict=True, ge=1, le=8)] = 1
    full: Annotated[bool, Field(strict=True)] = False
    setpoint_range: tuple[Real, Real] | None = None
    setpoint_orders: Annotated[int, Field(strict=True, ge=0, le=4)] = 0

    @model_validator(mode="after")
    def _ranges(self) -> Self:
        """Powers need the ranges they are normalised by."""
        if self.deflection_range is None and (self.orders > 1 or self.full):
            raise ValueError("deflection_range is needed when orders > 1 or full = true")
        if self.setpoint_range is None and self.setpoint_orders > 0:
            raise ValueError("setpoint_range is needed when setpoint_orders > 0")
        if self.setpoint_range is not None and not self.setpoint_range[0] < self.setpoint_range[1]:
            raise ValueError("setpoint_range must be [lowest, highest]")
        return self
