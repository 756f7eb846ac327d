"""The constants of a plant as the stages take them."""

from __future__ import annotations

import math
from collections.abc import Mapping

from rotatum.errors import RotatumError, check_names
from rotatum.record import Records
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.records import DYNAMIC, PRESCRIBED, QUASI_STATIC
from rotatum.simulation.plant.stage import plant_stage

__all__ = ["drive_of", "plant_params"]

# RK4 is stable up to step * rate = 2.78
STEP_RATE_LIMIT = 2.7


def drive_of(plant: Plant, step: float, *, prescribed: bool) -> int:
    """Return how the set-point moves, `records.PRESCRIBED`, `DYNAMIC` or `QUASI_STATIC`.

    A motor whose friction stops it faster than steps of `step` [s] can follow (the AwAS:
    D_c / B_c = 1.1e5 1/s) is taken without its inertia:
    ``Dc theta_c' + Cc sgn(theta_c') = tau_c - psi_e``.
    """
    if prescribed or plant.setpoint_motor is None:
        return PRESCRIBED
    too_fast = plant.setpoint_motor.rate(plant.smoothing) * step > STEP_RATE_LIMIT
    # without viscous friction nothing but its inertia says how fast it turns
    return QUASI_STATIC if too_fast and plant.setpoint_motor.damping > 0.0 else DYNAMIC


def plant_params(
    plant: Plant, start: Mapping[str, float], *, step: float, substeps: int, drive: int
) -> Records:
    """Return the params (1,) of the plant's stages (`plant_stage`, `train_stage`).

    Parameters
    ----------
    start
        Positions [rad] under their roles ("q", "theta", "setpoint_angle") and velocities [rad/s]
        under "d" and the role; what is not named is zero.
    step, substeps
        Runge-Kutta steps [s] and how many of them a sample has.
    drive
        From `drive_of`.

    Raises `RotatumError` for a start the joint does not have, or that is not a finite number.
    """
    params = plant_stage(plant.springs).params.zeros(1)
    bodies = [plant.link, *plant.motors]
    for name in ("inertia", "damping", "coulomb"):
        params[name][0, : len(bodies)] = [getattr(body, name) for body in bodies]
        if plant.setpoint_motor is not None:
            params[name][0, -1] = getattr(plant.setpoint_motor, name)
    position, velocity = _start(plant, start)
    params["start_position"], params["start_velocity"] = position, velocity
    for name in ("gravity_torque", "offset", "slope", "smoothing"):
        params[name] = getattr(plant, name)
    params["substeps"], params["step"], params["drive"] = substeps, step, drive
    for m, transmission in enumerate(plant.transmissions):
        params["preload"][0, m] = transmission.preload
        params["spring_damping"][0, m] = transmission.damping
        params[f"law{m}"][0] = transmission.constants
    _write_effects(plant, params)
    return params


def _write_effects(plant: Plant, params: Records) -> None:
    effects = plant.effects
    bodies = [plant.link, *plant.motors]
    for j, (body, stiction) in enumerate(zip(bodies, plant.stictions, strict=True)):
        params["excess"][0, j] = stiction - body.coulomb
    params["stribeck"] = effects.motor_stribeck
    params["stribeck"][0, 0] = effects.link_stribeck
    params["half_play"] = 0.5 * effects.backlash
    for name in ("load_friction", "hysteresis_torque", "hysteresis_deflection"):
        params[name] = getattr(effects, name)


def _start(plant: Plant, start: Mapping[str, float]) -> tuple[list[float], list[float]]:
    roles = ["q", *plant.motor_roles, "setpoint_angle"]
    allowed = [name for role in roles for name in (role, f"d{role}")]
    where = f"{plant.name}, start"
    check_names(start, allowed, what="a joint does not start with this", where=where)
    for name, value in start.items():
        if not math.isfinite(value):
            what = "a joint starts at finite numbers"
            raise RotatumError(what, where=f"{where}, {name}", value=value)
    position = [start.get(role, 0.0) for role in roles]
    return position, [start.get(f"d{role}", 0.0) for role in roles]
