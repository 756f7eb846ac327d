"""The one type of log: arrays by joint and role, in SI units at the joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

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
    """

    source: str
    time: NDArray[np.float64]
    joints: Mapping[str, Mapping[str, NDArray[np.float64]]]
    holds: Mapping[str, Mapping[str, str]]
    clock: Clock
    warnings: tuple[str, ...] = ()

    @property
    def period(self) -> float:
        """Sample period [s]."""
        return self.clock.period

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.time.size)

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """Return the log in canonical columns, `time` and `<joint>.<role>`, for `write_table`."""
        table = {"time": self.time}
        for joint, roles in self.joints.items():
            table.update({f"{joint}.{role}": values for role, values in roles.items()})
        return table
