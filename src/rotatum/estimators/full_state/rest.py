"""Where the links of an arm rest, from where its motors are: gravity and springs alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.models.joint import Joint
from rotatum.models.robot.interface import Robot

__all__ = ["Rest", "links_at_rest"]

Array = NDArray[np.float64]

_STEPS = 60
_HALVINGS = 30
_CLOSE = 1e-12  # rad, of the last step: no encoder tells less
_DECREASE = 1e-4  # part of the promised decrease that a step must bring (Armijo 1966)
_ROUNDING = 1e-9  # of the largest torque in the balance


class Rest(NamedTuple):
    """Where the links rest.

    Args:
        q: (n,) rad; where the search ended if it has not converged.
        converged: whether the torques balance there.
        stable: whether the links stay there: ``sigma + dg/dq`` is positive definite. If not, the
            springs are too soft for the weight on them, and the arm buckles away.
        contraction: largest eigenvalue, in magnitude, of ``sigma^-1 dg/dq`` there: how much is left
            of an error after one step of ``q <- theta + phi(-g(q))``. Where it is below 1 at every
            pose there is one rest only; above, the links may also rest elsewhere with the motors
            where they are.
        residual: (n,) N m, what does not balance.
    """

    q: Array
    converged: bool
    stable: bool
    contraction: float
    residual: Array

    @property
    def trustworthy(self) -> bool:
        """Whether an observer may start from it: converged, stable, and a contraction."""
        return self.converged and self.stable and self.contraction < 1.0


def links_at_rest(
    robot: Robot,
    joints: Sequence[Joint],
    theta: Array,
    *,
    theta2: Array | None = None,
    setpoint: Array | None = None,
    zero: Array | None = None,
    start: Array | None = None,
) -> Rest:
    """Return the link positions at rest, ``tau_e(q - theta) + g(q) = 0`` (deluca2007 section IV).

    The paper's reference for it (Albu-Schaeffer, Ott and Hirzinger 2004) iterates
    ``q <- theta + phi(-g(q))``, phi the deflection a spring needs for a torque, which contracts
    where the springs are stiff against the weight. This takes Newton's steps on the same balance,
    from the same start ``q = theta``, shortened until the energy of springs and weight decreases:
    it reaches the same point in three or four steps, needs no inverse of a law, and ends in a
    minimum of the energy also where the iteration does not contract. Friction is left out: dry
    friction of the links holds them anywhere near.

    Never raises for numbers: what is not found is `Rest.converged` False.

    Args:
        robot: the arm.
        joints: its joints, with transmission laws; of antagonistic ones `theta` is the first
            motor's.
        theta: (n,) rad, motors, at the joint side.
        theta2: (n,) rad, second motors; needed by antagonistic joints only.
        setpoint: (n,), in the laws' units; None: 0.
        zero: (n,) rad, deflection at which the springs rest; None: 0.
        start: (n,) rad, to start from; None: `theta`.

    Raises:
        MethodError: a joint without a law, or an antagonistic one without `theta2`.
    """
    balance = _Balance(robot, joints, theta, theta2, setpoint, zero)
    q = np.array(theta if start is None else start, dtype=np.float64)
    if not (np.isfinite(q).all() and balance.finite):
        return Rest(q, False, False, np.inf, np.full(robot.size, np.nan))
    step, force = np.inf, balance.force(q)
    for _ in range(_STEPS):
        if step <= _CLOSE:
            break
        q, step, force = _advance(balance, q, force)
    return _judged(balance, q, force)


class _Balance:
    """Springs against weight, of a pose of the links."""

    def __init__(
        self,
        robot: Robot,
        joints: Sequence[Joint],
        theta: Array,
        theta2: Array | None,
        setpoint: Array | None,
        zero: Array | None,
    ) -> None:
        self.robot, self.joints = robot, joints
        none = np.zeros(robot.size)
        self.motors = [theta, none if theta2 is None else theta2]
        self.setpoint = none if setpoint is None else setpoint
        self.zero = none if zero is None else zero
        for joint in joints:
            if any(spring.law is None for spring in joint.transmissions):
                what = "the rest of a link needs the law of its transmission"
                raise MethodError(what, where=f"{joint.name}.transmission.law")
            if len(joint.transmissions) == 2 and theta2 is None:
                what = "the rest of a link between two springs needs both motors"
                raise MethodError(what, where=f"{joint.name}.theta2")
        given = (*self.motors, self.setpoint, self.zero)
        self.finite = all(bool(np.isfinite(x).all()) for x in given)

    def springs(self, q: Array, of: str) -> Array:
        """Return "energy" [J], "torque" [N m] or "stiffness" [N m/rad] of the springs, (n,)."""
        found = np.zeros(len(self.joints))
        for i, joint in enumerate(self.joints):
            for theta, spring in zip(self.motors, joint.transmissions, strict=False):
                phi = q[i] - theta[i] - self.zero[i]
                found[i] += float(getattr(spring, of)(phi, self.setpoint[i]))
        return found

    def force(self, q: Array) -> Array:
        """Return what does not balance, the energy's gradient, (n,) N m."""
        return self.springs(q, "torque") + self.robot.gravity(q)

    def energy(self, q: Array) -> float:
        """Return the energy of springs and weight [J]."""
        return float(self.springs(q, "energy").sum()) + self.robot.potential_energy(q)

    def inside(self, q: Array) -> bool:
        """Whether the deflections are within the range of the laws."""
        for i, joint in enumerate(self.joints):
            for theta, spring in zip(self.motors, joint.transmissions, strict=False):
                low, high = spring.limits(float(self.setpoint[i]))
                if not low <= q[i] - theta[i] - self.zero[i] <= high:
                    return False
        return True


