"""Run an arm in time: sample by sample, as many steps in each as its error asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import SimulationError
from rotatum.models.robot.interface import Robot
from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.drivers.feedback import Feedback, Seen
from rotatum.simulation.plant.arm import Arm
from rotatum.simulation.plant.arm_march import MOST_STEPS, ArmMarch, Springs
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.run import write_inputs
from rotatum.simulation.plant.stops import failure, first_wrong
from rotatum.simulation.plant.train import Train

__all__ = ["ArmCourse", "run_arm"]

Array = NDArray[np.float64]

OFTEN = 8  # samples between two looks at the springs; in between the steps' errors speak
LOOK = 256  # samples between two looks at whether a spring has left its range


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


def run_arm(
    arm: Arm,
    inputs: Sequence[Inputs],
    *,
    robots: Mapping[int, Robot] | None = None,
    progress: Callable[[int, int | None], None] | None = None,
) -> ArmCourse:
    """Return the arm's motion under the inputs of its joints.

    Dormand and Prince's method of order 8, torques held over each sample. Steps are at most
    1.25 rad of the fastest elastic mode long, at the stiffest deflections met so far, and shorter
    where the estimated error of one exceeds 1e-7 of the largest deflection so far (1e-8 rad, 1e-6
    rad/s and 1e-6 of a hysteresis at 0.1 rad): where stiff modes swing, Coulomb friction, backlash,
    stiff motors.

    Parameters
    ----------
    inputs
        One for each joint, on the same instants.
    robots
        Sample -> robot from there on (payloads).
    progress
        Called with samples done and expected.
    """
    time = inputs[0].time
    period = float(time[1] - time[0])
    march = ArmMarch(arm, period)
    springs = Springs(arm)
    u = [train_inputs(arm, train, inputs) for train in arm.trains]
    at = [train.bank.stage.output.zeros(time.size, len(train.joints)) for train in arm.trains]
    rails, feedback = _rails(arm, inputs, period), _Feedback(arm, inputs, u)
    done = time.size
    for k in range(time.size):
        if robots and k in robots:
            arm.robot = robots[k]
        for rail in rails:
            rail.train.position[rail.place, -1] = rail.angle[k]
            rail.train.velocity[rail.place, -1] = rail.rate[k]
        feedback.look(k, float(time[k]))
        for train, rows in zip(arm.trains, u, strict=True):
            train.acts[:] = rows[k]
        now = [records[k] for records in at]
        march.report(now)
        if k % OFTEN == 0:
            march.allow(now)
            if springs.stiffer(now):
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


class _Feedback:
    """Drivers that look at the arm: what they see, and where their torques go.

    Views are made once, because a look comes every control period.
    """

    def __init__(self, arm: Arm, inputs: Sequence[Inputs], u: Sequence[Records]) -> None:
        self._trains = arm.trains
        self._q, self._dq, self._ddq = np.zeros((3, len(arm.plants)))
        self._theta: dict[str, Array] = {}
        self._dtheta: dict[str, Array] = {}
        self._tau: dict[str, Array] = {}
        self._drivers: list[tuple[Feedback, Array, Array]] = []
        self.control = inputs[0].control
        for train, rows in zip(arm.trains, u, strict=True):
            for place, joint in enumerate(train.joints):
                name = arm.plants[joint].name
                self._theta[name] = train.position[place, 1:-1]
                self._dtheta[name] = train.velocity[place, 1:-1]
                self._tau[name] = train.acts["tau"][place]
                for motor, feedback in inputs[joint].feedback.items():
                    felt, logged = rows["tau"][:, place, motor], inputs[joint].tau[:, motor]
                    self._drivers.append((feedback, felt, logged))

    def look(self, k: int, time: float) -> None:
        """Ask for the torques of the control period that begins with sample k; the log's too."""
        if not self._drivers or k % self.control:
            return
        for train in self._trains:
            self._q[train.places] = train.position[:, 0]
            self._dq[train.places] = train.velocity[:, 0]
            # the last look of the step before was at its end, under the torques before
            self._ddq[train.places] = train.ddq
        seen = Seen(time, self._q, self._dq, self._theta, self._dtheta, self._ddq, self._tau)
        for feedback, felt, logged in self._drivers:
            tau = feedback.torque(seen)
            felt[k : k + self.control] = tau
            logged[k : k + self.control] = tau


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
