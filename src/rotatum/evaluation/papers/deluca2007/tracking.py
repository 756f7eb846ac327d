"""Motions tracked by the motors alone and on the full state, on an arm that is told wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.control import (
    Desired,
    ElasticArm,
    RestToRest,
    desired_motion,
    full_state_feedback,
    joints_at,
    motor_feedback,
)
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.evaluation.loop import ClosedLoop, closed_loop, less_known, without_friction
from rotatum.evaluation.papers.deluca2007.arms import PERIOD, arm, encoders, faults

__all__ = ["MOTIONS", "MOTORS", "OBSERVED", "SOFT", "TRUE", "Tracked", "Tracking", "tracked"]

Array = NDArray[np.float64]

STRETCHED = (0.0, 0.5 * np.pi, 0.0)
"""rad: the links' inertia about axis 1 is largest, its mode lowest."""
MOTIONS: Mapping[str, tuple[tuple[float, float, float], float]] = {
    "short": ((5.0, 0.0, 0.0), 0.45),
    "long": ((30.0, 0.0, 0.0), 1.02),
    "coordinated": ((20.0, -15.0, 20.0), 0.9),
}
"""Motion -> degrees of each axis, and duration [s]: as fast as the torque limits let kr15-like."""
BEGIN, AFTER = 0.5, 1.0  # s: until it has settled under a weight it was not told, and after it
DAMPINGS = (0.7, 1.0)  # of the motors' law; the better one counts
MOTORS = "motors alone"
TRUE = "full state, true"
OBSERVED = "full state, observed"
SOFT = "full state, observed, its stiffness told wrong too"
REST = 0.4  # s, of the second after the stop
EVERY = 2  # samples from one drawn point to the next


class Tracking(NamedTuple):
    """A motion, an arm and what one is told of it.

    Args:
        device: of the catalogue.
        motion: of `MOTIONS`.
        stiffness: factor of the springs as they are told, to the feedforward and to the gains.
        bandwidth: rad/s, of the laws.
        friction: whether the motors rub.
        laws: which are run; the motors' always.
    """

    device: str
    motion: str
    stiffness: float = 0.9
    bandwidth: float = 30.0
    friction: bool = True
    laws: tuple[str, ...] = (TRUE, OBSERVED, SOFT)


class Tracked(NamedTuple):
    """What came of it.

    Args:
        vibration: law -> (n,) integral of each link's squared vibration after the stop [rad^2 s].
        mode: of axis 1's link on a motor that stands, as it is [rad/s].
        damping: of the better motors' law.
        restless: law -> deviation of axis 1's motor torque in the last `REST` seconds [N m].
        series: law -> thinned states of axis 1, name -> values.
    """

    vibration: Mapping[str, Array]
    mode: float
    damping: float
    restless: Mapping[str, float]
    series: Mapping[str, Mapping[str, Array]]

    def factor(self, law: str) -> float:
        """Return by how much less than under the motors' law axis 1 vibrates."""
        return float(self.vibration[MOTORS][0] / self.vibration[law][0])

    def factor_of_all(self, law: str) -> float:
        """Return the same of the sum over all links."""
        return float(self.vibration[MOTORS].sum() / self.vibration[law].sum())

    @property
    def gain_of_truth(self) -> float:
        """Which part of axis 1's vibration goes where the true state is fed back; or comes."""
        return 1.0 - float(self.vibration[TRUE][0] / self.vibration[OBSERVED][0])


def tracked(job: Tracking) -> Tracked:
    """Run the laws of a job.

    The controller is told no payload, and stiffness wrong; its observer no payload, and sees
    quantised encoders and a noisy accelerometer with its bias. The true state and what the motors'
    law is given are exact.

    Args:
        job: what to run.
    """
    device = arm(job.device)
    device = device if job.friction else without_friction(device)
    told = less_known(device, stiffness=job.stiffness)
    known = ElasticArm.of(told)
    way, seconds = MOTIONS[job.motion]
    end = np.array(STRETCHED) + np.radians(way)
    stop = BEGIN + seconds
    motion = RestToRest(np.array(STRETCHED), end, BEGIN, seconds)
    desired = desired_motion(known, motion, PERIOD, stop + AFTER)
    w = job.bandwidth
    full = full_state_feedback(known, end, slowest=w)
    observers = {OBSERVED: less_known(device), SOFT: told}
    runs = {}
    for law in job.laws:
        seen = StateObserver(observers[law], period=PERIOD) if law in observers else None
        runs[law] = closed_loop(
            device, desired, full, observer=seen, sensors=encoders(device), inertial=faults()
        )
    alone = {
        z: closed_loop(device, desired, motor_feedback(known, end, bandwidth=w, damping=z))
        for z in DAMPINGS
    }
    best = min(DAMPINGS, key=lambda z: alone[z].vibration("axis1", stop))
    runs[MOTORS] = alone[best]
    actual = joints_at(ElasticArm.of(device), end)[0]
    last = round(REST / PERIOD)
    return Tracked(
        {law: np.array([own.vibration(n, stop) for n in known.names]) for law, own in runs.items()},
        actual.locked_frequency,
        best,
        {law: float(own.log.joints["axis1"]["tau"][-last:].std()) for law, own in runs.items()},
        {law: _series(own, desired) for law, own in runs.items()},
    )  # fmt: skip


def _series(run: ClosedLoop, desired: Desired) -> dict[str, Array]:
    own = run.log.joints["axis1"]
    found = {
        "time": run.log.time,
        "q": own["q_true"],
        "torsion": own["theta_true"] - own["q_true"],
        "dq": own["dq_true"],
        "tau": own["tau"],
        "asked": desired.q[:, 0],
        "asked torsion": desired.theta[:, 0] - desired.q[:, 0],
        "asked dq": desired.dq[:, 0],
        "seen torsion": run.estimate[:, 0, 0] - run.estimate[:, 1, 0],
    }
    return {name: values[::EVERY].copy() for name, values in found.items()}
