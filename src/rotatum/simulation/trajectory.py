"""What a simulated joint really did, at the sample instants and in between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Trajectory:
    """Motion and torques of a joint before any sensor saw them.

    Attributes
    ----------
    time
        (N,) s, evenly spaced.
    q, dq, theta, dtheta
        (N,) rad and rad/s, joint side, at the instants.
    tau, tau_ext
        (N,) N m, joint side, constant from each instant to the next.
    """

    time: NDArray[np.float64]
    q: NDArray[np.float64]
    dq: NDArray[np.float64]
    theta: NDArray[np.float64]
    dtheta: NDArray[np.float64]
    tau: NDArray[np.float64]
    tau_ext: NDArray[np.float64]

    def before(self, seconds: float) -> Trajectory:
        """Return the motion `seconds` before each instant, on the same clock.

        Positions follow the cubic through both ends of their interval (fourth order in the
        period: the torques jump at the instants only), velocities its slope. Before the first
        instant the joint stood where it started and no torque acted.
        """
        if seconds == 0.0:
            return self
        period = float(self.time[1] - self.time[0])
        # in samples; rounding here keeps a delay of whole samples a plain shift
        lag = round(seconds / period, 9)
        whole = int(np.ceil(lag))
        part = whole - lag
        left = np.arange(self.time.size) - whole
        q, dq = _cubic(self.q, self.dq, left, part, period)
        theta, dtheta = _cubic(self.theta, self.dtheta, left, part, period)
        inside = left >= 0
        held = np.maximum(left, 0)
        tau = np.where(inside, self.tau[held], 0.0)
        tau_ext = np.where(inside, self.tau_ext[held], 0.0)
        return Trajectory(self.time, q, dq, theta, dtheta, tau, tau_ext)


def _cubic(
    x: NDArray[np.float64],
    dx: NDArray[np.float64],
    left: NDArray[np.int64],
    part: float,
    period: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return value and slope (N,) of the cubic Hermite ``left + part`` samples on, part < 1."""
    i = np.maximum(left, 0)
    j = np.minimum(i + 1, x.size - 1)
    u, v = part, 1.0 - part
    value = v * v * ((1 + 2 * u) * x[i] + u * period * dx[i])
    value += u * u * ((1 + 2 * v) * x[j] - v * period * dx[j])
    slope = 6 * u * v * (x[j] - x[i]) / period
    slope += v * (v - 2 * u) * dx[i] + u * (u - 2 * v) * dx[j]
    before_start = left < 0
    return np.where(before_start, x[0], value), np.where(before_start, 0.0, slope)
