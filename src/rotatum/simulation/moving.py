"""Move a device: an arm as one, joints without an arm each for itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.models.robot.interface import Robot
from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.motion import Motion, Truth
from rotatum.simulation.payload import Payload, added, loaded
from rotatum.simulation.plant.arm import Arm
from rotatum.simulation.plant.arm_run import run_arm
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.lockstep import run_joints
from rotatum.simulation.plant.params import drive_of, plant_params
from rotatum.simulation.plant.records import QUASI_STATIC
from rotatum.simulation.plant.run import course_warnings, left_out, until
from rotatum.simulation.plant.train import trains_of
from rotatum.simulation.sensing.trajectory import trajectory

if TYPE_CHECKING:
    from rotatum.errors import SimulationError
    from rotatum.models.device import Device

__all__ = ["Progress", "move"]

Progress = Callable[[int, int | None], None]
"""Called with samples done and samples expected."""


def move(
    device: Device,
    robot: Robot | None,
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    *,
    payloads: Sequence[Payload] = (),
    start: Mapping[str, Mapping[str, float]],
    substeps: int | None = None,
    progress: Progress | None = None,
) -> Motion:
    """Return how the device moves under the inputs of its joints.

    Parameters
    ----------
    robot
        Its links; None: pendulums.
    plants, inputs
        One for each joint.
    payloads
        Masses the links take up.
    start
        joint -> where it starts.
    substeps
        Integration steps per sample of joints without an arm.
    progress
        Called with samples done and expected.
    """
    if robot is not None:
        return _arm_motion(device, robot, plants, inputs, payloads, start, progress)
    return _pendulum_motion(plants, inputs, payloads, start, substeps, progress)


def _arm_motion(
    device: Device,
    robot: Robot,
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    payloads: Sequence[Payload],
    start: Mapping[str, Mapping[str, float]],
    progress: Progress | None,
) -> Motion:
    time = inputs[0].time
    period = float(time[1] - time[0])
    drives = [
        drive_of(plant, period, prescribed=row.angle is not None)
        for plant, row in zip(plants, inputs, strict=True)
    ]
    params = [
        plant_params(plant, start.get(plant.name, {}), step=period, substeps=1, drive=drive)
        for plant, drive in zip(plants, drives, strict=True)
    ]
    assert device.robot is not None  # it was built from it
    arm = Arm(robot, plants, trains_of(plants, params), device.robot.coupling_matrix)
    course = run_arm(
        arm,
        inputs,
        robots=loaded(robot, payloads, time),
        progress=progress,
    )
    warnings = tuple(
        sentence
        for plant, drive in zip(plants, drives, strict=True)
        if drive == QUASI_STATIC
        for sentence in left_out(plant, 1)
    )
    return _motion(plants, inputs, course.at, course.stopped, robot, warnings)


def _pendulum_motion(
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    payloads: Sequence[Payload],
    start: Mapping[str, Mapping[str, float]],
    substeps: int | None,
    progress: Progress | None,
) -> Motion:
    loads = added(payloads, [plant.name for plant in plants], inputs[0].time)
    courses = run_joints(
        plants, inputs, start=start, added=loads, substeps=substeps, progress=progress
    )
    stops = [course.stopped for course in courses if course.stopped is not None]
    # the joint that stopped first is the one to tell of
    first = min(courses, key=lambda course: course.at.size).stopped if stops else None
    warnings = tuple(
        sentence
        for plant, course in zip(plants, courses, strict=True)
        for sentence in course_warnings(plant, course)
    )
    return _motion(plants, inputs, [course.at for course in courses], first, None, warnings)


def _motion(
    plants: Sequence[Plant],
    inputs: Sequence[Inputs],
    at: Sequence[Records],
    stopped: SimulationError | None,
    robot: Robot | None,
    warnings: tuple[str, ...],
) -> Motion:
    done = min(records.size for records in at)
    joints, truth, acceleration = {}, {}, {}
    for plant, row, records in zip(plants, inputs, at, strict=True):
        good = records[:done]
        joints[plant.name] = trajectory(plant, until(row, done), good)
        truth[plant.name] = Truth(_columns(good["stiffness"]), _columns(good["torque"]))
        acceleration[plant.name] = np.ascontiguousarray(good["ddq"])
    return Motion(
        time=inputs[0].time[:done],
        joints=joints,
        truth=truth,
        acceleration=acceleration,
        robot=robot,
        warnings=warnings,
        stopped=stopped,
    )


def _columns(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    return tuple(np.ascontiguousarray(column) for column in x.T)
