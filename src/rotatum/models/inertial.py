"""Accelerometers and gyroscopes on the links: [[accelerometer]] and [[gyroscope]]."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, field_validator, model_validator

from rotatum.models.channel import Reading, check_unit
from rotatum.models.table import Real, Table, bad_choice

__all__ = ["Accelerometer", "Gyroscope"]

Axis = Literal["x", "y", "z"]


class _Mounted(Table):
    letter: ClassVar[str]  # begins the names of its columns
    kind: ClassVar[str]  # of the units they may be in

    name: Annotated[str, Field(min_length=1)]
    frame: Annotated[str, Field(min_length=1)]
    position: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    rpy: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    axes: tuple[Axis, ...] = ("x", "y", "z")
    channels: Mapping[str, Reading] = Field(default_factory=dict)

    @property
    def roles(self) -> tuple[str, ...]:
        """What a log can hold of it, such as "ax", "ay", "az", in the order of its axes."""
        return tuple(f"{self.letter}{axis}" for axis in self.axes)

    @field_validator("axes", mode="after")
    @classmethod
    def _some_once(cls, given: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Refuse a sensor without axes, or with one twice."""
        if not given or len(set(given)) < len(given):
            raise ValueError('must name each axis once, such as ["x", "y", "z"]')
        return given

    @model_validator(mode="after")
    def _channels_of_the_axes(self) -> Self:
        """Refuse channels of axes it does not have, and units it cannot be in."""
        for role, channel in self.channels.items():
            if role not in self.roles:
                raise bad_choice("unknown channel", "channels", role, self.roles)
            check_unit(role, channel, (self.kind,))
        return self


class Accelerometer(_Mounted):
    """An accelerometer: specific force, p'' minus the gravity vector, in its own axes [m/s^2].

    name: prefix of its columns; frame of the robot; position [m] in it; rpy [rad], roll, pitch and
    yaw of its axes from the frame's (``Rz Ry Rx``, as in URDF); axes that are logged; channels:
    "ax", "ay", "az" -> where a log keeps it, if not in the canonical column ``<name>.ax``.
    """

    letter = "a"
    kind = "acceleration"


class Gyroscope(_Mounted):
    """A gyroscope: angular velocity in its own axes [rad/s].

    name: prefix of its columns; frame of the robot; position [m] in it, of no effect; rpy [rad],
    roll, pitch and yaw of its axes from the frame's (``Rz Ry Rx``, as in URDF); axes logged;
    channels: "gx", "gy", "gz" -> where a log keeps it, if not in the canonical column.
    """

    letter = "g"
    kind = "speed"
