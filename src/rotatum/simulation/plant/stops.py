"""Where and why a motion cannot be believed any longer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import SimulationError
from rotatum.record import Records
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.ranges import outside, setpoint_outside

__all__ = ["failure", "first_wrong"]


def first_wrong(plant: Plant, at: Records) -> int | None:
    """Return the first of the samples (N,) at which a law's range is left or the motion diverged.

    Ranges are looked at at the samples, not in between.
    """
    wrong: NDArray[np.bool] = at["valid"] == 0
    half = 0.5 * plant.effects.backlash
    for m, spring in enumerate(plant.transmissions):
        wrong |= outside(spring, at["deflection"][:, m], at["setpoint"], half)
    return int(np.argmax(wrong)) if wrong.any() else None


def failure(plant: Plant, time: float, row: Records) -> SimulationError:
    """Return the error of a motion that went wrong.

    Parameters
    ----------
    time
        When [s].
    row
        (1,) output of the plant's stage then.
    """
    where = f"{plant.name}, t = {time:.6g} s"
    half = 0.5 * plant.effects.backlash
    for m, spring in enumerate(plant.transmissions):
        if not outside(spring, row["deflection"][:, m], row["setpoint"], half)[0]:
            continue
        name = f"transmission {m + 1}" if len(plant.transmissions) > 1 else "the transmission"
        law = f'of {name}, law "{spring.model.name}"'
        setpoint, deflection = float(row["setpoint"][0]), float(row["deflection"][0, m])
        if setpoint_outside(spring, row["setpoint"])[0]:
            ends, unit = spring.model.setpoint_limits(spring.constants), spring.model.setpoint_unit
            return _left(f"the set-point {law},", where, setpoint, ends, unit)
        low, high = spring.limits(setpoint)
        return _left(f"the deflection {law},", where, deflection, (low - half, high + half), "rad")
    phi = ", ".join(f"{x:.6g}" for x in row["deflection"][0])
    return SimulationError(
        f"the simulated joint ran away, at a deflection of {phi} rad",
        where=where,
        hint="Lower the torques, check the signs of the law's constants, or give more substeps.",
    )


def _left(
    what: str, where: str, value: float, ends: tuple[float, float], unit: str
) -> SimulationError:
    return SimulationError(
        f"{what} leaves its range",
        where=where,
        value=float(f"{value:.6g}"),
        allowed=f"{ends[0]:.6g} to {ends[1]:.6g} {unit}",
        hint="Lower the torques, or take a transmission or set-point that bears them.",
    )
