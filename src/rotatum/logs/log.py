"""The one type of log: arrays by joint and role, in SI units at the joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotatum.logs.clock import Clock

__all__ = ["Log"]


@dataclass(frozen=True)
class Log:
    """A recorded log, or a piece of one.

    Parameters
    ----------
    source : the file it came from.
    time : (N,) [s], as recorded: not necessarily from zero, even or increasing.
    joints : joint -> role -> (N,) values: angles [rad], torques [N m], all at the joint;
        missing and infinite values are NaN.
    holds : joint -> role -> "sampled" or "held".
    clock : period, jitter and gaps of the clock.
    warnings : sentences about what is odd in the log.
    inertial : accelerometer or gyroscope -> "ax", "ay", "az" [m/s^2] or "gx", "gy", "gz" [rad/s]
        -> (N,), in the sensor's own axes; missing and infinite values are NaN.
    inertial_warnings : sentences about what is odd in them, for who reads them.
    """

    source: str
    time: NDArray[np.float64]
    joints: Mapping[str, Mapping[str, NDArray[np.float64]]]
    holds: Mapping[str, Mapping[str, str]]
    clock: Clock
    warnings: tuple[str, ...] = ()
    inertial: Mapping[str, Mapping[str, NDArray[np.float64]]] = field(default_factory=dict)
    inertial_warnings: tuple[str, ...] = ()

    @property
    def period(self) -> float:
        """Sample period [s]."""
        return self.clock.period

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.time.size)

    @property
    def inertial_roles(self) -> Mapping[str, tuple[str, ...]]:
        """Accelerometer or gyroscope -> axes the log has of it."""
        return {sensor: tuple(axes) for sensor, axes in self.inertial.items()}

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """Return the log in canonical columns, for `write_table`.

        `time`, `<joint>.<role>` and, of inertial sensors, `<sensor>.<axis>`.
        """
        table = {"time": self.time}
        for name, parts in (*self.joints.items(), *self.inertial.items()):
            table.update({f"{name}.{part}": values for part, values in parts.items()})
        return table
