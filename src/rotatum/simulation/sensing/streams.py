"""Where the random faults of a log draw from: a stream of its own for each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

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
    "jitter",
    "eccentricity.q",
    "eccentricity.theta",
    "eccentricity.theta1",
    "eccentricity.theta2",
    "eccentricity.setpoint",
    "delay_jitter.q",
    "delay_jitter.theta",
    "delay_jitter.theta1",
    "delay_jitter.theta2",
    "delay_jitter.setpoint",
    "delay_jitter.tau",
    "delay_jitter.tau1",
    "delay_jitter.tau2",
    "delay_jitter.torque_measured",
    "delay_jitter.torque_measured1",
    "delay_jitter.torque_measured2",
    "delay_jitter.tau_ext",
    "noise.accelerometer",
    "noise.gyroscope",
)


def stream(seed: int, fault: str, number: int = 0) -> np.random.Generator:
    """Return the generator of a fault of `STREAMS`.

    Parameters
    ----------
    seed
        Of the log.
    fault
        One of `STREAMS`.
    number
        Of the joint in its device, or of the inertial sensor.
    """
    place = STREAMS.index(fault)
    # not default_rng([seed, i]): for i = 0 that is the same stream as default_rng(seed)
    key = (place, number) if number else (place,)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def runs(
    fault: str, samples: int, count: int, rows: int, seed: int, number: int = 0
) -> NDArray[np.int64]:
    """Return the samples in `count` disjoint runs of `rows` each, never the first sample.

    Raises `RotatumError` if they do not fit into the samples.
    """
    slots = (samples - 1) // rows
    if count > slots:
        raise RotatumError(
            f"{count} runs of {rows} do not fit into {samples} samples",
            where=f"sensors.{fault}",
            value=count,
            allowed=f"at most {slots}",
        )
    starts = 1 + rows * stream(seed, fault, number).choice(slots, size=count, replace=False)
    return (starts[:, np.newaxis] + np.arange(rows)).ravel()
