"""Positions and velocities of an antagonistic joint from its encoders, ahead by the model."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState
from rotatum.estimators.gains import steady_gains
from rotatum.kernels import kinematic
from rotatum.models.elastic import ElasticLaw

__all__ = ["MotionFilter"]


class MotionFilter:
    """Steady kinematic Kalman filters of link and motors, with the accelerations that are known.

    The filters alone (`rotatum.kernels.kinematic`) take the acceleration for noise: their velocity
    is late by about ``sqrt(2) / bandwidth``. Where motors are damped much, as by the back-EMF of a
    voltage servo, a controller that feeds such a velocity back against the damping makes the rotor
    D times that lag heavier. So each filter is moved on by what torques and springs do, as far as
    they are known, before it looks at its encoder.

    Parameters
    ----------
    joint
        Its constants.
    bandwidth
        Of the filters [rad/s].
    period
        Between two calls [s].
    """

    def __init__(self, joint: AntagonisticJoint, bandwidth: float, period: float) -> None:
        self.joint, self.period = joint, period
        alpha, beta = steady_gains(bandwidth, period)
        self._params = SimpleNamespace(
            period=period, mode=0, position_gain=alpha, velocity_gain=beta,
            largest=0.0, acceleration=0.0,
        )  # fmt: skip
        self._own: list[Any] = []

    def look(self, q: float, theta: tuple[float, float]) -> JointState:
        """Return the state at an instant, its positions read there [rad]."""
        if not self._own:
            self._own = [SimpleNamespace() for _ in range(3)]
            for own, x in zip(self._own, (q, *theta), strict=True):
                kinematic.start(self._params, own, x)
        else:
            for own, x in zip(self._own, (q, *theta), strict=True):
                kinematic.observe(self._params, own, x)
        link, a, b = self._own
        return JointState(
            link.position, link.velocity, (a.position, b.position), (a.velocity, b.velocity)
        )

    def push(
        self,
        state: JointState,
        laws: tuple[ElasticLaw, ElasticLaw],
        torques: tuple[float, float],
    ) -> None:
        """Move on to the next instant what accelerations do, the springs' torques held.

        Parameters
        ----------
        state
            Of this instant.
        laws
            Of both springs.
        torques
            (2,) of the motors until the next instant [N m].
        """
        j, T = self.joint, self.period
        first, second = (law.evaluate(x) for law, x in zip(laws, state.deflections, strict=True))
        loads = (
            -j.gravity_torque * math.sin(state.q) - first.torque - second.torque,
            torques[0] + first.torque + first.offset,
            torques[1] + second.torque + second.offset,
        )
        inertias, dampings = (j.link, *j.motors), (j.link_damping, *j.motor_damping)
        for own, load, B, D in zip(self._own, loads, inertias, dampings, strict=True):
            decay = D * T / B
            # of the velocity over the period; the position's own share of it is half of that
            gone = -math.expm1(-decay) / decay if decay > 0.0 else 1.0
            change = gone * T * (load - D * own.velocity) / B
            own.position -= 0.5 * T * change
            own.velocity += change
