"""What drives a joint: functions of time by role, sampled and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, nearest
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.plant.bodies import Plant

if TYPE_CHECKING:
    from rotatum.models.joint import Joint
    from rotatum.models.parts import Motor

Array = NDArray[np.float64]

# The ways to move the set-point of a serial joint; exactly one is needed.
SETPOINT_DRIVES = ("setpoint", "setpoint_angle", "tau_setpoint")


@dataclass(frozen=True)
class Inputs:
    """What acts on a joint, sampled at the log's instants.

    Attributes
    ----------
    time
        (N,) s, evenly spaced.
    tau
        (N, M) N m on the motors, each held until the next instant.
    tau_ext
        (N,) N m on the link, held.
    angle
        (N,) rad, of a prescribed set-point's motor, straight from each instant to the next; None
        where a torque drives it.
    tau_setpoint
        (N,) N m on the set-point motor, held; zero where the set-point is prescribed.
    """

    time: Array
    tau: Array
    tau_ext: Array
    angle: Array | None
    tau_setpoint: Array


def sample_drives(
    joint: Joint,
    plant: Plant,
    time: Array,
    drives: Mapping[str, Drive],
    external: Drive | None = None,
) -> Inputs:
    """Return the drives of a joint at instants (N,) [s], torques within the motors' limits.

    Raises `RotatumError` for a drive the joint does not have, one it lacks, two ways of moving the
    set-point, or values that are not finite numbers, one for each instant.
    """
    _check_names(plant, drives)
    tau = [
        _limited(motor, sampled(drives[role], time, role))
        for role, motor in zip(plant.torque_roles, joint.motors, strict=True)
    ]
    nothing = np.zeros_like(time)
    angle: Array | None = nothing
    tau_setpoint = nothing
    if "setpoint" in drives:
        angle = (sampled(drives["setpoint"], time, "setpoint") - plant.offset) / plant.slope
    if "setpoint_angle" in drives:
        angle = sampled(drives["setpoint_angle"], time, "setpoint_angle")
    if "tau_setpoint" in drives:
        angle = None
        tau_setpoint = sampled(drives["tau_setpoint"], time, "tau_setpoint")
        if joint.setpoint is not None and joint.setpoint.motor is not None:
            tau_setpoint = _limited(joint.setpoint.motor, tau_setpoint)
    return Inputs(
        time=time,
        tau=np.column_stack(tau),
        tau_ext=nothing if external is None else sampled(external, time, "external"),
        angle=angle,
        tau_setpoint=tau_setpoint,
    )


def sampled(drive: Drive, time: Array, name: str) -> Array:
    """Return a drive at instants (N,) [s]; raise `RotatumError` unless all are numbers."""
    values = np.asarray(drive(time), dtype=np.float64)
    if values.shape != time.shape or not np.all(np.isfinite(values)):
        raise RotatumError(
            "a drive must be one finite number for each instant",
            where=name,
            value=values.shape,
            allowed=f"shape {time.shape}",
        )
    return values


def _check_names(plant: Plant, drives: Mapping[str, Drive]) -> None:
    setpoint = SETPOINT_DRIVES if plant.actuation == "serial" else ()
    allowed = (*plant.torque_roles, *setpoint)
    for role in drives:
        if role not in allowed:
            close = nearest(role, allowed)
            raise RotatumError(
                f"a joint with {plant.actuation} actuation has no such drive",
                where=f"{plant.name}, drives",
                value=role,
                allowed=allowed,
                hint=f"Did you mean {close!r}?" if close else None,
            )
    for role in plant.torque_roles:
        if role not in drives:
            raise _wrong_drives(plant, f"a torque drives each motor; {role} is missing", drives)
    if setpoint and len([role for role in setpoint if role in drives]) != 1:
        what = "the set-point is moved in exactly one way: " + ", ".join(SETPOINT_DRIVES)
        raise _wrong_drives(plant, what, drives)
    if "tau_setpoint" in drives and plant.setpoint_motor is None:
        raise RotatumError(
            "a torque on the set-point needs the inertia and friction of its motor",
            where=f"{plant.name}.setpoint.motor",
            hint="Give the table [setpoint.motor], or prescribe the set-point.",
        )


def _wrong_drives(plant: Plant, what: str, drives: Mapping[str, Drive]) -> RotatumError:
    return RotatumError(what, where=f"{plant.name}, drives", value=sorted(drives))


def _limited(motor: Motor, tau: Array) -> Array:
    if motor.torque_limit is None:
        return tau
    limit = motor.torque_limit * abs(motor.gear_ratio)
    return np.clip(tau, -limit, limit)
