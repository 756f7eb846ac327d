"""Run an arm in time: sample by sample, as many steps in each as its error asks for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import SimulationError
from rotatum.models.robot.interface import Robot
from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.plant.arm import Arm
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.explicit import BACK, END, TAKE
from rotatum.simulation.plant.run import write_inputs
from rotatum.simulation.plant.stops import failure, first_wrong
from rotatum.simulation.plant.train import Train

__all__ = ["MOST_STEPS", "ArmCourse", "run_arm"]

Array = NDArray[np.float64]

# Step times fastest elastic mode. Twice too long where that mode swings, but it seldom does; the
# error finds out.
STEP_SWING = 1.0
# Estimated errors are let pass in proportion to the springs' deflection [rad]: an elastic mode that
# is all there is then keeps its energy to 2e-7 over 10 s at 380 rad/s.
FULL_DEFLECTION = 0.1
LEAST_ERROR = 1e-4
LOOK = 256  # samples between two looks at whether a spring has left its range
STIFFER = 1.2  # times the stiffness the steps were chosen for: they are chosen again
MOST_STEPS = 1024


class ArmCourse(NamedTuple):
    """What an arm did.

    Args:
        at: per joint (N,) records, outputs of its drive train.
        steps: steps taken in all samples together.
        rejected: steps thrown away because their error was too large.
        mode: fastest elastic mode [rad/s].
        stopped: why it ends before its time.
    """

    at: tuple[Records, ...]
    steps: int
    rejected: int
    mode: float
    stopped: SimulationError | None


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
        for train, record in zip(self.arm.trains, records, strict=True):
            train.fresh[:] = 1
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


def run_arm(
    arm: Arm,
    inputs: Sequence[Inputs],
    *,
    names: Sequence[str],
    robots: Mapping[int, Robot] | None = None,
    progress: Callable[[int, int | None], None] | None = None,
) -> ArmCourse:
    """Return the arm's motion under the inputs of its joints.

    Dormand and Prince's method of order 8, torques held over each sample. Steps are at most
    1 rad of the fastest elastic mode long, at the stiffest deflections met so far, and shorter
    where the estimated error of one exceeds 1e-7 of the largest deflection so far (1e-8 rad, 1e-6
    rad/s and 1e-6 of a hysteresis at 0.1 rad): where stiff modes swing, Coulomb friction, backlash,
    stiff motors.

    Parameters
    ----------
    inputs
        One for each joint, on the same instants.
    names
        Of the joints.
    robots
        Sample -> robot from there on (payloads).
    progress
        Called with samples done and expected.
    """
    time = inputs[0].time
    period = float(time[1] - time[0])
    march = ArmMarch(arm, period)
    feedback, control = any(row.feedback for row in inputs), inputs[0].control
    springs = _Springs(arm)
    u = [train_inputs(arm, train, inputs) for train in arm.trains]
    at = [train.bank.stage.output.zeros(time.size, len(train.joints)) for train in arm.trains]
    rails = _rails(arm, inputs, period)
    done = time.size
    for k in range(time.size):
        if robots and k in robots:
            arm.robot = robots[k]
        for rail in rails:
            rail.train.position[rail.place, -1] = rail.angle[k]
            rail.train.velocity[rail.place, -1] = rail.rate[k]
        if feedback and k % control == 0:
            _look(arm, inputs, names, u, k)
        for train, rows in zip(arm.trains, u, strict=True):
            train.acts[:] = rows[k]
        march.report([records[k] for records in at])
        if springs.stiffer([records[k] for records in at]):
            march.follow(arm.fastest_mode(springs.q, springs.stiffest))
        if k % LOOK == LOOK - 1:
            if progress is not None:
                progress(k + 1, time.size)
            if _gone(arm, [records[k + 1 - LOOK : k + 1] for records in at]):
                done = k + 1
                break
        if k + 1 < time.size and not march.advance():
            done = k + 1
            break
    stopped = None if done == time.size else _too_fast(time[done - 1], march)
    joints, stopped = _believed(arm.plants, time, _by_joint(arm, at, done), stopped)
    return ArmCourse(joints, march.steps, march.rejected, march.mode, stopped)


def train_inputs(arm: Arm, train: Train, inputs: Sequence[Inputs]) -> Records:
    """Return the inputs (N, n) of a train's joints out of those of all joints."""
    size = (inputs[0].time.size, len(train.joints))
    u = np.zeros(size, train.acts.dtype)
    for place, joint in enumerate(train.joints):
        write_inputs(inputs[joint], u[:, place], effects=arm.plants[joint].effects)
    return u


