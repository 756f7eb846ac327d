"""From a trajectory to what the sensors recorded of it: one function per stage."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.sensing.sensors import Sensors
from rotatum.simulation.sensing.trajectory import Trajectory

Channels = dict[str, NDArray[np.float64]]

# Every fault draws from its own stream, numbered by its place here, so that switching one on
# or off changes no other. Append only: another order changes the logs of every seed.
STREAMS = (
    "noise.q",
    "noise.theta",
    "noise.tau",
    "noise.torque_measured",
    "noise.tau_ext",
    "stale",
    "nans",
    "nan channel",
    "repeats",
    "dropouts",
    "noise.theta1",
    "noise.theta2",
    "noise.setpoint",
    "noise.tau1",
    "noise.tau2",
    "noise.torque_measured1",
    "noise.torque_measured2",
)


def readings(
    trajectory: Trajectory,
    sensors: Sensors,
    *,
    roles: tuple[str, ...],
    counts: Mapping[str, float],
    seed: int,
) -> Channels:
    """Return role -> (N,) readings [rad, N m] at the sample instants, all faults but lost rows.

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
    """
    channels: Channels = {}
    for role in roles:
        x = _true_channel(trajectory.before(sensors.delay.get(role, 0.0)), role)
        if role in trajectory.plant.motor_roles:
            x = x - sensors.deflection_zero
        if sensors.noise.get(role, 0.0) > 0.0:
            x = x + sensors.noise[role] * _stream(seed, f"noise.{role}").standard_normal(x.size)
        channels[role] = quantise(x, counts[role]) if role in counts else x.copy()
    return _with_nans(_with_stale(channels, sensors, seed), sensors, seed)


def logged_rows(samples: int, sensors: Sensors, *, seed: int) -> NDArray[np.int64]:
    """Return the sample number behind each row of the log: repeats twice, dropouts not at all."""
    repeated = _runs("repeats", samples, sensors.repeats, 1, seed)
    times = np.ones(samples, dtype=np.int64)
    times[repeated] = 2
    times[_runs("dropouts", samples, sensors.dropouts, sensors.dropout_rows, seed)] = 0
    return np.repeat(np.arange(samples), times)


def quantise(x: NDArray[np.float64], counts: float) -> NDArray[np.float64]:
    """Return angles (N,) [rad] rounded to the nearest of `counts` per turn."""
    step = 2.0 * math.pi / counts
    return step * np.round(x / step)


def _true_channel(motion: Trajectory, role: str) -> NDArray[np.float64]:
    # a sensor in the drive train feels the whole transmitted torque, spring damping included
    if role == "torque_measured":
        total: NDArray[np.float64] = np.sum(motion.transmitted, axis=0)
        return total
    if role in ("torque_measured1", "torque_measured2"):
        return motion.transmitted[int(role[-1]) - 1]
    return motion.held[role] if role in motion.held else motion.position[role]


def _with_stale(channels: Channels, sensors: Sensors, seed: int) -> Channels:
    samples = next(iter(channels.values())).size
    shown = np.arange(samples)
    shown[_runs("stale", samples, sensors.stale, 1, seed)] = 0
    shown = np.maximum.accumulate(shown)
    return {role: x[shown] for role, x in channels.items()}


def _with_nans(channels: Channels, sensors: Sensors, seed: int) -> Channels:
    samples = next(iter(channels.values())).size
    rows = _runs("nans", samples, sensors.nans, sensors.nan_rows, seed)
    drawn = _stream(seed, "nan channel").integers(len(channels), size=sensors.nans)
    hit = np.repeat(drawn, sensors.nan_rows)
    for number, x in enumerate(channels.values()):
        x[rows[hit == number]] = np.nan
    return channels


def _runs(fault: str, samples: int, runs: int, rows: int, seed: int) -> NDArray[np.int64]:
    """Return the samples in `runs` disjoint runs of `rows` each, never the first sample."""
    slots = (samples - 1) // rows
    if runs > slots:
        raise RotatumError(
            f"{runs} runs of {rows} do not fit into {samples} samples",
            where=f"sensors.{fault}",
            value=runs,
            allowed=f"at most {slots}",
        )
    starts = 1 + rows * _stream(seed, fault).choice(slots, size=runs, replace=False)
    return (starts[:, np.newaxis] + np.arange(rows)).ravel()


def _stream(seed: int, fault: str) -> np.random.Generator:
    # not default_rng([seed, i]): for i = 0 that is the same stream as default_rng(seed)
    key = (STREAMS.index(fault),)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
