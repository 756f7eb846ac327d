"""What one simulation of section IV is scored for, and medians over many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rotatum.evaluation.metrics import mse, msrep_percent
from rotatum.evaluation.papers.menard2013.methods import (
    ALWAYS_AT_REST,
    Found,
    by_flacco,
    every_method,
    motion,
    truth_of,
)
from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["LAW", "LEAST", "MSE", "OTHERS", "PARTS", "SCORED_FROM", "Job", "Medians", "medians_of"]
__all__ += ["score", "scores"]

SCORED_FROM = 2.0  # s, as in the paper
LEAST = 1.0  # N m/rad below which a true stiffness is too near zero for a relative error
PARTS = ("total", "1", "2")
LAW = "law"  # MSREP of the total at the true deflection
MSE = "mse"
OTHERS = ("Flacco et al., V_max", "Flacco et al., powers 0 to 3")

Scores = dict[tuple[str, str], float]


class Job(NamedTuple):
    """A simulation.

    Args:
        noise: standard deviation of the positions, rad.
        torque_noise: of the torques, N m.
        seed: of both.
        swing: torques about zero.
        others: whether Flacco's settings are read in other ways as well.
    """

    noise: float
    torque_noise: float
    seed: int
    swing: bool = False
    others: bool = False


def scores(job: Job) -> Scores:
    """Simulate and score: (method, what) to MSREP in %, or MSE in (N m/rad)^2."""
    device, log = motion(job.noise, job.torque_noise, job.seed, swing=job.swing)
    found = dict(every_method(device, log))
    if job.others:
        readings = (
            by_flacco(device, log, ALWAYS_AT_REST),
            by_flacco(device, log, full=True),
        )
        found |= dict(zip(OTHERS, readings, strict=True))
    return {
        (method, what): value
        for method, run in found.items()
        for what, value in score(device, log, run).items()
    }


def score(device: Device, log: Log, run: Found) -> dict[str, float]:
    """Score from 2 s on where the true stiffness concerned is above 1 N m/rad (eqs 30 and 31).

    Args:
        device, log: of the motion.
        run: of a method.
    """
    late = log.time >= log.time[0] + SCORED_FROM
    found = {}
    for part in PARTS:
        truth = truth_of(device, log, part)
        seen = late & (truth > LEAST)
        sigma = run.stiffness if part == "total" else run.parts[:, int(part) - 1]
        found[part] = msrep_percent(sigma[seen], truth[seen])
        if part == "total":
            found[MSE] = mse(sigma[seen], truth[seen])
            found[LAW] = msrep_percent(run.law[seen], truth[seen])
    return found


class Medians(NamedTuple):
    """Medians over the seeds.

    Args:
        values: (noise, torque noise, swing) to (method, what) to the median.
    """

    values: Mapping[tuple[float, float, bool], Scores]

    def of(
        self,
        noise: float,
        torque_noise: float,
        method: str,
        what: str = "total",
        *,
        swing: bool = False,
    ) -> float:
        """Return a median."""
        return self.values[noise, torque_noise, swing][method, what]

    def levels(self, torque_noise: float, *, swing: bool = False) -> list[float]:
        """Return the noises of the positions there are at this torque noise, ascending."""
        return sorted(n for n, t, s in self.values if t == torque_noise and s == swing)


def medians_of(jobs: Sequence[Job], found: Sequence[Scores]) -> Medians:
    """Gather the jobs of every condition."""
    gathered: dict[tuple[float, float, bool], list[Scores]] = {}
    for job, each in zip(jobs, found, strict=True):
        gathered.setdefault((job.noise, job.torque_noise, job.swing), []).append(each)
    return Medians(
        {
            condition: {key: float(np.median([one[key] for one in group])) for key in group[0]}
            for condition, group in gathered.items()
        }
    )
