"""Arms at rest under gravity and a wrench, on nonlinear springs whose motors are held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from rotatum.models.robot.cartesian import CartesianStiffness, cartesian_stiffness
from rotatum.models.robot.interface import Robot
from tests.models.robot_cases import arm, rate

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Resting:
    """An arm at rest on springs tau_e = a sinh(b phi), which the motors hold.

    Springs, pose and wrench are drawn, and the motors put where the arm then rests.
    """

    robot: Robot
    frame: str
    q: Array
    wrench: Array
    a: Array
    b: Array
    theta: Array

    @classmethod
    def drawn(cls, name: str, frame: str, seed: int) -> Resting:
        rng = np.random.default_rng(seed)
        robot = arm(name)
        n = robot.size
        q = rng.uniform(-2.5, 2.5, n)
        # Torques of the size of gravity's deflect such springs by some tenths of a radian.
        heavy = max(1.0, float(np.abs(robot.gravity(q)).max()))
        a, b = heavy * rng.uniform(1.0, 3.0, n), rng.uniform(3.0, 6.0, n)
        wrench = heavy * rng.uniform(-0.4, 0.4, 6)
        torque = robot.jacobian(frame, q).T @ wrench - robot.gravity(q)
        return cls(robot, frame, q, wrench, a, b, q - np.arcsinh(torque / a) / b)

    @property
    def stiffness(self) -> Array:
        return self.a * self.b * np.cosh(self.b * (self.q - self.theta))

    def rest(self, change: Array) -> Array:
        """Angles at which it rests under another wrench, (n,)."""

        def unbalanced(q: Array) -> Array:
            elastic = self.a * np.sinh(self.b * (q - self.theta))
            outer = self.robot.jacobian(self.frame, q).T @ (self.wrench + change)
            return elastic + self.robot.gravity(q) - outer

        found = root(unbalanced, self.q, tol=1e-14)
        # What the solver calls success asks for more digits than a double has left here.
        assert np.abs(found.fun).max() <= 1e-11 * np.abs(self.a).max()
        at: Array = found.x
        return at

    def moved(self, change: Array) -> Array:
        """What another wrench moves the frame by: position and rotation from now, (6,)."""
        here, there = (self.robot.pose(self.frame, q) for q in (self.q, self.rest(change)))
        turned = Rotation.from_matrix(there.rotation @ here.rotation.T).as_rotvec()
        return np.concatenate([there.position - here.position, turned])

    def compliance(self) -> Array:
        """Displacements for forces, (6, 6), by differences of the sixth order."""
        columns = []
        for unit in np.eye(6):
            trial = 1e-5 * np.abs(self.a).max() * unit
            turn = np.abs(self.rest(trial) - self.q).max()
            # Steps of t rad: near a buckling load a force of a given size would be none or all.
            size = np.abs(trial).max() / turn if turn > 1e-10 else 1.0
            columns.append(rate(lambda t, f=size * unit: self.moved(t * f)) / size)
        return np.stack(columns, axis=1)

    def told(self, directions: tuple[str, ...]) -> CartesianStiffness:
        return cartesian_stiffness(
            self.robot, self.frame, self.q, self.stiffness,
            force=self.wrench[:3], moment=self.wrench[3:], directions=directions,
        )  # fmt: skip
