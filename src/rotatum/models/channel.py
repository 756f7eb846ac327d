"""Where a log keeps a quantity, and how its numbers become SI values at the joint."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from rotatum.errors import DeviceError
from rotatum.models.table import NonZero, Real, Table, bad_choice
from rotatum.models.units import find_unit, unit_names

__all__ = [
    "MOTOR_SIDE_ROLES",
    "ROLES",
    "ROLE_KINDS",
    "SETPOINT_MOTOR",
    "STATES",
    "Channel",
    "Reading",
    "check_unit",
]

_COMMON = ("torque_measured", "tau_ext", "acc", "stiffness_true", "torque_true")
_EACH = ("stiffness1_true", "stiffness2_true", "torque1_true", "torque2_true")
# True positions of a joint, by actuation, then their rates: a simulator knows them.
STATES: dict[str, tuple[str, ...]] = {
    "series": ("q_true", "theta_true", "dq_true", "dtheta_true"),
    "antagonistic": (
        *("q_true", "theta1_true", "theta2_true"),
        *("dq_true", "dtheta1_true", "dtheta2_true"),
    ),
    "serial": (
        *("q_true", "theta_true", "setpoint_true"),
        *("dq_true", "dtheta_true", "dsetpoint_true"),
    ),
}
# Roles a joint's channels can have, by actuation.
ROLES: dict[str, tuple[str, ...]] = {
    "series": ("q", "theta", "tau", *_COMMON, *STATES["series"]),
    "antagonistic": (
        *("q", "theta1", "theta2", "tau1", "tau2", "torque_measured1", "torque_measured2"),
        *(*_COMMON, *_EACH, *STATES["antagonistic"]),
    ),
    "serial": ("q", "theta", "setpoint", "tau", *_COMMON, *STATES["serial"]),
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
    # m/s^2 too: a factor of 1 / lever makes an accelerometer out at the link the link's own
    "acc": ("angular acceleration", "acceleration"),
    "stiffness_true": ("stiffness",),
    "stiffness1_true": ("stiffness",),
    "stiffness2_true": ("stiffness",),
    "torque_true": ("torque",),
    "torque1_true": ("torque",),
    "torque2_true": ("torque",),
    **{
        state: ("speed",) if state.startswith("d") else ("angle",)
        for states in STATES.values()
        for state in states
    },
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


class Reading(Table):
    """One quantity of a log: SI value = sign * (factor * number + offset) * unit.

    name: column, variable or dotted path (absent: the canonical column); index: zero-based row or
    column of a 2-D array; unit: see rotatum.models.units (absent: SI).
    """

    name: str | None = None
    index: Annotated[int, Field(strict=True, ge=0)] | None = None
    unit: str | None = None
    factor: NonZero = 1.0
    offset: Real = 0.0
    sign: Literal[1, -1] = 1

    @model_validator(mode="before")
    @classmethod
    def _bare_name(cls, raw: object) -> object:
        """Accept a bare text as the name."""
        return {"name": raw} if isinstance(raw, str) else raw

    @property
    def named(self) -> bool:
        """Whether it says where the log keeps the quantity."""
        return self.name is not None or self.index is not None


class Channel(Reading):
    """One quantity of a joint: what a `Reading` is, then the side.

    side: "motor" quantities are divided (angles) or multiplied (torques) by the gear ratio; hold:
    "held" for a command kept constant until the next sample, "sampled" for a measurement at the
    instant.
    """

    side: Literal["joint", "motor"] = "joint"
    hold: Literal["sampled", "held"] = "sampled"


def check_unit(
    role: str, channel: Reading, kinds: tuple[str, ...], *, prefix: str = "channels."
) -> None:
    """Refuse an unknown unit, and one of another kind than the role's.

    Parameters
    ----------
    role, channel : the channel; without a unit it is in SI.
    kinds : of unit that the role may be in.
    prefix : of its key, for the message.

    Raises
    ------
    PydanticCustomError, with the key, the value and the allowed units.
    """
    if channel.unit is None:
        return
    try:
        find_unit(channel.unit, *kinds)
    except DeviceError as error:
        key = f"{prefix}{role}.unit"
        raise bad_choice(error.what, key, channel.unit, unit_names(*kinds)) from None
