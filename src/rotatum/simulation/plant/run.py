"""Run a plant in time: sub-steps chosen, the compiled stage run, and its motion looked at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.dynamics import DYNAMIC, PRESCRIBED, QUASI_STATIC
from rotatum.simulation.plant.ranges import outside, setpoint_outside
from rotatum.simulation.plant.stage import plant_stage

SUBSTEPS = 10
# RK4 is stable up to step * rate = 2.78; a fifth of that is accurate for what friction stops, and
# a fourteenth for what swings on: (0.2)^6 / 72 = 1e-6 of its energy is lost in a step
STEP_RATE = 0.5
STEP_SWING = 0.2
STEP_RATE_LIMIT = 2.7
# a stiffer spring than this asks for has gone out of hand; more steps would only take longer
MOST_SUBSTEPS = 1000


class Course(NamedTuple):
    """What a plant did.

    Args:
        at: (N,) records, `rotatum.simulation.plant.dynamics.PlantOutput`.
        substeps: Runge-Kutta steps per sample.
        quasi_static: whether the set-point motor was taken without its inertia.
    """

    at: Records
    substeps: int
    quasi_static: bool


def run_plant(
    plant: Plant,
    inputs: Inputs,
    *,
    start: Mapping[str, float] | None = None,
    substeps: int | None = None,
) -> Course:
    """Return the plant's motion under the inputs.

    Classical Runge-Kutta with 10 sub-steps per sample, or as many as the fastest rate asks for,
    also at the stiffest deflections of the motion. A set-point motor whose friction stops it
    faster than those sub-steps can follow (the AwAS: D_c / B_c = 1.1e5 1/s) is taken without its
    inertia: ``Dc theta_c' + Cc sgn(theta_c') = tau_c - psi_e``. Ranges are looked at at the
    samples, not in between.

    Parameters
    ----------
    start
        Positions [rad] under their roles ("q", "theta", "setpoint_angle") and velocities [rad/s]
        under "d" and the role; what is not named is zero. A prescribed set-point goes its own way.
    substeps
        Runge-Kutta steps per sample.

    Raises `RotatumError` if `substeps` are so few that the integration is unstable, and for a
    motion that runs away or leaves a law's range, naming transmission, time and deflection.
    """
    period = float(inputs.time[1] - inputs.time[0])
    setpoint = float(plant.offset + plant.slope * _first_angle(inputs, start))
    count = choose_substeps(plant, period, plant.rest_stiffness(setpoint), substeps)
    course, wrong = _run(plant, inputs, start, count)
    # a hardening spring may ask for more than it did at rest, and show it only on the way
    for _ in range(2):
        good = course.at["stiffness"][: wrong if wrong is not None else None]
        stiffest = tuple(np.max(np.abs(good), axis=0, initial=0.0).tolist())
        count = choose_substeps(plant, period, stiffest, substeps)
        if not course.substeps < count <= MOST_SUBSTEPS:
            break
        course, wrong = _run(plant, inputs, start, count)
    if wrong is not None:
        raise _failure(plant, inputs.time, course.at, wrong)
    return course


def choose_substeps(
    plant: Plant, period: float, stiffness: tuple[float, ...], substeps: int | None = None
) -> int:
    """Return the sub-steps per sample: 10, or as many as the plant's fastest rate asks for.

    Raises `RotatumError` if `substeps` is given and the integration would be unstable with it.
    """
    rate = plant.fastest_rate(stiffness) * period
    if substeps is None:
        swing = plant.oscillation_rate(stiffness) * period
        return max(SUBSTEPS, math.ceil(rate / STEP_RATE), math.ceil(swing / STEP_SWING))
    if substeps < 1 or rate / substeps > STEP_RATE_LIMIT:
        raise RotatumError(
            "too few integration steps per sample for the fastest motion of this joint",
            where=f"{plant.name}, substeps",
            value=substeps,
            allowed=f"{max(1, math.ceil(rate / STEP_RATE_LIMIT))} or more",
        )
    return substeps


def _run(
    plant: Plant, inputs: Inputs, start: Mapping[str, float] | None, substeps: int
) -> tuple[Course, int | None]:
    """Return the motion and the first sample at which something is wrong with it."""
    stage = plant_stage(plant.springs)
    step = float(inputs.time[1] - inputs.time[0]) / substeps
    drive = _drive(plant, inputs, step)
    params = _params(plant, start or {}, step=step, substeps=substeps, drive=drive)
    u = stage.input.zeros(inputs.time.size, 1)
    u["tau"][:, 0] = inputs.tau
    u["tau_ext"][:, 0] = inputs.tau_ext
    u["tau_setpoint"][:, 0] = inputs.tau_setpoint
    if inputs.angle is not None:
        u["angle"][:, 0] = inputs.angle
        u["next_angle"][:-1, 0] = inputs.angle[1:]
        u["next_angle"][-1, 0] = inputs.angle[-1]
    at = Bank(stage, params).run(u)[:, 0]
    return Course(at, substeps, drive == QUASI_STATIC), _first_wrong(plant, at)


def _drive(plant: Plant, inputs: Inputs, step: float) -> int:
    if inputs.angle is not None or plant.setpoint_motor is None:
        return PRESCRIBED
    too_fast = plant.setpoint_motor.rate(plant.smoothing) * step > STEP_RATE_LIMIT
    # without viscous friction nothing but its inertia says how fast it turns
    return QUASI_STATIC if too_fast and plant.setpoint_motor.damping > 0.0 else DYNAMIC


def _params(
    plant: Plant, start: Mapping[str, float], *, step: float, substeps: int, drive: int
) -> Records:
    params = plant_stage(plant.springs).params.zeros(1)
    bodies = [plant.link, *plant.motors]
    roles = ["q", *plant.motor_roles, "setpoint_angle"]
    unknown = sorted(set(start) - set(roles) - {f"d{role}" for role in roles})
    if unknown:
        allowed = [name for role in roles for name in (role, f"d{role}")]
        raise RotatumError(
            "a joint does not start with this",
            where=f"{plant.name}, start",
            value=unknown[0],
            allowed=allowed,
        )
    for name in ("inertia", "damping", "coulomb"):
        params[name][0, : len(bodies)] = [getattr(body, name) for body in bodies]
        if plant.setpoint_motor is not None:
            params[name][0, -1] = getattr(plant.setpoint_motor, name)
    params["start_position"][0] = [start.get(role, 0.0) for role in roles]
    params["start_velocity"][0] = [start.get(f"d{role}", 0.0) for role in roles]
    for name in ("gravity_torque", "offset", "slope", "smoothing"):
        params[name] = getattr(plant, name)
    params["substeps"], params["step"], params["drive"] = substeps, step, drive
    for m, transmission in enumerate(plant.transmissions):
        params["preload"][0, m] = transmission.preload
        params["spring_damping"][0, m] = transmission.damping
        params[f"law{m}"][0] = transmission.constants
    return params


def _first_angle(inputs: Inputs, start: Mapping[str, float] | None) -> float:
    if inputs.angle is not None:
        return float(inputs.angle[0])
    return (start or {}).get("setpoint_angle", 0.0)


def _first_wrong(plant: Plant, at: Records) -> int | None:
    wrong: NDArray[np.bool] = at["valid"] == 0
    for m, transmission in enumerate(plant.transmissions):
        wrong |= outside(transmission, at["deflection"][:, m], at["setpoint"])
    return int(np.argmax(wrong)) if wrong.any() else None


def _failure(plant: Plant, time: NDArray[np.float64], at: Records, sample: int) -> RotatumError:
    """Return the error of a motion that went wrong at a sample."""
    row = at[sample : sample + 1]
    where = f"{plant.name}, t = {time[sample]:.6g} s"
    for m, spring in enumerate(plant.transmissions):
        if not outside(spring, row["deflection"][:, m], row["setpoint"])[0]:
            continue
        name = f"transmission {m + 1}" if len(plant.transmissions) > 1 else "the transmission"
        law = f'of {name}, law "{spring.model.name}"'
        setpoint, deflection = float(row["setpoint"][0]), float(row["deflection"][0, m])
        if setpoint_outside(spring, row["setpoint"])[0]:
            ends, unit = spring.model.setpoint_limits(spring.constants), spring.model.setpoint_unit
            return _left(f"the set-point {law},", where, setpoint, ends, unit)
        return _left(f"the deflection {law},", where, deflection, spring.limits(setpoint), "rad")
    phi = ", ".join(f"{x:.6g}" for x in row["deflection"][0])
    return RotatumError(
        f"the simulated joint ran away, at a deflection of {phi} rad",
        where=where,
        hint="Lower the torques, check the signs of the law's constants, or give more substeps.",
    )


def _left(
    what: str, where: str, value: float, ends: tuple[float, float], unit: str
) -> RotatumError:
    return RotatumError(
        f"{what} leaves its range",
        where=where,
        value=float(f"{value:.6g}"),
        allowed=f"{ends[0]:.6g} to {ends[1]:.6g} {unit}",
        hint="Lower the torques, or take a transmission or set-point that bears them.",
    )
