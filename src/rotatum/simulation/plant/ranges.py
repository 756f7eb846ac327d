"""Where a motion leaves the range of a transmission's law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rotatum.models.transmission import Transmission

# ranges are looked up at so many set-points at the most; between them they are lines
SETPOINTS = 64


def outside(
    transmission: Transmission,
    deflection: NDArray[np.float64],
    setpoint: NDArray[np.float64],
    half_play: float = 0.0,
) -> NDArray[np.bool]:
    """Return where (N,) the deflection or the set-point is outside its range; NaN is not.

    Parameters
    ----------
    deflection
        (N,) rad, without the preload.
    setpoint
        (N,) in the unit of the law.
    half_play
        rad by which play widens the range to either side.
    """
    finite = setpoint[np.isfinite(setpoint)]
    known = np.unique(finite) if finite.size else np.zeros(1)
    if known.size > SETPOINTS:
        known = np.linspace(known[0], known[-1], SETPOINTS)
    ends = np.array([transmission.limits(float(s)) for s in known])
    low, high = (np.interp(setpoint, known, ends[:, side]) for side in (0, 1))
    wrong: NDArray[np.bool] = (deflection < low - half_play) | (deflection > high + half_play)
    return wrong | setpoint_outside(transmission, setpoint)


def setpoint_outside(transmission: Transmission, setpoint: NDArray[np.float64]) -> NDArray[np.bool]:
    """Return where (N,) the set-point is outside the range of the law; NaN is not."""
    if not transmission.model.uses_setpoint:
        return np.zeros(setpoint.shape, dtype=np.bool)
    low, high = transmission.model.setpoint_limits(transmission.constants)
    return (setpoint < low) | (setpoint > high)
