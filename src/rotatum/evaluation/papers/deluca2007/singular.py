"""Figure 2: the configurations where accelerometers tell nothing, crossed on purpose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.control import ElasticArm, RestToRest, desired_motion, full_state_feedback
from rotatum.estimators.full_state.accelerations import JointAccelerations
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.evaluation.loop import ClosedLoop, closed_loop
from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.deluca2007.arms import PERIOD, arm, encoders, faults
from rotatum.evaluation.parallel import spread
from rotatum.kernels.status import SINGULAR

__all__ = ["CASE", "SPELLS", "Crossing", "crossing"]

Array = NDArray[np.float64]

PLACE = (0.0, 0.0, 0.1)  # m: in the plane of links 2 and 3, so that it does get above axis 1
WAYS = {
    "above axis 1": ((0.0, 0.3, -1.0), (0.8, -0.9, -0.6)),
    "in line with axes 2 and 3": ((0.0, 0.9, 0.9), (0.4, 0.6, -0.3)),
}
"""What is crossed -> (n,) start and end [rad]."""
SPELLS = ("before", "at", "after")
BEGIN, SECONDS, AFTER = 0.3, 1.6, 0.5  # s


@dataclass(frozen=True, eq=False)
class Crossing:
    """A singular configuration crossed in closed loop on the observed state.

    Attributes:
        run: the closed loop.
        error: (N, n) of the observed links [rad].
        share: (N,) least share of a joint's acceleration that is told, at the true pose.
        flagged: (N,) whether a joint's status says SINGULAR.
    """

    run: ClosedLoop
    error: Array
    share: Array
    flagged: NDArray[np.bool_]

    @property
    def spell(self) -> slice:
        """From the first to the last flagged sample; empty at the start where there is none."""
        where = np.flatnonzero(self.flagged)
        return slice(int(where[0]), int(where[-1]) + 1) if where.size else slice(0, 0)

    def parts(self) -> dict[str, slice]:
        """Return the samples of each of `SPELLS`, from the beginning of the motion on."""
        at = self.spell
        moving = round(BEGIN / PERIOD)
        before, after = slice(moving, at.start), slice(at.stop, len(self.error))
        return dict(zip(SPELLS, (before, at, after), strict=True))

    def largest(self, part: slice) -> float:
        """Return the largest error of a link in these samples [rad]."""
        return float(np.abs(self.error[part]).max(initial=0.0))

    def jump(self) -> float:
        """Return the largest change of a link's error from one sample to the next, flagged."""
        at = self.spell
        steps = np.diff(self.error[max(at.start - 1, 0) : at.stop + 1], axis=0)
        return float(np.abs(steps).max(initial=0.0))


def crossing(way: str) -> Crossing:
    """Cross a configuration under full-state control.

    Args:
        way: of `WAYS`.
    """
    device = arm("kr15-like", place=PLACE)
    known = ElasticArm.of(device)
    start, end = (np.array(x) for x in WAYS[way])
    motion = RestToRest(start, end, BEGIN, SECONDS)
    desired = desired_motion(known, motion, PERIOD, BEGIN + SECONDS + AFTER)
    law = full_state_feedback(known, end)
    observer = StateObserver(device, period=PERIOD)
    run = closed_loop(
        device, desired, law, observer=observer, sensors=encoders(device), inertial=faults()
    )
    q = np.column_stack([run.log.joints[name]["q_true"] for name in known.names])
    sensors = JointAccelerations(known.robot, device.accelerometers)
    share = np.array([sensors.inverse(pose).share.min() for pose in q])
    flagged = np.any(run.status & SINGULAR, axis=1)
    return Crossing(run, run.estimate[:, 1] - q, share, flagged)


def _run(progress: Progress, quick: bool) -> Outcome:
    found = dict(zip(WAYS, spread(crossing, tuple(WAYS), progress), strict=True))
    values = [line for way, own in found.items() for line in _lines(way, own)]
    figures = tuple(_figure(way, own) for way, own in found.items())
    return Outcome(tuple(values), figures, FINDINGS)


def _lines(way: str, own: Crossing) -> list[Value]:
    lines = [
        Value(f"{way}: largest error of a link, {name}", "mrad", observed=1e3 * own.largest(part))
        for name, part in own.parts().items()
    ]
    at = own.spell
    lines.append(Value(f"{way}: largest jump between samples", "mrad", observed=1e3 * own.jump()))
    lines.append(Value(f"{way}: flagged", "s", observed=PERIOD * (at.stop - at.start)))
    lines.append(Value(f"{way}: least share told", "", observed=float(own.share.min())))
    return lines


def _figure(way: str, own: Crossing) -> Figure:
    time, every = own.run.log.time, 2
    t = time[::every]
    names = tuple(own.run.log.joints)
    errors = tuple(Curve(name, t, 1e3 * own.error[::every, i]) for i, name in enumerate(names))
    plots = (
        Plot("error of the links, mrad", errors),
        Plot(
            "least share of an acceleration that is told", (Curve("share", t, own.share[::every]),)
        ),
        Plot("flagged singular", (Curve("status", t, own.flagged[::every].astype(float)),)),
    )
    key = "above" if way.startswith("above") else "aligned"
    return Figure(key, f"{way} (figure 2)", NOTE, "time, s", plots)


NOTE = "Closed loop on the observed state, through the configuration without stopping."
FINDINGS = (
    "Nothing jumps: the inverse of T_A is damped, its share of each joint's acceleration fades to "
    "nothing and back, and the observer has that of the motor's encoder to lean on meanwhile.",
    "What fades is taken for zero. A link's error then follows its acceleration there, by "
    "7e-5 s^2 of it at 250 rad/s, and goes as fast as it came.",
)

CASE = Case(
    "singular",
    "the two singular configurations of the accelerometer, crossed in closed loop",
    "Figure 2: the sensor above axis 1, and in line with axes 2 and 3; the paper avoids both.",
    (
        "kr15-like with its accelerometer moved into the plane of the arm: 0.1 m beside it, as in "
        "the other cases, it never gets above axis 1.",
        "Both crossed in 1.6 s from rest to rest. Sensors as in the case observer, bias included.",
        "The arm and its payload are known to the controller, friction too.",
    ),
    _run,
)
