"""An arm with elastic joints: drive trains around a rigid robot, and their equations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.models.robot.interface import Robot
from rotatum.record import Records
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.effects import StiffnessDrift
from rotatum.simulation.plant.train import Train

__all__ = ["Arm"]

Array = NDArray[np.float64]
_LOOKS = 16  # configurations at which the fastest mode is looked for


class Arm:
    """Equations of motion of a robot whose joints are elastic.

    ``M(q) q'' + S theta'' + C(q, q') q' + g(q) = n_l`` and
    ``S^T q'' + B theta'' = n_m``, where n_l and n_m are what springs, friction, motors and external
    torques leave over on links and motors (flacco2012 eq. 14, deluca2007 eqs 1-2). S, the inertial
    coupling of motors and links, is constant and strictly upper triangular; with it every joint has
    one motor.

    Parameters
    ----------
    robot
        The links.
    plants
        One for each of its joints; link inertia and gravity in them are not used.
    trains
        Their drive trains, from `rotatum.simulation.plant.train.trains_of`.
    coupling
        S, (n, n) kg m^2.
    """

    def __init__(
        self, robot: Robot, plants: Sequence[Plant], trains: Sequence[Train], coupling: Array
    ) -> None:
        self.robot = robot
        self.plants = tuple(plants)
        self.trains = tuple(trains)
        self.coupling = coupling
        self._coupled = bool(np.any(coupling))
        # S B^-1 and S B^-1 S^T
        self._share = coupling / np.array([plant.motors[0].inertia for plant in plants])
        self._felt = self._share @ coupling.T
        self._alone = trains[0] if len(trains) == 1 else None
        self._q, self._dq, self._net, self._motor_net = np.zeros((4, len(plants)))
        self._drifting = any(plant.effects.drift != StiffnessDrift() for plant in plants)
        for train in self.trains:
            train.coupled[:] = int(self._coupled)

    def look(self, part: int, share: float, records: Sequence[Records] | None = None) -> None:
        """Do a part of a step: drive trains, then robot.

        Parameters
        ----------
        part
            Of `rotatum.simulation.plant.explicit`, 0 to 12.
        share
            Share of the period gone there.
        records
            train -> (n,) outputs, to be written; None: not wanted.
        """
        alone = self._alone
        for i, train in enumerate(self.trains):
            if self._drifting:
                train.share[:] = share
            train.look(part, None if records is None else records[i])
            if alone is None:
                self._q[train.places], self._dq[train.places] = train.q, train.dq
                self._net[train.places] = train.net
                self._motor_net[train.places] = train.motor_net
        if alone is None:
            self._accelerate(self._q, self._dq, self._net, self._motor_net)
        elif self._coupled:
            self._accelerate(alone.q, alone.dq, alone.net, alone.motor_net)
        else:
            # one train of all joints: its views are the arm's, and nothing need be copied
            alone.ddq[:] = self.robot.accelerate(alone.q, alone.dq, alone.net)
        for train, record in zip(self.trains, records or (), strict=False):
            record["ddq"] = train.ddq

    def _accelerate(self, q: Array, dq: Array, net: Array, motor_net: Array) -> None:
        """Tell the drive trains q'' and, where the coupling changes it, theta''."""
        if not self._coupled:
            ddq = self.robot.accelerate(q, dq, net)
            for train in self.trains:
                train.ddq[:] = ddq[train.places]
            return
        # theta'' = B^-1 (n_m - S^T q''), put into the links' equation; the trains gave B^-1 n_m.
        left = self.robot.mass(q) - self._felt
        right = net - self.robot.bias(q, dq) - self.coupling @ motor_net
        ddq = np.linalg.solve(left, right)
        ddtheta = motor_net - ddq @ self._share
        for train in self.trains:
            train.ddq[:] = ddq[train.places]
            train.ddtheta[:] = ddtheta[train.places]

    def fastest_mode(self, q: Array, stiffness: Sequence[Sequence[float]]) -> float:
        """Return the fastest elastic mode [rad/s] near q and at random poses.

        The largest w of ``w^2 H x = K x``, H the inertia of links and motors, K of the springs.

        Parameters
        ----------
        q
            (n,) rad.
        stiffness
            joint -> N m/rad of each transmission.
        """
        rng = np.random.default_rng(0)
        looks = [q, *(q + rng.uniform(-np.pi, np.pi, (_LOOKS, q.size)))]
        return max(self._mode(at, stiffness) for at in looks)

    def _mode(self, q: Array, stiffness: Sequence[Sequence[float]]) -> float:
        n = len(self.plants)
        motors = [(j, m) for j, plant in enumerate(self.plants) for m in range(len(plant.motors))]
        H = np.zeros((n + len(motors), n + len(motors)))
        K = np.zeros_like(H)
        H[:n, :n] = self.robot.mass(q)
        for row, (j, m) in enumerate(motors, start=n):
            H[row, row] = self.plants[j].motors[m].inertia
            k = abs(stiffness[j][m])
            K[j, j] += k
            K[row, row] += k
            K[j, row] -= k
            K[row, j] -= k
        if self._coupled:
            H[:n, n:] += self.coupling
            H[n:, :n] += self.coupling.T
        return float(np.sqrt(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(H, K))))))

    def energy(self, joints: Sequence[Records]) -> Array:
        """Return kinetic, gravity and elastic energy (N,) [J].

        Parameters
        ----------
        joints
            joint -> (N,) records of the train's output.
        """
        total = np.zeros(joints[0].shape)
        q = np.column_stack([at["q"] for at in joints])
        dq = np.column_stack([at["dq"] for at in joints])
        for plant, at in zip(self.plants, joints, strict=True):
            total += plant.energy(at) - 0.5 * plant.link.inertia * at["dq"] ** 2
        for k in range(total.size):
            total[k] += self.robot.kinetic_energy(q[k], dq[k]) + self.robot.potential_energy(q[k])
        if self._coupled:
            dtheta = np.column_stack([at["dtheta"][:, 0] for at in joints])
            total += np.einsum("ki,ij,kj->k", dq, self.coupling, dtheta)
        return total
