"""Run a plant in time: sub-steps chosen, the compiled stage run, and its motion looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, SimulationError
from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.effects import Effects
from rotatum.simulation.plant.march import March, at_rest
from rotatum.simulation.plant.steps import choose_substeps
from rotatum.simulation.plant.stops import failure, first_wrong

__all__ = [
    "Course",
    "course_of",
    "course_warnings",
    "left_out",
    "run_plant",
    "substeps_for",
    "write_inputs",
]

Array = NDArray[np.float64]
Added = tuple[Array, Array]
"""Inertia (N,) [kg m^2] and horizontal gravity torque (N,) [N m] that a payload adds to a link."""


class Course(NamedTuple):
    """What a plant did.

    Args:
        at: (N,) records, `rotatum.simulation.plant.records.PlantOutput`; fewer where it stopped.
        substeps: Runge-Kutta steps per sample.
        quasi_static: whether the set-point motor was taken without its inertia.
        stopped: why it ends before its time: it left a law's range or diverged.
    """

    at: Records
    substeps: int
    quasi_static: bool
    stopped: SimulationError | None = None


def run_plant(
    plant: Plant,
    inputs: Inputs,
    *,
    start: Mapping[str, float] | None = None,
    substeps: int | None = None,
    added: Added | None = None,
) -> Course:
    """Return the plant's motion under the inputs, up to where it can be believed.

    Classical Runge-Kutta with 10 sub-steps per sample, or as many as the fastest rates ask for,
    also at the stiffest deflections of the motion (`choose_substeps`). Ranges are looked at at the
    samples, not in between.

    Parameters
    ----------
    start
        Positions [rad] under their roles ("q", "theta", "setpoint_angle") and velocities [rad/s]
        under "d" and the role; what is not named is zero. A prescribed set-point goes its own way.
    substeps
        Runge-Kutta steps per sample.
    added
        What a payload adds to the link.

    Raises `RotatumError` if `substeps` are so few that the integration is unstable, if more than
    1000 are needed, and for a payload or a drift that leaves no inertia or stiffness.
    """
    period = float(inputs.time[1] - inputs.time[0])
    prescribed = inputs.angle is not None
    begin = dict(start or {})
    if inputs.angle is not None:
        begin["setpoint_angle"] = float(inputs.angle[0])
    lightest = _lightest(plant, added)
    count = choose_substeps(lightest, period, at_rest(plant, begin), substeps)
    for _ in range(3):
        march = March(plant, period, start=begin, substeps=count, prescribed=prescribed)
        u = march.inputs(inputs.time.size)
        write_inputs(inputs, u, effects=plant.effects, added=added)
        course = course_of(plant, inputs.time, march.run(u), march)
        # a hardening spring may ask for more than it did at rest, and show it only on the way
        count = substeps_for(lightest, period, course, substeps)
        if count <= course.substeps:
            break
    return course


def course_of(plant: Plant, time: Array, at: Records, march: March) -> Course:
    """Return outputs (N,) at instants (N,) [s], cut where they cannot be believed any longer."""
    wrong = first_wrong(plant, at)
    if wrong is None:
        return Course(at, march.substeps, march.quasi_static)
    stopped = failure(plant, float(time[wrong]), at[wrong : wrong + 1])
    return Course(at[:wrong], march.substeps, march.quasi_static, stopped)


def course_warnings(plant: Plant, course: Course) -> tuple[str, ...]:
    """Return what a log of this course should say about how it was simulated."""
    return left_out(plant, course.substeps) if course.quasi_static else ()


def left_out(plant: Plant, substeps: int) -> tuple[str, ...]:
    """Say that a set-point motor was taken without its inertia, at so many steps a sample."""
    if plant.setpoint_motor is None:
        return ()
    rate = plant.setpoint_motor.rate(plant.smoothing)
    steps = f"{substeps} integration step{'s' if substeps > 1 else ''}"
    return (
        f"{plant.name}: friction stops the set-point motor at a rate of {rate:.3g} 1/s, too fast "
        f"for {steps} a sample; simulated without its inertia.",
    )


def substeps_for(plant: Plant, period: float, course: Course, substeps: int | None = None) -> int:
    """Return the sub-steps the stiffest deflections and largest torques of a course ask for.

    No more than it had where it stopped and they have gone out of hand. Raises `RotatumError` as
    `choose_substeps` does.
    """
    stiffness, torque = (
        np.max(np.abs(course.at[name]), axis=0, initial=0.0).tolist()
        for name in ("stiffness", "torque")
    )
    try:
        return choose_substeps(plant, period, stiffness, substeps, loads=torque)
    except RotatumError:
        if course.stopped is None or substeps is not None:
            raise
        return course.substeps


def until(inputs: Inputs, samples: int) -> Inputs:
    """Return the inputs of the first samples only."""
    return replace(
        inputs,
        time=inputs.time[:samples],
        tau=inputs.tau[:samples],
        tau_ext=inputs.tau_ext[:samples],
        angle=None if inputs.angle is None else inputs.angle[:samples],
        tau_setpoint=inputs.tau_setpoint[:samples],
    )


def write_inputs(
    inputs: Inputs, u: Records, *, effects: Effects | None = None, added: Added | None = None
) -> None:
    """Write what acts on a joint to inputs (N,) of its stage.

    Parameters
    ----------
    effects
        Of its plant, for the drift.
    added
        What a payload adds to the link.

    Raises `RotatumError` for a drift that leaves no stiffness.
    """
    u["tau"] = inputs.tau
    u["tau_ext"] = inputs.tau_ext
    u["tau_setpoint"] = inputs.tau_setpoint
    if inputs.angle is not None:
        u["angle"] = inputs.angle
        u["next_angle"] = np.append(inputs.angle[1:], inputs.angle[-1])
    u["scale"] = u["next_scale"] = 1.0
    if effects is not None:
        period = float(inputs.time[1] - inputs.time[0])
        u["scale"], u["next_scale"] = effects.drift.factors(inputs.time, period)
    if added is not None:
        u["added_inertia"], u["added_gravity"] = added


def _lightest(plant: Plant, added: Added | None) -> Plant:
    """Return the plant with its smallest link inertia and largest weight; refuse none at all."""
    if added is None:
        return plant
    inertia = plant.link.inertia + min(0.0, float(np.min(added[0])))
    if not inertia > 0.0:
        raise RotatumError(
            "the payload leaves the link no inertia",
            where=f"{plant.name}, payload",
            value=inertia - plant.link.inertia,
            allowed=f"more than {-plant.link.inertia:.6g} kg m^2",
        )
    gravity = max(abs(plant.gravity_torque), float(np.max(np.abs(plant.gravity_torque + added[1]))))
    return replace(plant, link=replace(plant.link, inertia=inertia), gravity_torque=gravity)
