"""INVDYN of deluca2007: from a link motion to the full state and the motor torques it needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.control.elastic_arm import ElasticArm
from rotatum.control.spring_inverse import DEGREE, deflections_for
from rotatum.control.trajectory import LinkTrajectory
from rotatum.errors import RotatumError

__all__ = ["SMOOTHING", "Desired", "desired_motion", "inverse_dynamics"]

Array = NDArray[np.float64]

SMOOTHING = 5e-3
"""[rad/s] that the sign of Coulomb friction is regularised over when it is compensated."""


@dataclass(frozen=True, eq=False)
class Desired:
    """A desired full state and the torques that keep an arm on it, at evenly spaced instants.

    Attributes
    ----------
    time : (N,) s.
    theta, q, dtheta, dq : (N, n) rad and rad/s.
    ddtheta, ddq : (N, n) rad/s^2.
    tau : (N, n) N m, motor torques at the joint side, each right at its instant.
    roughness : largest difference of the torque rates from the robot's own and those of the
        splines through the torques, over the largest rate; 0 where nothing moves.
    """

    time: Array
    theta: Array
    q: Array
    dtheta: Array
    dq: Array
    ddtheta: Array
    ddq: Array
    tau: Array
    roughness: float

    def state(self, time: float) -> Array:
        """Return x_d at the instant nearest to a time [s]: theta, q, theta', q' in rows, (4, n)."""
        k = self.row(time)
        return np.array([self.theta[k], self.q[k], self.dtheta[k], self.dq[k]])

    def torques(self, time: float) -> Array:
        """Return tau_d at the instant nearest to a time [s], (n,) N m."""
        now: Array = self.tau[self.row(time)]
        return now

    def row(self, time: float) -> int:
        """Return the number of the instant nearest to a time [s]."""
        step = self.time.item(1) - self.time.item(0)
        return min(max(round((time - self.time.item(0)) / step), 0), self.time.size - 1)


def desired_motion(
    arm: ElasticArm,
    motion: LinkTrajectory,
    period: float,
    seconds: float,
    *,
    friction: bool = True,
    held: bool = True,
    fine: int = 4,
) -> Desired:
    """Return the desired states at control instants, made on a grid `fine` times as fine.

    Parameters
    ----------
    arm
        As the controller knows it.
    motion
        Of the links; at rest before time 0.
    period, seconds
        Of control, and of the whole [s].
    friction
        Whether the motors' friction is fed forward.
    held
        Whether a torque is held until the next instant: it is then the mean over that period, not
        the value at its start, which would be half a period late.
    fine
        Instants the inverse dynamics takes in each period.
    """
    rows = round(seconds / period)
    time: Array = period / fine * np.arange(fine * (rows + 1) + 1, dtype=np.float64)
    whole = inverse_dynamics(arm, motion, time, friction=friction)
    kept = fine * np.arange(rows)
    tau = whole.tau[kept]
    if held:
        # trapezoidal mean over the period
        inner = [whole.tau[kept + k] for k in range(1, fine)]
        tau = (0.5 * (tau + whole.tau[kept + fine]) + sum(inner, np.zeros_like(tau))) / fine
    return Desired(
        time=time[kept],
        theta=whole.theta[kept],
        q=whole.q[kept],
        dtheta=whole.dtheta[kept],
        dq=whole.dq[kept],
        ddtheta=whole.ddtheta[kept],
        ddq=whole.ddq[kept],
        tau=tau,
        roughness=whole.roughness,
    )


def inverse_dynamics(
    arm: ElasticArm, motion: LinkTrajectory, time: Array, *, friction: bool = True
) -> Desired:
    """Return the full state and the motor torques of a link motion (INVDYN before eq. 13).

    The torque each spring transmits follows from the links, with S from the last joint to the
    first, as S is strictly upper triangular (eq. 2)::

        tau_l = M(q) q'' + C q' + g + F q' + S theta''
        tau_e(phi) + D phi' = -tau_l,  theta = q - phi
        tau = B theta'' + V theta' + C_m tanh(theta' / smoothing) + tau_l + S^T q''

    Two derivatives of phi are taken of splines of degree 7 through tau_l, good to h^6; the motion
    needs 4 continuous derivatives for a continuous torque, and 2 more for each joint that S couples
    to a later one. At the first instant all stands.

    Parameters
    ----------
    arm
        As the controller knows it.
    motion
        Of the links.
    time
        (N,) s, evenly spaced.
    friction
        Whether V and C_m are fed forward.

    Raises `RotatumError` for a motion of another number of links or too few instants, and where a
    spring's law does not reach the torque.
    """
    if motion.size != arm.size:
        what = "the motion is one of another number of links"
        raise RotatumError(what, where="motion", value=motion.size, allowed=str(arm.size))
    period = _period(time)
    q, dq, ddq, dddq = motion.derivatives(time, 3)
    rows = [arm.robot.inverse_dynamics(*x) for x in zip(q, dq, ddq, strict=True)]
    load = np.array(rows) + arm.link_viscous * dq
    roughness = _roughness(arm, load, (q, dq, ddq, dddq), time)
    theta, dtheta, ddtheta = np.zeros((3, *q.shape))
    for i in reversed(range(arm.size)):
        load[:, i] += ddtheta @ arm.coupling[i]
        bent = deflections_for(arm.springs[i], -load[:, i], period)
        theta[:, i] = q[:, i] - bent.phi
        dtheta[:, i] = dq[:, i] - bent.dphi
        ddtheta[:, i] = ddq[:, i] - bent.ddphi
    tau = arm.inertia * ddtheta + load + ddq @ arm.coupling
    if friction:
        tau += arm.viscous * dtheta + arm.coulomb * np.tanh(dtheta / SMOOTHING)
    return Desired(time, theta, q, dtheta, dq, ddtheta, ddq, tau, roughness)


def _period(time: Array) -> float:
    if time.ndim != 1 or time.size <= DEGREE:
        what = "inverse dynamics needs more instants"
        raise RotatumError(what, where="time", value=time.shape, allowed=f"{DEGREE + 1} or more")
    steps = np.diff(time)
    period = float(np.mean(steps))
    if not (period > 0.0 and np.max(np.abs(steps - period)) <= 1e-6 * period):
        what = "inverse dynamics needs evenly spaced instants"
        raise RotatumError(what, where="time", value=(float(steps.min()), float(steps.max())))
    return period


def _roughness(arm: ElasticArm, load: Array, moved: tuple[Array, ...], time: Array) -> float:
    from scipy.interpolate import make_interp_spline

    rates = [arm.robot.inverse_dynamics_rate(*x) for x in zip(*moved, strict=True)]
    exact = np.array(rates) + arm.link_viscous * moved[2]
    largest = float(np.max(np.abs(exact)))
    if largest == 0.0:
        return 0.0
    miss = make_interp_spline(time, load, DEGREE)(time, 1) - exact
    return float(np.max(np.abs(miss))) / largest
