"""What an arm knows before its joints: good samples, and what its dynamics say of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.armterms import Views, arm_terms, views
from rotatum.estimators.samples import MISSING, fill_guard
from rotatum.estimators.shapes import roles
from rotatum.estimators.tuning import Prepared
from rotatum.kernels import arm, guard
from rotatum.models import Device
from rotatum.record import Field, Layout, Records
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage

Array = NDArray[np.float64]
Places = NDArray[np.intp] | slice
FIELDS = {"q": "q", "theta": "theta", "theta1": "theta", "theta2": "theta2", "setpoint": "setpoint"}
"""Role of a channel to the field of ``ArmSample`` it goes to."""


@lru_cache(maxsize=16)
def arm_stage(n: int) -> Stage:
    """Make the stage that judges samples of an arm of n joints and makes link velocities."""
    name, doc = f"arm_of_{n}", "Samples of an arm, judged together, with its link velocities."
    c, m = 4 * n, MISSING + 1
    params = {"guard": guard.GuardParams.layout(c=c), "arm": arm.ArmParams.layout()}
    state = {"guard": guard.GuardState.layout(c=c), "arm": arm.ArmState.layout(n=n)}
    return Stage(
        name,
        Layout(f"{name}_params", doc, {k: Field(v) for k, v in params.items()}),
        Layout(f"{name}_state", doc, {k: Field(v) for k, v in state.items()}),
        arm.ArmSample.layout(n=n),
        arm.ArmSteps.layout(m=m, n=n),
        arm.init,
        arm.step,
        ("gautier1997",),
    )


class ArmFront:
    """The whole-arm half of estimating from the link side.

    A sample goes through the guard once; those that were missing before it are filled in; each
    gets what the arm's dynamics say, and is then handed to the joints.

    Args:
        device: with a robot.
        prepared: its joints, all of them.

    Raises:
        MethodError: joints differ in period or the payload's frame is not one of the arm's.
        ExtraError: the arm needs pinocchio.
    """

    def __init__(self, device: Device, prepared: Sequence[Prepared]) -> None:
        robot = device.build_robot()
        assert robot is not None  # settings tell arms from pendulums by it
        self.prepared = tuple(prepared)
        self.roles = [roles(p.joint.actuation, "estimated", "link") for p in prepared]
        self.terms = arm_terms(device, robot, prepared)
        stage = arm_stage(len(prepared))
        params = stage.params.zeros(1)
        for i, p in enumerate(prepared):
            fill_guard(params["guard"][0], p.joint, p.settings, p.notes, i, len(prepared))
        params["arm"]["period"] = prepared[0].settings.operator.period
        self.bank = Bank(stage, params)
        self._u, self._out = stage.input.zeros(1), stage.output.zeros(1)
        self._sample, self._steps = views(self._u), views(self._out)
        self._moved = tuple(dict.fromkeys(FIELDS[role] for own in self.roles for role in own))
        samples = prepared[0].stage.input.zeros(1, len(prepared))
        self.joints = samples[0]
        self._joints = views(samples)

    def reset(self) -> None:
        """Forget everything."""
        self.bank.reset()
        self.terms.reset()

    def put(self, role: str, places: Places, values: Any) -> None:
        """Put one sample of a channel of some joints where ``advance`` reads it."""
        self._sample[FIELDS[role]][0, places] = values

    def enable(self, places: Places, values: Any) -> None:
        """Say whether some joints learn from the sample."""
        self._joints["enable"][0, places] = values

    def advance(self, time: float) -> int:
        """Take the sample that was put; returns how many steps, a refusal being one, it makes."""
        self._sample["time"][0] = time
        self.bank.update(self._u, self._out)
        return max(1, int(self._steps["steps"][0]))

    def batch(self, time: Array, channels: Sequence[Mapping[str, Array]]) -> Records:
        """Input records of a batch, (N, 1).

        Args:
            time: (N,) s.
            channels: per joint, role to (N,).
        """
        u = self.bank.stage.input.zeros(len(time), 1)
        u["time"][:, 0] = time
        for i, (wanted, logged) in enumerate(zip(self.roles, channels, strict=True)):
            for role in wanted:
                u[FIELDS[role]][:, 0, i] = logged[role]
        return u

    def expand(self, u: Records, layout: Layout) -> tuple[Records, NDArray[np.intp]]:
        """Samples for the joints, one row a step or a refusal, and each sample's last row.

        Args:
            u: (N, 1) records from ``batch``.
            layout: of the joints' samples.

        Returns:
            (S, n) records, and (N,) the row whose output is the sample's.
        """
        steps = views(self.bank.run(u)[:, 0])
        last = np.cumsum(np.maximum(steps["steps"], 1)) - 1
        found = layout.zeros(int(last[-1]) + 1 if len(last) else 0, len(self.prepared))
        found["enable"] = 1
        to, row = views(found), 0
        for i, time in enumerate(u["time"][:, 0]):
            for k in range(max(1, int(steps["steps"][i]))):
                self._fill(to, row, steps, i, k, time)
                row += 1
        return found, last

    def fill(self, k: int, time: float) -> None:
        """Fill step k of the sample that was advanced into ``joints``, all but ``enable``."""
        self._fill(self._joints, 0, self._steps, 0, k, time)

    def _fill(self, to: Views, row: int, steps: Views, i: int, k: int, time: float) -> None:
        """A refused sample, and the last step of one, have the sample's time and status."""
        count = int(steps["steps"][i])
        to["hold"][row] = count == 0
        to["status"][row] = steps["status"][i] if k >= count - 1 else 0
        to["time"][row] = time if k >= count - 1 else steps["time"][i, k]
        if count == 0:
            return
        for field in self._moved:
            to[field][row] = steps[field][i, k]
        to["fresh"][row] = steps["fresh"][i] if k == 0 else 0
        self.terms.fill(to, row, steps, i, k)