def _advance(balance: _Balance, q: Array, force: Array) -> tuple[Array, float, Array]:
    """Take one step downhill; returns where to, its length [rad], and the force there."""
    values, vectors = np.linalg.eigh(_curvature(balance, q))
    # Along directions that curve down the step goes downhill too, as far as if they curved up.
    size = np.maximum(np.abs(values), 1e-9 * np.abs(values).max() + np.finfo(float).tiny)
    step = -vectors @ ((vectors.T @ force) / size)
    before, promised = balance.energy(q), float(force @ step)
    for _ in range(_HALVINGS):
        at = q + step
        if balance.inside(at):
            then = balance.force(at)
            # Near the rest the energy's change is rounding: there the force decides.
            lower = balance.energy(at) <= before + _DECREASE * promised
            if lower or np.linalg.norm(then) < 0.5 * np.linalg.norm(force):
                return at, float(np.abs(step).max()), then
        step, promised = 0.5 * step, 0.5 * promised
    return q, 0.0, force


def _curvature(balance: _Balance, q: Array) -> Array:
    """Return ``sigma + dg/dq``, symmetric as a second derivative is, (n, n) N m/rad."""
    whole = np.diag(balance.springs(q, "stiffness")) + balance.robot.gravity_gradient(q)
    curvature: Array = 0.5 * (whole + whole.T)
    return curvature


def _judged(balance: _Balance, q: Array, force: Array) -> Rest:
    """Say what there is at the end of the search."""
    weight, sigma = balance.robot.gravity(q), balance.springs(q, "stiffness")
    slack = _ROUNDING * float(np.abs(weight).max()) + _CLOSE * float(np.abs(sigma).max())
    balanced = bool((np.abs(force) <= slack).all())
    stable = bool(np.linalg.eigvalsh(_curvature(balance, q))[0] > 0.0)
    contraction = np.inf
    if (sigma > 0.0).all():
        root = np.sqrt(sigma)
        gradient = balance.robot.gravity_gradient(q) / root / root[:, None]
        contraction = float(np.abs(np.linalg.eigvalsh(gradient)).max())
    return Rest(q, balanced, stable, contraction, force)
