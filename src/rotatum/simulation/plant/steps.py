"""How many integration steps a plant needs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from rotatum.errors import RotatumError
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.params import STEP_RATE_LIMIT

__all__ = ["MOST_SUBSTEPS", "SUBSTEPS", "choose_substeps"]

SUBSTEPS = 10
# a fifth of RK4's stability limit is accurate for what friction stops
STEP_RATE = 0.5
# hysteresis swings on for a few turns only
STEP_HYSTERESIS = 0.2
# of its energy an undamped mode may lose in 10 s; the rest of 1e-6 is for hardening springs
ENERGY_LOSS = 2e-7
# a stiffer spring than this asks for has gone out of hand; more steps would only take longer
MOST_SUBSTEPS = 1000


def choose_substeps(
    plant: Plant,
    period: float,
    stiffness: Sequence[float],
    substeps: int | None = None,
    *,
    loads: Sequence[float] = (),
) -> int:
    """Return the sub-steps per sample: 10, or as many as the plant's fastest rates ask for.

    Classical Runge-Kutta takes ``(h w)^6 / 72`` of the energy of a mode w per step h, so that
    ``10 s w (h w)^5 / 72 <= 2e-7`` keeps it; friction rates r get ``h r <= 0.5``.

    Parameters
    ----------
    period
        Of the samples [s].
    stiffness, loads
        (M,) N m/rad and N m: the largest stiffness and elastic torque of each transmission.
    substeps
        Given instead.

    Raises `RotatumError` if more than 1000 are needed, saying what asks for them, or if `substeps`
    is given and the integration would be unstable with it.
    """
    if substeps is not None:
        return _stable(plant, period, plant.fastest_rate(stiffness, loads), substeps)
    wanted = _wanted(plant, period, stiffness, loads)
    most = max(wanted, key=lambda what: wanted[what])
    if not wanted[most] <= MOST_SUBSTEPS:
        raise _too_many(plant, period, most, wanted[most])
    return max(SUBSTEPS, math.ceil(wanted[most]))


def _wanted(
    plant: Plant, period: float, stiffness: Sequence[float], loads: Sequence[float]
) -> Mapping[str, float]:
    """Return what asks for how many sub-steps."""
    swing = plant.oscillation_rate(stiffness)
    longest = (72.0 * ENERGY_LOSS / (10.0 * swing)) ** 0.2 if swing > 0.0 else math.inf
    wanted = {
        "the elastic mode": swing * period / longest,
        "friction": plant.fastest_rate(stiffness, loads) * period / STEP_RATE,
    }
    if plant.hysteresis_stiffness > 0.0:
        stiffest = [abs(k) + plant.hysteresis_stiffness for k in stiffness]
        wanted["hysteresis"] = plant.oscillation_rate(stiffest) * period / STEP_HYSTERESIS
    return wanted


def _stable(plant: Plant, period: float, rate: float, substeps: int) -> int:
    least = max(1, math.ceil(rate * period / STEP_RATE_LIMIT))
    if substeps < least:
        raise RotatumError(
            "too few integration steps per sample for the fastest motion of this joint",
            where=f"{plant.name}, substeps",
            value=substeps,
            allowed=f"{least} or more",
        )
    return substeps


def _too_many(plant: Plant, period: float, what: str, wanted: float) -> RotatumError:
    ratio = wanted / MOST_SUBSTEPS
    remedies = {
        "friction": f", or a smoothing of {plant.smoothing * ratio:.2g} rad/s",
        "hysteresis": ", or a larger hysteresis_deflection",
    }
    return RotatumError(
        f"{what} of this joint is too fast for the period: it needs {wanted:.4g} integration steps "
        f"in each, of {MOST_SUBSTEPS} at the most",
        where=plant.name,
        value=period,
        allowed=f"periods up to {period / ratio:.2g} s{remedies.get(what, '')}",
    )
