"""What drives a joint: functions of time and feedback by role, sampled and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.simulation.drivers.control import PositionControl
from rotatum.simulation.drivers.feedback import Feedback
from rotatum.simulation.drivers.limits import LimitedFeedback, limited
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.plant.bodies import Body, Plant

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

Array = NDArray[np.float64]

JointDrives = Mapping[str, Drive | Feedback]
"""Role of a joint -> what drives it."""

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
        (N, M) N m on the motors, each held until the next instant; zero where feedback drives.
    tau_ext
        (N,) N m on the link, held.
    angle
        (N,) rad, of a prescribed set-point's motor, straight from each instant to the next; None
        where a torque drives it.
    tau_setpoint
        (N,) N m on the set-point motor, held; zero where the set-point is prescribed.
    feedback
        Number of a motor -> what drives it looking at the motion, within the motor's limit.
    control
        Instants per control period: torques change, and feedback is asked, at ``time[::control]``.
    """

    time: Array
    tau: Array
    tau_ext: Array
    angle: Array | None
    tau_setpoint: Array
    feedback: Mapping[int, Feedback] = field(default_factory=dict)
    control: int = 1


def sample_drives(
    joint: Joint,
    plant: Plant,
    time: Array,
    drives: JointDrives,
    external: Drive | None = None,
    *,
    control: int = 1,
) -> Inputs:
    """Return the drives of a joint at instants (N,) [s], torques within the motors' limits.

    Motor torques are those of the control instants, ``time[::control]``, held until the next one; a
    prescribed set-point and `external` are those of every instant. `PositionControl` has its
    commands worked out here.

    Raises `RotatumError` for a drive the joint does not have, one it lacks, two ways of moving the
    set-point, feedback that is not on a motor or that the control period makes unstable, or values
    that are not finite numbers, one for each instant.
    """
    _check_names(plant, drives)
    if control < 1:
        raise RotatumError("one instant or more per control period", where="control", value=control)
    loops, waves = _apart(plant, drives)
    ticks = time[::control]
    nothing = np.zeros_like(time)
    tau, feedback = [], {}
    for m, (role, motor) in enumerate(zip(plant.torque_roles, joint.motors, strict=True)):
        where = f"{plant.name}, {role}"
        if role in waves:
            tau.append(_held(limited(motor, sampled(waves[role], ticks, role)), control, time.size))
        else:
            tau.append(nothing)
            law = _prepared(loops[role], plant.motors[m], ticks, where)
            feedback[m] = LimitedFeedback(law, motor.reflected_torque_limit, where)
    angle, tau_setpoint = _setpoint(joint, plant, waves, time, control)
    return Inputs(
        time=time,
        tau=np.column_stack(tau),
        tau_ext=nothing if external is None else sampled(external, time, "external"),
        angle=angle,
        tau_setpoint=tau_setpoint,
        feedback=feedback,
        control=control,
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


def _setpoint(
    joint: Joint, plant: Plant, drives: Mapping[str, Drive], time: Array, control: int
) -> tuple[Array | None, Array]:
    """Return angle, or None, and torque of the set-point motor."""
    nothing = np.zeros_like(time)
    if "tau_setpoint" in drives:
        tau = sampled(drives["tau_setpoint"], time[::control], "tau_setpoint")
        if joint.setpoint is not None and joint.setpoint.motor is not None:
            tau = limited(joint.setpoint.motor, tau)
        return None, _held(tau, control, time.size)
    if "setpoint" in drives:
        angle = (sampled(drives["setpoint"], time, "setpoint") - plant.offset) / plant.slope
        return angle, nothing
    if "setpoint_angle" in drives:
        return sampled(drives["setpoint_angle"], time, "setpoint_angle"), nothing
    return nothing, nothing


def _apart(plant: Plant, drives: JointDrives) -> tuple[dict[str, Feedback], dict[str, Drive]]:
    """Return feedback and functions of time, by role."""
    waves: dict[str, Drive] = {}
    loops: dict[str, Feedback] = {}
    for role, drive in drives.items():
        if callable(drive):
            waves[role] = drive
        else:
            loops[role] = drive
    for role in loops:
        if role not in plant.torque_roles:
            raise RotatumError(
                "only a motor's torque can be fed back; give a function of time",
                where=f"{plant.name}, drives",
                value=role,
                allowed=plant.torque_roles,
            )
    return loops, waves


def _prepared(feedback: Feedback, motor: Body, ticks: Array, where: str) -> Feedback:
    """Return a position controller with its commands worked out, any other feedback as it is."""
    if not isinstance(feedback, PositionControl):
        return feedback
    period = float(ticks[1] - ticks[0]) if ticks.size > 1 else 0.0
    gains, rotor = feedback.gains, (motor.inertia, motor.damping)
    if not gains.keep_steady(*rotor, period):
        longest = gains.longest_period(*rotor, period)
        raise RotatumError(
            "the gains are too high for the control period: the motor would swing up",
            where=where,
            value=period,
            allowed=f"periods below {longest:.3g} s" if longest > 0.0 else "none without damping",
            hint="Lower the bandwidth or kp, raise kd, or control faster.",
        )
    return feedback.sampled(ticks)


def _held(values: Array, control: int, size: int) -> Array:
    return values if control == 1 else np.repeat(values, control)[:size]


def _check_names(plant: Plant, drives: JointDrives) -> None:
    setpoint = SETPOINT_DRIVES if plant.actuation == "serial" else ()
    allowed = (*plant.torque_roles, *setpoint)
    what = f"a joint with {plant.actuation} actuation has no such drive"
    check_names(drives, allowed, what=what, where=f"{plant.name}, drives")
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


def _wrong_drives(plant: Plant, what: str, drives: JointDrives) -> RotatumError:
    return RotatumError(what, where=f"{plant.name}, drives", value=sorted(drives))
