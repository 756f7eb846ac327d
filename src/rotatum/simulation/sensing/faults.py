"""From a trajectory to what the sensors recorded of it: one function per stage."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.sensing.channel import Channel, quantise, wrapped
from rotatum.simulation.sensing.rows import lateness
from rotatum.simulation.sensing.sensors import Sensors
from rotatum.simulation.sensing.streams import STREAMS, runs, stream
from rotatum.simulation.sensing.trajectory import Trajectory

__all__ = ["STREAMS", "Channels", "quantise", "readings", "wrapped"]

Array = NDArray[np.float64]
Channels = dict[str, Array]


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
        channel = Channel(
            role,
            sensors,
            counts=counts.get(role),
            of_motor=role in trajectory.plant.motor_roles,
            seed=seed,
            number=number,
        )
        channels[role] = channel.show(_true_channel(trajectory.before(lag, every), role))
    channels = _with_stuck(channels, sensors, time)
    return _with_nans(_with_stale(channels, sensors, seed, number), sensors, seed, number)


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