class _Rail(NamedTuple):
    """A prescribed set-point: whose it is, and where it goes."""

    train: Train
    place: int
    angle: Array
    rate: Array


def _rails(arm: Arm, inputs: Sequence[Inputs], period: float) -> list[_Rail]:
    rails = []
    for train in arm.trains:
        for place, joint in enumerate(train.joints):
            angle = inputs[joint].angle
            if angle is not None and arm.plants[joint].actuation == "serial":
                rate = np.diff(angle, append=angle[-1]) / period
                rails.append(_Rail(train, place, angle, rate))
    return rails


def _look(
    arm: Arm, inputs: Sequence[Inputs], names: Sequence[str], u: Sequence[Records], k: int
) -> None:
    """Ask feedback for the torques of the coming control period; the log's too."""
    seen = _seen(arm, names, float(inputs[0].time[k]))
    for train, rows in zip(arm.trains, u, strict=True):
        for place, joint in enumerate(train.joints):
            held = slice(k, k + inputs[joint].control)
            for motor, feedback in inputs[joint].feedback.items():
                tau = feedback.torque(seen)
                rows["tau"][held, place, motor] = tau
                inputs[joint].tau[held, motor] = tau


def _seen(arm: Arm, names: Sequence[str], time: float) -> Seen:
    q, dq = np.zeros((2, len(names)))
    theta, dtheta = {}, {}
    for train in arm.trains:
        q[train.joints], dq[train.joints] = train.position[:, 0], train.velocity[:, 0]
        for place, joint in enumerate(train.joints):
            theta[names[joint]] = train.position[place, 1:-1].copy()
            dtheta[names[joint]] = train.velocity[place, 1:-1].copy()
    return Seen(time, q, dq, theta, dtheta)


class _Springs:
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


def _by_joint(arm: Arm, at: Sequence[Records], done: int) -> tuple[Records, ...]:
    joints: list[Records] = [at[0][:0, 0]] * len(arm.plants)
    for train, records in zip(arm.trains, at, strict=True):
        for place, joint in enumerate(train.joints):
            joints[joint] = np.ascontiguousarray(records[:done, place])
    return tuple(joints)


def _gone(arm: Arm, at: Sequence[Records]) -> bool:
    """Return whether a spring has left its range; going on would be for nothing."""
    return any(
        first_wrong(arm.plants[joint], records[:, place]) is not None
        for train, records in zip(arm.trains, at, strict=True)
        for place, joint in enumerate(train.joints)
    )


def _believed(
    plants: Sequence[Plant],
    time: Array,
    at: tuple[Records, ...],
    stopped: SimulationError | None,
) -> tuple[tuple[Records, ...], SimulationError | None]:
    """Return the motion up to where the first joint leaves a law's range, and why it ends."""
    found = [
        (first_wrong(plant, records), j)
        for j, (plant, records) in enumerate(zip(plants, at, strict=True))
    ]
    wrong = sorted((sample, j) for sample, j in found if sample is not None)
    if not wrong:
        return at, stopped
    sample, j = wrong[0]
    reason = failure(plants[j], float(time[sample]), at[j][sample : sample + 1])
    return tuple(records[:sample] for records in at), reason


def _too_fast(time: float, march: ArmMarch) -> SimulationError:
    return SimulationError(
        f"the motion asks for more than {MOST_STEPS} integration steps a sample; it ran away, or "
        "friction stops a light motor too fast",
        where=f"t = {time:.6g} s",
        hint=f"The fastest elastic mode is {march.mode:.4g} rad/s, the period {march.period:.4g} "
        "s. Lower the torques, or raise smoothing.",
    )
