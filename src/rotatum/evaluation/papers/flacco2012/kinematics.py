"""The modified kinematic filter on a whole channel, and what it is compared with."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.case import Curve, Plot, Value
from rotatum.evaluation.papers.flacco2012.modality import SCORED_FROM
from rotatum.evaluation.papers.flacco2012.settings import ACCELERATION, BOUNDS, STEEPNESS, Bounds
from rotatum.kernels import kinematic

__all__ = ["compared", "differenced", "filtered", "rms"]

Array = NDArray[np.float64]


def filtered(
    readings: Array, period: float, counts: float, bounds: Bounds = BOUNDS
) -> tuple[Array, Array]:
    """Return position [rad] and velocity [rad/s] of eqs 18-20, (N,) each.

    Args:
        readings: (N,) of an encoder, rad.
        period: s.
        counts: per turn.
        bounds: of its variance.
    """
    params = SimpleNamespace(
        period=period,
        mode=kinematic.MODIFIED,
        acceleration=ACCELERATION,
        largest=bounds.largest,
        smallest=bounds.smallest,
        steepness=STEEPNESS,
        count_speed=2.0 * math.pi / counts / period,
    )
    state = SimpleNamespace(position=0.0, velocity=0.0, pp=0.0, pv=0.0, vv=0.0, count=0)
    kinematic.start(params, state, float(readings[0]))
    found = [(state.position, state.velocity)]
    for reading in readings[1:].tolist():
        kinematic.observe(params, state, reading)
        found.append((state.position, state.velocity))
    position, velocity = np.array(found).T
    return position, velocity


def differenced(readings: Array, period: float) -> Array:
    """Return the backward difference of readings (N,) over the period, 0 at the first."""
    return np.diff(readings, prepend=readings[0]) / period


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def compared(
    what: str, t: Array, readings: Array, positions: Array, counts: float
) -> tuple[tuple[Value, ...], tuple[Plot, ...]]:
    """Compare differencing and filter on a motor: rms errors, and plots of both.

    Args:
        what: name of the velocity.
        t: (N,) s.
        readings: (N,) of the encoder, rad.
        positions: (N,) where the motor truly was, rad.
        counts: of the encoder per turn.
    """
    period = float(t[1] - t[0])
    actual = np.gradient(positions, period)
    found = {
        "differencing": differenced(readings, period),
        "MKKF": filtered(readings, period, counts)[1],
    }
    seen = t >= SCORED_FROM
    values = tuple(
        Value(f"{what}: rms error, {name}", "rad/s", own=rms((x - actual)[seen]))
        for name, x in found.items()
    )
    curves = (
        Curve("differencing", t, found["differencing"], "dotted"),
        Curve("actual", t, actual, "dashed"),
        Curve("MKKF", t, found["MKKF"]),
    )
    errors = (
        Curve("differencing", t, found["differencing"] - actual, "dotted"),
        Curve("MKKF", t, found["MKKF"] - actual),
    )
    return values, (Plot("velocity, rad/s", curves), Plot("its error, rad/s", errors))
