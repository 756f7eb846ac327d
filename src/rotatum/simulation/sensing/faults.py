"""From a trajectory to what the sensors recorded of it: one function per stage."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.sensing.rows import lateness
from rotatum.simulation.sensing.sensors import Sensors
from rotatum.simulation.sensing.streams import STREAMS, runs, stream
from rotatum.simulation.sensing.trajectory import Trajectory

__all__ = ["STREAMS", "Channels", "quantise", "readings"]

Array = NDArray[np.float64]
Channels = dict[str, Array]

# Of a wrap: a reading this close below it is a count that was rounded, not a turn short of one.
_WRAP_ROUNDING = 1e-9


def readings(
    trajectory: Trajectory,
    sensors: Sensors,
    *,
    roles: tuple[str, ...],
    counts: Mapping[str, float],
    seed: int,
    number: int = 0,
    every: int = 1,
) -> Channels:
    """Return role -> (K,) readings [rad, N m] at the sample instants, all faults but lost rows.

    Parameters
    ----------
    trajectory, sensors
        What moved, and what watched it.
    roles
        The channels recorded, of `rotatum.simulation.sensing.sensors.ROLES`.
    counts
        Counts per turn of the encoders among them.
    seed
        Of all random faults.
    number
        Of the joint in its device: each has its own faults.
    every
        One in so many instants of the trajectory is sampled.
    """
    time = trajectory.time[::every]
    period = every * float(trajectory.time[1] - trajectory.time[0])
    late = lateness(time.size, sensors, period=period, seed=seed)
    channels: Channels = {}
    for role in roles:
        # a commanded torque is logged by the cycle that sends it, however late that is
        jitter = 0.0 if role in trajectory.held else late
        lag = _delay(sensors, role, time.size, seed, number) - jitter
        x = _true_channel(trajectory.before(lag, every), role)
        x = _eccentric(x, sensors, role, seed, number)
        if role in trajectory.plant.motor_roles:
            x = x - sensors.deflection_zero
        x = _measured(x, sensors, role, seed, number)
        channels[role] = _converted(x, sensors, role, counts)
    channels = _with_stuck(channels, sensors, time)
    return _with_nans(_with_stale(channels, sensors, seed, number), sensors, seed, number)


def quantise(x: Array, counts: float) -> Array:
    """Return angles (N,) [rad] rounded to the nearest of `counts` per turn."""
    step = 2.0 * math.pi / counts
    return step * np.round(x / step)


def wrapped(x: Array, wrap: float) -> Array:
    """Return angles (N,) [rad] that start again from zero at `wrap` [rad]."""
    rest = np.mod(x, wrap)
    return np.where(rest > (1.0 - _WRAP_ROUNDING) * wrap, 0.0, rest)


def _delay(sensors: Sensors, role: str, samples: int, seed: int, number: int) -> Array | float:
    delay = sensors.delay.get(role, 0.0)
    std = sensors.delay_jitter.get(role, 0.0)
    if std == 0.0:
        return delay
    drawn = stream(seed, f"delay_jitter.{role}", number).standard_normal(samples)
    return np.maximum(delay + std * drawn, 0.0)


def _true_channel(motion: Trajectory, role: str) -> Array:
    # a sensor in the drive train feels the whole transmitted torque, spring damping included
    if role == "torque_measured":
        total: Array = np.sum(motion.transmitted, axis=0)
        return total
    if role in ("torque_measured1", "torque_measured2"):
        return motion.transmitted[int(role[-1]) - 1]
    return motion.held[role] if role in motion.held else motion.position[role]


def _eccentric(x: Array, sensors: Sensors, role: str, seed: int, number: int) -> Array:
    if sensors.eccentricity.get(role, 0.0) == 0.0:
        return x
    phase = stream(seed, f"eccentricity.{role}", number).uniform(0.0, 2.0 * math.pi)
    turns = sensors.eccentricity_turns.get(role, 1.0)
    return x + sensors.eccentricity[role] * np.sin(turns * x + phase)


def _measured(x: Array, sensors: Sensors, role: str, seed: int, number: int) -> Array:
    """Return what the electronics make of a channel, (K,)."""
    if role in sensors.gain:
        x = sensors.gain[role] * x
    if role in sensors.offset:
        x = x + sensors.offset[role]
    if sensors.noise.get(role, 0.0) > 0.0:
        noise = stream(seed, f"noise.{role}", number).standard_normal(x.size)
        x = x + sensors.noise[role] * noise
    return x


def _converted(x: Array, sensors: Sensors, role: str, counts: Mapping[str, float]) -> Array:
    """Return the numbers that come out of the converter or the counter, (K,), a fresh array."""
    if role in sensors.saturation:
        x = np.clip(x, -sensors.saturation[role], sensors.saturation[role])
    x = quantise(x, counts[role]) if role in counts else x.copy()
    return wrapped(x, sensors.wrap[role]) if role in sensors.wrap else x


def _with_stuck(channels: Channels, sensors: Sensors, time: Array) -> Channels:
    for role, (start, seconds) in sensors.stuck.items():
        if role not in channels:
            continue
        # half a thousandth of a period: an instant that rounding puts before `start` is in
        slack = 5e-4 * float(time[1] - time[0])
        span = (time >= start - slack) & (time < start + seconds - slack)
        if span.any():
            first = int(np.argmax(span))
            channels[role][span] = channels[role][max(first - 1, 0)]
    return channels


def _with_stale(channels: Channels, sensors: Sensors, seed: int, number: int) -> Channels:
    samples = next(iter(channels.values())).size
    shown = np.arange(samples)
    shown[runs("stale", samples, sensors.stale, 1, seed, number)] = 0
    shown = np.maximum.accumulate(shown)
    return {role: x[shown] for role, x in channels.items()}


def _with_nans(channels: Channels, sensors: Sensors, seed: int, number: int) -> Channels:
    samples = next(iter(channels.values())).size
    rows = runs("nans", samples, sensors.nans, sensors.nan_rows, seed, number)
    drawn = stream(seed, "nan channel", number).integers(len(channels), size=sensors.nans)
    hit = np.repeat(drawn, sensors.nan_rows)
    for place, x in enumerate(channels.values()):
        x[rows[hit == place]] = np.nan
    return channels
