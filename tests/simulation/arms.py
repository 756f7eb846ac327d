"""Arms with elastic joints made by hand, and a short way to run them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotatum import load_device
from rotatum.models.robot.interface import Robot
from rotatum.simulation import Body, Plant
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.arm import Arm
from rotatum.simulation.plant.arm_run import ArmCourse, run_arm
from rotatum.simulation.plant.bodies import SMOOTHING
from rotatum.simulation.plant.params import drive_of, plant_params
from rotatum.simulation.plant.train import trains_of
from rotatum.simulation.plants import plants_of

Array = NDArray[np.float64]
PERIOD = 1e-3


def without_losses(plants: Sequence[Plant]) -> list[Plant]:
    """Return plants whose motors, links and springs rub nowhere."""
    return [
        replace(
            plant,
            link=Body(1.0),
            motors=tuple(Body(motor.inertia) for motor in plant.motors),
            transmissions=tuple(t.model_copy(update={"damping": 0.0}) for t in plant.transmissions),
        )
        for plant in plants
    ]


def of_catalogue(name: str) -> tuple[Robot, list[Plant], Array]:
    """Return robot, plants and coupling of a catalogue's arm."""
    device = load_device(name)
    robot = device.build_robot()
    assert robot is not None
    assert device.robot is not None
    return robot, list(plants_of(device, {}, smoothing=SMOOTHING)), device.robot.coupling_matrix


def quiet(plants: Sequence[Plant], samples: int, period: float = PERIOD) -> list[Inputs]:
    """Return inputs that do nothing."""
    time = period * np.arange(samples)
    nothing = np.zeros(samples)
    return [
        Inputs(
            time=time,
            tau=np.zeros((samples, len(plant.motors))),
            tau_ext=nothing.copy(),
            angle=nothing.copy(),
            tau_setpoint=nothing.copy(),
        )
        for plant in plants
    ]


def make(
    robot: Robot,
    plants: Sequence[Plant],
    start: Sequence[Mapping[str, float]],
    coupling: Array | None = None,
    *,
    period: float = PERIOD,
) -> Arm:
    """Return an arm that stands where `start` says, joint by joint."""
    params = [
        plant_params(
            plant,
            begin,
            step=period,
            substeps=1,
            drive=drive_of(plant, period, prescribed=plant.setpoint_motor is None),
        )
        for plant, begin in zip(plants, start, strict=True)
    ]
    S = np.zeros((robot.size, robot.size)) if coupling is None else coupling
    return Arm(robot, plants, trains_of(plants, params), S)


def run(arm: Arm, inputs: Sequence[Inputs]) -> ArmCourse:
    """Return the arm's motion."""
    return run_arm(arm, inputs)


def column(course: ArmCourse, name: str) -> Array:
    """Return a scalar output (N, n) of all joints."""
    return np.column_stack([at[name] for at in course.at])
