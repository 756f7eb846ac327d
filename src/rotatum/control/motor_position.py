"""Position control of an antagonistic joint's motors: the inner loop that needs no stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState

__all__ = ["MotorMotion", "MotorPosition"]

Array = NDArray[np.float64]


class MotorMotion(NamedTuple):
    """Where two motors are to be.

    Parameters
    ----------
    position, velocity : (2,) rad, rad/s.
    """

    position: tuple[float, float]
    velocity: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class MotorPosition:
    """Motor position control, the inner loop that needs no stiffness.

    ``u_i = B_i (w^2 (theta_d - theta_i) + 2 zeta w (theta_d' - theta_i')) + D_i theta_i' + held_i``

    Attributes
    ----------
    joint : its constants.
    bandwidth, damping : w [rad/s] and zeta of the rotor alone.
    """

    joint: AntagonisticJoint
    bandwidth: float
    damping: float = 1.0

    def torques(
        self,
        state: JointState,
        to: MotorMotion,
        held: tuple[float, float] = (0.0, 0.0),
    ) -> Array:
        """Return the torques (2,) [N m], without limits.

        Parameters
        ----------
        state
            Where the joint is.
        to
            theta_d [rad] and theta_d' [rad/s].
        held
            (2,) torques against the springs, fed forward [N m].
        """
        w, out = self.bandwidth, np.empty(2)
        for i in range(2):
            B, D = self.joint.motors[i], self.joint.motor_damping[i]
            pull = w * w * (to.position[i] - state.theta[i])
            pull += 2.0 * self.damping * w * (to.velocity[i] - state.dtheta[i])
            out[i] = B * pull + D * state.dtheta[i] + held[i]
        return out
