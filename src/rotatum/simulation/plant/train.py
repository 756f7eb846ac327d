"""Drive trains of an arm's joints: the records of one bank, and views of their fields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.explicit import write_method
from rotatum.simulation.plant.march_stage import march_stage

__all__ = ["Train", "trains_of"]


class Train:
    """Drive trains of the joints that have the same laws.

    The fields' views are made once: a look at a field of an array of records takes as long as the
    whole kernel.

    Parameters
    ----------
    plants
        Of these joints.
    joints
        (n,) their places in the arm.
    params
        (n,) records, params of `train_stage`.
    """

    def __init__(self, plants: Sequence[Plant], joints: Sequence[int], params: Records) -> None:
        stage = march_stage(plants[0].springs)
        both = stage.params.zeros(len(joints))
        both["train"] = params
        write_method(both["march"])
        self.bank = Bank(stage, both)
        self.joints = list(joints)
        # a slice is a view, and cheaper than a list of places
        consecutive = self.joints == list(range(self.joints[0], self.joints[-1] + 1))
        self.places = slice(self.joints[0], self.joints[-1] + 1) if consecutive else self.joints
        self.bodies = len(plants[0].motors) + 2
        self.u, self.out = stage.input.zeros(len(joints)), stage.output.zeros(len(joints))
        self.acts = self.u["train"]
        self.share = self.acts["share"]
        march = self.u["march"]
        self.part, self.fresh, self.step = march["part"], march["fresh"], march["step"]
        self.ddq, self.coupled, self.ddtheta = march["ddq"], march["coupled"], march["ddtheta"]
        state = self.bank.state["train"]
        self.q, self.dq = state["trial_position"][:, 0], state["trial_velocity"][:, 0]
        self.net, self.motor_net = state["acceleration"][:, 0], state["acceleration"][:, 1]
        self.y, self.error = self.bank.state["march"]["y"], self.bank.state["march"]["error"]

    def look(self, part: int, out: Records | None = None) -> None:
        """Do a part of a step; what the joints do goes to `out` (n,)."""
        self.part[:] = part
        self.bank.update(self.u, self.out if out is None else out)

    @property
    def position(self) -> NDArray[np.float64]:
        """(n, J) rad, of the bodies between steps."""
        return self.y[:, : self.bodies]

    @property
    def velocity(self) -> NDArray[np.float64]:
        """(n, J) rad/s, of the bodies between steps."""
        return self.y[:, self.bodies : 2 * self.bodies]


def trains_of(plants: Sequence[Plant], params: Sequence[Records]) -> tuple[Train, ...]:
    """Return the drive trains of an arm's joints, those of the same laws together.

    Parameters
    ----------
    plants
        One for each joint.
    params
        joint -> (1,) records, the params of its `train_stage`.
    """
    trains = []
    for kind in dict.fromkeys(plant.springs for plant in plants):
        joints = [j for j, plant in enumerate(plants) if plant.springs == kind]
        same = np.concatenate([params[j] for j in joints])
        trains.append(Train([plants[j] for j in joints], joints, same))
    return tuple(trains)
