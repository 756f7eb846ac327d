"""Accelerometers and gyroscopes on the links: [[accelerometer]] and [[gyroscope]]."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from rotatum.models.table import Real, Table

__all__ = ["Accelerometer", "Gyroscope"]

Axis = Literal["x", "y", "z"]


class _Mounted(Table):
    name: Annotated[str, Field(min_length=1)]
    frame: Annotated[str, Field(min_length=1)]
    position: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    rpy: tuple[Real, Real, Real] = (0.0, 0.0, 0.0)
    axes: tuple[Axis, ...] = ("x", "y", "z")

    @field_validator("axes", mode="after")
    @classmethod
    def _some_once(cls, given: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Refuse a sensor without axes, or with one twice."""
        if not given or len(set(given)) < len(given):
            raise ValueError('must name each axis once, such as ["x", "y", "z"]')
        return given


class Accelerometer(_Mounted):
    """An accelerometer: specific force, p'' minus the gravity vector, in its own axes [m/s^2].

    name: prefix of its columns; frame of the robot; position [m] in it; rpy [rad], roll, pitch and
    yaw of its axes from the frame's (``Rz Ry Rx``, as in URDF); axes that are logged.
    """


class Gyroscope(_Mounted):
    """A gyroscope: angular velocity in its own axes [rad/s].

    name: prefix of its columns; frame of the robot; position [m] in it, of no effect; rpy [rad],
    roll, pitch and yaw of its axes from the frame's (``Rz Ry Rx``, as in URDF); axes logged.
    """
