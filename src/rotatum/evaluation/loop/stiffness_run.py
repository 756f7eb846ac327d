"""Numbers of a closed loop on an estimated stiffness, and what came of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotatum.control.switching import Switching
from rotatum.errors import RotatumError

__all__ = ["LoopSettings", "StiffnessRun"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LoopSettings:
    """Numbers of the loop.

    Attributes
    ----------
    period : of control and estimation [s].
    motion, stiffness : angular frequency of the poles, critically damped [rad/s].
    motor : of the motors in position control [rad/s].
    velocity : bandwidth of the filters that make velocities of the encoders' positions [rad/s].
    share : of the motors' limits that is used; at the limit an estimator skips its samples.
    lenient : whether an estimate may be inconsistent, if its interval is that of an informative
        one. Rows of `residual` lag behind what they are compared with, and its verdict says so.
    switching : between the laws.
    """

    period: float = 1e-3
    motion: float = 16.0
    stiffness: float = 25.0
    motor: float = 60.0
    velocity: float = 200.0
    share: float = 0.95
    lenient: bool = False
    switching: Switching = field(default_factory=Switching)


@dataclass(frozen=True, eq=False)
class StiffnessRun:
    """A closed loop on an estimate: N instants.

    Attributes
    ----------
    time : (N,) s.
    q, sigma : (N,) true link position [rad] and total stiffness [N m/rad].
    columns : name -> (N,): "q_d", "sigma_d" references; "sigma_estimated", "sigma_std"
        [N m/rad]; "tau1", "tau2" commands [N m].
    verdict : (N,) as `rotatum.kernels.status.VERDICTS`.
    decoupled : (N,) whether the decoupling law was in charge.
    flags : (N,) of `rotatum.control.switching`.
    handed_over : when it first came to be [s]; None: never.
    """

    time: Array
    q: Array
    sigma: Array
    columns: Mapping[str, Array]
    verdict: NDArray[np.int64]
    decoupled: NDArray[np.bool_]
    flags: NDArray[np.int64]
    handed_over: float | None

    def errors(self, begin: float, end: float = math.inf) -> tuple[float, float]:
        """Return the largest errors of q and sigma_t, over their references' peak-to-peak there.

        Parameters
        ----------
        begin, end
            Of the stretch, since the hand-over [s].

        Raises `RotatumError` where there was no hand-over, or no such instants.
        """
        if self.handed_over is None:
            raise RotatumError("the decoupling law never came to be in charge", where="run")
        since = self.time - self.handed_over
        rows = (since >= begin) & (since < end)
        if not np.any(rows):
            raise RotatumError("the run has no such instants", where="run", value=(begin, end))
        found = []
        for true, name in ((self.q, "q_d"), (self.sigma, "sigma_d")):
            wanted = self.columns[name][rows]
            found.append(float(np.max(np.abs(true[rows] - wanted)) / np.ptp(wanted)))
        return found[0], found[1]
