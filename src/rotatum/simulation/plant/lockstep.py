"""Joints without an arm, each a pendulum of its own, moved in step where feedback looks at them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.march import March
from rotatum.simulation.plant.run import (
    Added,
    Course,
    course_of,
    run_plant,
    substeps_for,
    write_inputs,
)

__all__ = ["run_joints"]

Array = NDArray[np.float64]
Starts = Mapping[str, Mapping[str, float]]
_TRIES = 3  # hardening springs may ask for more sub-steps than at rest, as in `run_plant`


def run_joints(
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    *,
    start: Starts,
    added: Mapping[str, Added],
    substeps: int | None = None,
    progress: Callable[[int, int | None], None] | None = None,
) -> tuple[Course, ...]:
    """Return the motion of each plant under its inputs.

    Without feedback each runs for itself (`run_plant`). With it all go on together, one sample at
    a time, and feedback sees all of them where each of its control periods begins; its torques are
    written to ``inputs.tau``.

    Parameters
    ----------
    plants, inputs
        One for each joint.
    start
        joint -> where it starts.
    added
        joint -> what a payload adds to its link.
    substeps
        Integration steps per sample; chosen for each plant if not given.
    progress
        Called with samples done and expected.
    """
    if not any(row.feedback for row in inputs):
        return tuple(
            run_plant(
                plant,
                row,
                start=start.get(plant.name),
                substeps=substeps,
                added=added.get(plant.name),
            )
            for plant, row in zip(plants, inputs, strict=True)
        )
    period = float(inputs[0].time[1] - inputs[0].time[0])
    counts: list[int | None] = [substeps] * len(plants)
    for _ in range(_TRIES):
        courses = _together(plants, inputs, start, added, counts, progress)
        needed = [
            substeps_for(plant, period, course, substeps)
            for plant, course in zip(plants, courses, strict=True)
        ]
        if all(n <= course.substeps for n, course in zip(needed, courses, strict=True)):
            break
        counts = [max(n, course.substeps) for n, course in zip(needed, courses, strict=True)]
    return courses


def _together(
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    start: Starts,
    added: Mapping[str, Added],
    substeps: Sequence[int | None],
    progress: Callable[[int, int | None], None] | None,
) -> tuple[Course, ...]:
    time = inputs[0].time
    period = float(time[1] - time[0])
    marches, u, at = [], [], []
    for plant, row, count in zip(plants, inputs, substeps, strict=True):
        begin = dict(start.get(plant.name, {}))
        if row.angle is not None:
            begin["setpoint_angle"] = float(row.angle[0])
        prescribed = row.angle is not None
        march = March(plant, period, start=begin, substeps=count, prescribed=prescribed)
        rows = march.inputs(time.size)
        write_inputs(row, rows, effects=plant.effects, added=added.get(plant.name))
        marches.append(march)
        u.append(rows)
        at.append(march.outputs(time.size))
    for k in range(time.size):
        if k % inputs[0].control == 0:
            _ask(_seen(plants, marches, float(time[k]), u, k), inputs, u, k)
        for march, rows, out in zip(marches, u, at, strict=True):
            march.step(rows[k : k + 1], out[k : k + 1])
        if progress is not None and k % 1024 == 0:
            progress(k, time.size)
    parts = zip(plants, at, marches, strict=True)
    return tuple(course_of(plant, time, out, march) for plant, out, march in parts)


def _ask(seen: Seen, inputs: Sequence[Inputs], u: Sequence[Records], k: int) -> None:
    for row, rows in zip(inputs, u, strict=True):
        held = slice(k, k + row.control)
        for motor, feedback in row.feedback.items():
            tau = feedback.torque(seen)
            rows["tau"][held, motor] = tau
            row.tau[held, motor] = tau


def _seen(
    plants: Sequence[Plant], marches: Sequence[March], time: float, u: Sequence[Records], k: int
) -> Seen:
    """Return what feedback sees at sample k.

    The accelerations are those of the last part of the last Runge-Kutta step: at its end, to the
    third order in the step.
    """
    position = [march.state["position"][0] for march in marches]
    velocity = [march.state["velocity"][0] for march in marches]
    return Seen(
        time,
        np.array([x[0] for x in position]),
        np.array([x[0] for x in velocity]),
        {plant.name: x[1:-1] for plant, x in zip(plants, position, strict=True)},
        {plant.name: x[1:-1] for plant, x in zip(plants, velocity, strict=True)},
        np.array([march.state["acceleration"][0, 0] for march in marches]),
        {
            plant.name: rows["tau"][k - 1] if k else np.zeros(len(plant.motors))
            for plant, rows in zip(plants, u, strict=True)
        },
    )
