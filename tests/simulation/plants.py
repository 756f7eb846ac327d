"""Plants made by hand, and a short way to run them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.models import Transmission
from rotatum.record import Records
from rotatum.simulation import Body, Plant
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.run import run_plant

PERIOD = 1e-3


def spring(law: str, **constants: float) -> Transmission:
    return Transmission.model_validate({"law": law, **constants})


# A robot's elbow: link 0.8 kg m^2, rotor 4e-5 kg m^2 behind a gear of 80, 200 N m/rad hardening.
JOINT = Plant(
    name="elbow",
    actuation="series",
    link=Body(0.8, 0.3, 0.1),
    motors=(Body(0.256, 0.35, 0.8),),
    transmissions=(spring("cubic", stiffness=200.0, cubic=600.0, damping=0.05),),
    gravity_torque=15.0,
)
FREE = replace(
    JOINT,
    link=Body(0.8),
    motors=(Body(0.256),),
    transmissions=(spring("cubic", stiffness=200.0, cubic=600.0),),
)
LINEAR = replace(FREE, gravity_torque=0.0, transmissions=(spring("linear", stiffness=200.0),))


def without_losses(plant: Plant) -> Plant:
    """Return a plant without friction anywhere."""
    moved = plant.setpoint_motor
    return replace(
        plant,
        link=Body(plant.link.inertia),
        motors=tuple(Body(motor.inertia) for motor in plant.motors),
        setpoint_motor=None if moved is None else Body(moved.inertia),
    )


def clock(seconds: float) -> NDArray[np.float64]:
    """Return instants 0 to `seconds`, both included."""
    return np.arange(round(seconds / PERIOD) + 1) * PERIOD


def drive(
    plant: Plant,
    seconds: float,
    *,
    tau: ArrayLike = 0.0,
    tau_ext: ArrayLike = 0.0,
    angle: ArrayLike | None = 0.0,
    tau_setpoint: ArrayLike = 0.0,
    start: Mapping[str, float] | None = None,
    substeps: int | None = None,
) -> Records:
    """Return the plant's outputs; `tau` is (N,), or (N, 2) for two motors."""
    time = clock(seconds)

    def filled(x: ArrayLike) -> NDArray[np.float64]:
        return np.broadcast_to(np.asarray(x, dtype=float), time.shape).copy()

    torques = np.asarray(tau, dtype=float)
    torques = torques if torques.ndim == 2 else np.tile(filled(tau)[:, None], len(plant.motors))
    inputs = Inputs(
        time=time,
        tau=torques,
        tau_ext=filled(tau_ext),
        angle=None if angle is None else filled(angle),
        tau_setpoint=filled(tau_setpoint),
    )
    course = run_plant(plant, inputs, start=start, substeps=substeps)
    if course.stopped is not None:
        raise course.stopped
    return course.at
