"""An arm at an instant, and how it moves on: as many steps in a sample as their error asks for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Records
from rotatum.simulation.plant.arm import Arm
from rotatum.simulation.plant.explicit import BACK, END, TAKE

__all__ = ["MOST_STEPS", "ArmMarch", "Springs"]

Array = NDArray[np.float64]

# Step times fastest elastic mode: thrice too long where that mode swings, but it seldom does; the
# error finds out.
STEP_SWING = 1.25
# Estimated errors are let pass in proportion to the springs' deflection [rad]: an elastic mode that
# is all there is then keeps its energy to 2e-7 over 10 s at 380 rad/s.
FULL_DEFLECTION = 0.1
LEAST_ERROR = 1e-4
STIFFER = 1.2  # times the stiffness the steps were chosen for: they are chosen again
MOST_STEPS = 1024


class ArmMarch:
    """An arm at an instant, moved on sample by sample.

    Parameters
    ----------
    arm
        Its equations.
    period
        Of the samples [s].
    """

    def __init__(self, arm: Arm, period: float) -> None:
        self.arm = arm
        self.period = period
        self.steps, self.rejected = 0, 0
        self.mode = 0.0
        self.allowed = LEAST_ERROR
        self._base = self._count = 1
        self._nodes = [*_nodes(), 1.0]

    def follow(self, mode: float) -> None:
        """Choose the steps for a fastest elastic mode [rad/s]."""
        self.mode = mode
        self._base = max(1, math.ceil(mode * self.period / STEP_SWING))
        self._count = max(self._count, self._base)

    def report(self, records: Sequence[Records]) -> None:
        """Write what the joints do now, under the inputs of this sample, train -> (n,)."""
        self.arm.look(0, 0.0, records)
        for train in self.arm.trains:
            train.fresh[:] = 1

    def allow(self, records: Sequence[Records]) -> None:
        """Let errors pass in proportion to the springs' largest deflection so far."""
        for record in records:
            reached = float(np.max(np.abs(record["deflection"]))) / FULL_DEFLECTION
            self.allowed = min(1.0, max(self.allowed, reached))

    def advance(self) -> bool:
        """Move on by a sample; return whether that could be done.

        Needs a `report` before. The number of steps is doubled until the error of each is
        allowed, and halved again when it is far below.
        """
        while self._count <= MOST_STEPS:
            worst = self._try(self._count)
            if worst <= self.allowed:
                self.steps += self._count
                # halving raises an eighth-order error by 2^8, and the margin is for what comes
                if worst < 1e-3 * self.allowed and self._count > self._base:
                    self._count //= 2
                return True
            self.rejected += self._count
            self._count *= 2
            for train in self.arm.trains:
                train.look(BACK)
        return False

    def _try(self, count: int) -> float:
        worst = 0.0
        for train in self.arm.trains:
            train.step[:] = self.period / count
        for k in range(count):
            for part in range(1, END + 1):
                self.arm.look(part, (k + self._nodes[part]) / count)
                if part == 1:
                    for train in self.arm.trains:
                        train.fresh[:] = 0
            for train in self.arm.trains:
                train.look(TAKE)
                error = float(np.max(train.error))
                if not error <= self.allowed:
                    return math.inf
                worst = max(worst, error)
        return worst


def _nodes() -> list[float]:
    from scipy.integrate import DOP853

    nodes: list[float] = DOP853.C[: DOP853.n_stages].tolist()
    return nodes


class Springs:
    """The stiffest the springs have been, by joint."""

    def __init__(self, arm: Arm) -> None:
        self.q = np.zeros(len(arm.plants))
        self.stiffest = [[0.0] * len(plant.motors) for plant in arm.plants]
        self._trains = arm.trains
        self._limits = [np.full(len(train.joints), -1.0) for train in arm.trains]

    def stiffer(self, records: Sequence[Records]) -> bool:
        """Return whether a spring is so much stiffer that steps should be chosen again."""
        if not any(np.any(r["stiffness_total"] > limit) for r, limit in self._now(records)):
            return False
        for train, record, limit in zip(self._trains, records, self._limits, strict=True):
            total = np.abs(record["stiffness"]).sum(axis=1)
            np.maximum(limit, STIFFER * total, out=limit)
            self.q[train.joints] = record["q"]
            for place, joint in enumerate(train.joints):
                known = self.stiffest[joint]
                now = np.abs(record["stiffness"][place]).tolist()
                known[:] = [max(a, b) for a, b in zip(known, now, strict=True)]
        return True

    def _now(self, records: Sequence[Records]) -> Iterator[tuple[Records, Array]]:
        return zip(records, self._limits, strict=True)
