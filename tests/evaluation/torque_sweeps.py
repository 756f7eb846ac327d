"""Slow sweeps of a joint against a torque sensor, with known constants: closed forms, no plant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum import Log
from rotatum.logs.clock import ClockWatch

Array = NDArray[np.float64]

MAKER_PRO = ((0.0227, 6.7328), (0.0216, 6.9602))  # k [N m], a [1/rad]: NMMI/ILC-code
TICK = 4.0 * np.pi / 65536  # rad, of its encoders
PERIOD = 0.02
NAME = "qbmove-maker-pro"


def log_of(columns: dict[str, Array], joint: str = NAME, period: float = PERIOD) -> Log:
    """Return the log of one joint."""
    time = np.arange(len(columns["q"]), dtype=np.float64) * period
    watch = ClockWatch(period)
    watch.add(time)
    return Log("sweep.csv", time, {joint: columns}, {joint: {}}, watch.clock())


def qbmove(
    seed: int = 0,
    *,
    presets: Sequence[float] = (0.0, 0.15, 0.3, 0.45, 0.6),
    samples: int = 400,
    reach: float = 0.2,
    noise: float = 0.01,
    offset: float = 0.05,
    slope: float = 0.0,
    colour: float = 0.0,
) -> dict[str, Array]:
    """Return a sine of the link at each preset; the sensor on the shaft reads both springs' sum.

    ``k1 sinh(a1 (q - x - d)) + k2 sinh(a2 (q - x + d)) + slope (q - x) + offset + noise``, the
    equilibrium x at 0, the positions counted, the noise of a first-order filter's colour.
    """
    swing = reach * np.sin(np.linspace(0.0, 2.0 * np.pi, samples))
    # A calibrated unit has its zeros on a count: presets are whole counts too.
    at = np.repeat(TICK * np.round(np.array(presets) / TICK), samples)
    q = np.tile(swing, len(presets))
    (k1, a1), (k2, a2) = MAKER_PRO
    tau = k1 * np.sinh(a1 * (q - at)) + k2 * np.sinh(a2 * (q + at)) + slope * q
    white = np.random.default_rng(seed).standard_normal(len(q))
    hiss = np.empty(len(q))
    last = 0.0
    for k, each in enumerate(white):
        last = colour * last + np.sqrt(1.0 - colour**2) * each
        hiss[k] = last
    counted = TICK * np.round(q / TICK)
    sensor = tau + offset + noise * hiss
    return {"q": counted, "theta1": at, "theta2": -at, "torque_measured": sensor}


def series(torque: Array, phi: Array, seed: int = 0, noise: float = 0.01) -> dict[str, Array]:
    """Return a joint with one spring, its motor moving along."""
    theta = 0.3 * np.sin(np.linspace(0.0, 3.0, len(phi)))
    hiss = noise * np.random.default_rng(seed).standard_normal(len(phi))
    return {"q": theta + phi, "theta": theta, "torque_measured": torque + hiss}
