"""Tracking control on the full state (deluca2007 eq. 13), and on the motors alone to compare."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.control.elastic_arm import ElasticArm
from rotatum.control.pole_placement import ElasticJoint, PolePair, motor_gains, state_gains
from rotatum.errors import RotatumError

__all__ = ["StateFeedback", "full_state_feedback", "joints_at", "motor_feedback"]

Array = NDArray[np.float64]

SLOWEST = 30.0  # [rad/s], of deluca2007 section V-B
DAMPING = 0.7
FAST_DAMPING = 0.3  # of the elastic mode: more of it costs torque, and it is fast anyway


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """``tau = K_P (x_d - xi) + tau_d`` within the motors' limits (deluca2007 eq. 13).

    K_P takes of each joint its own state only; a law of the motors alone has zeros on q and q'.

    Attributes
    ----------
    gains : (4, n) on theta, q [N m/rad], theta', q' [N m s/rad].
    limits : (n,) N m; inf: none.

    Raises `RotatumError` for gains that are not finite, or limits of another number of joints.
    """

    gains: Array
    limits: Array

    def __post_init__(self) -> None:
        """Check the shapes."""
        n = np.size(self.limits)
        if np.shape(self.gains) != (4, n) or not np.all(np.isfinite(self.gains)):
            raise RotatumError(
                "gains must be four finite numbers for each joint",
                where="gains",
                value=np.shape(self.gains),
                allowed=f"shape {(4, n)}",
            )

    def torques(self, desired: Array, feedforward: Array, estimate: Array) -> Array:
        """Return the torques (n,) N m at the joint side.

        A joint whose estimate is no number keeps its feedforward, so that a lost observer does not
        drive the motor to its limit.

        Parameters
        ----------
        desired
            x_d: theta, q, theta', q' in rows, (4, n) rad and rad/s.
        feedforward
            tau_d, (n,) N m.
        estimate
            xi, the same rows: observed, or the truth; rows without gains are not looked at.
        """
        pull = np.where(self.gains == 0.0, 0.0, self.gains * (desired - estimate)).sum(axis=0)
        pull = np.where(np.isfinite(pull), pull, 0.0)
        limited: Array = np.clip(pull + feedforward, -self.limits, self.limits)
        return limited


def joints_at(arm: ElasticArm, q: Array) -> tuple[ElasticJoint, ...]:
    """Return each joint alone at a pose (n,) [rad], M its diagonal entry of the mass matrix.

    Springs are as stiff as gravity deflects them there.
    """
    from rotatum.control.spring_inverse import inverted

    held = -arm.robot.gravity(q)
    bent = [inverted(spring, held[i : i + 1])[0] for i, spring in enumerate(arm.springs)]
    columns = (
        arm.inertia,
        np.diag(arm.robot.mass(q)),
        arm.stiffness(np.array(bent)),
        arm.damping,
        arm.viscous,
    )
    return tuple(ElasticJoint(*row) for row in np.column_stack(columns).tolist())


def full_state_feedback(
    arm: ElasticArm,
    q: Array,
    *,
    slowest: float = SLOWEST,
    damping: float = DAMPING,
    fast_damping: float = FAST_DAMPING,
) -> StateFeedback:
    """Return the full-state law of an arm, joint by joint at a pose.

    Bandwidth: the slower two of a joint's poles have the angular frequency `slowest`. The faster
    two keep the frequency the joint has without control (motor against link) and get a damping: to
    move them costs torque. At rest the law is then as stiff as `motor_feedback` with the same
    numbers, ``k1 + k2 = (B + M) w^2``.

    Parameters
    ----------
    q
        (n,) rad, where M is taken.
    slowest, damping
        Of the slower poles: rad/s, and 1.
    fast_damping
        Of the faster.
    """
    slow = PolePair(slowest, damping)
    gains = []
    for joint in joints_at(arm, q):
        fast = PolePair(joint.free_frequency, fast_damping)
        gains.append(state_gains(joint, slow, fast))
    return StateFeedback(np.column_stack(gains), arm.limits)


def motor_feedback(
    arm: ElasticArm, q: Array, *, bandwidth: float = SLOWEST, damping: float = DAMPING
) -> StateFeedback:
    """Return the law of the motors alone, a PD controller of theta, joint by joint at a pose.

    Bandwidth: with a stiff spring both poles of motor and link together would have the angular
    frequency `bandwidth` and this damping, as the slower two poles of `full_state_feedback` with
    the same numbers have on the elastic joint. At rest both laws are as stiff.

    Parameters
    ----------
    q
        (n,) rad, where M is taken.
    bandwidth, damping
        Of the poles: rad/s, and 1.
    """
    pair = PolePair(bandwidth, damping)
    gains = [motor_gains(joint, pair) for joint in joints_at(arm, q)]
    return StateFeedback(np.column_stack(gains), arm.limits)
