"""The same estimator of one joint as one would put it together from padasip and filterpy.

A Kalman filter for each encoder, the motor's balance and the basis through the same low-pass,
recursive least squares, stiffness and torque. It has no guard, no interval and no verdict.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray
from padasip.filters import FilterRLS


class Pipeline:
    """One joint.

    Args:
        params: one record of the stage's params: the same constants.
    """

    def __init__(self, params: Any) -> None:
        rows = params["inner"]["rows"]
        self.weak, self.scale = rows["weak"], float(rows["basis"]["scale"])
        self.period, self.gain = float(self.weak["period"]), 1.0 - float(rows["operator"]["pole"])
        self.bandwidth = 1.0 / self.period
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.filters = [self._kalman(), self._kalman()]
        self.rls = FilterRLS(n=4, mu=0.9999, eps=1e-8, w="zeros")
        self.first: NDArray[np.float64] = np.zeros(5)
        self.second: NDArray[np.float64] = np.zeros(5)
        self.velocity = 0.0

    def _kalman(self) -> KalmanFilter:
        found = KalmanFilter(dim_x=2, dim_z=1)
        T = self.period
        found.F = np.array([[1.0, T], [0.0, 1.0]])
        found.H = np.array([[1.0, 0.0]])
        found.Q = self.bandwidth**4 * np.array([[T**4 / 4, T**3 / 2], [T**3 / 2, T * T]])
        return found

    def update(self, q: float, theta: float, tau: float) -> tuple[float, float]:
        """Take one sample; return stiffness and elastic torque."""
        for kalman, z in zip(self.filters, (q, theta), strict=True):
            kalman.predict()
            kalman.update(z)
        link, motor = (kalman.x[:, 0] for kalman in self.filters)
        acceleration = (motor[1] - self.velocity) / self.period
        self.velocity = motor[1]
        x = (link[0] - motor[0]) / self.scale
        weak = self.weak
        friction = weak["damping"] * motor[1] + weak["coulomb"] * np.sign(motor[1])
        y = weak["inertia"] * acceleration + friction - tau
        raw = np.array([y, x, x**3, x**5, 1.0])
        self.first += self.gain * (raw - self.first)
        self.second += self.gain * (self.first - self.second)
        self.rls.adapt(self.second[0], self.second[1:])
        alpha = self.rls.w
        stiffness = np.array([1.0, 3.0 * x**2, 5.0 * x**4]) @ alpha[:3] / self.scale
        torque = np.array([x, x**3, x**5]) @ alpha[:3]
        return float(stiffness), float(torque)
