"""Where a log keeps a quantity, and how its numbers become SI values at the joint."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from rotatum.models.table import NonZero, Real, Table

__all__ = ["MOTOR_SIDE_ROLES", "ROLES", "ROLE_KINDS", "SETPOINT_MOTOR", "Channel"]

_COMMON = ("torque_measured", "tau_ext", "acc", "stiffness_true", "torque_true")
_EACH = ("stiffness1_true", "stiffness2_true", "torque1_true", "torque2_true")
# Roles a joint's channels can have, by actuation.
ROLES: dict[str, tuple[str, ...]] = {
    "series": ("q", "theta", "tau", *_COMMON),
    "antagonistic": (
        *("q", "theta1", "theta2", "tau1", "tau2", "torque_measured1", "torque_measured2"),
        *(*_COMMON, *_EACH),
    ),
    "serial": ("q", "theta", "setpoint", "tau", *_COMMON),
}
# Kinds of unit each role may be given in.
ROLE_KINDS: dict[str, tuple[str, ...]] = {
    "time": ("time",),
    "q": ("angle",),
    "theta": ("angle",),
    "theta1": ("angle",),
    "theta2": ("angle",),
    "setpoint": ("angle", "length"),
    "tau": ("torque",),
    "tau1": ("torque",),
    "tau2": ("torque",),
    "torque_measured": ("torque",),
    "torque_measured1": ("torque",),
    "torque_measured2": ("torque",),
    "tau_ext": ("torque",),
    "acc": ("acceleration",),
    "stiffness_true": ("stiffness",),
    "stiffness1_true": ("stiffness",),
    "stiffness2_true": ("stiffness",),
    "torque_true": ("torque",),
    "torque1_true": ("torque",),
    "torque2_true": ("torque",),
}
SETPOINT_MOTOR = -1
# Roles that may be logged on the motor's side of a gear, and the motor they belong to.
MOTOR_SIDE_ROLES: dict[str, int] = {
    "theta": 0,
    "theta1": 0,
    "theta2": 1,
    "tau": 0,
    "tau1": 0,
    "tau2": 1,
    "torque_measured": 0,
    "torque_measured1": 0,
    "torque_measured2": 1,
    "setpoint": SETPOINT_MOTOR,
}


class Channel(Table):
    """One quantity of a log: SI value = sign * (factor * number + offset) * unit, then the side.

    name: column, variable or dotted path (absent: the canonical column); index: zero-based row or
    column of a 2-D array; unit: see rotatum.models.units (absent: SI); side: "motor" quantities
    are divided (angles) or multiplied (torques) by the gear ratio; hold: "held" for a command kept
    constant until the next sample, "sampled" for a measurement at the instant.
    """

    name: str | None = None
    index: Annotated[int, Field(strict=True, ge=0)] | None = None
    unit: str | None = None
    factor: NonZero = 1.0
    offset: Real = 0.0
    sign: Literal[1, -1] = 1
    side: Literal["joint", "motor"] = "joint"
    hold: Literal["sampled", "held"] = "sampled"

    @model_validator(mode="before")
    @classmethod
    def _bare_name(cls, raw: object) -> object:
        """Accept a bare text as the name."""
        return {"name": raw} if isinstance(raw, str) else raw
