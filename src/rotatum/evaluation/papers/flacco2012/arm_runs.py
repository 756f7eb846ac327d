"""One joint of the arm by both methods, and what of it belongs to one transmission."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.flacco2012.modality import channels, printed, weak
from rotatum.evaluation.papers.flacco2012.settings import VSA2
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.record import Records

__all__ = ["METHODS", "PARTS", "JointRuns", "run_joint"]

Array = NDArray[np.float64]

PARTS = ("1", "2", "total")
METHODS = ("RESIDUAL", "weak")  # with the paper's settings, and with defaults


class JointRuns:
    """A joint estimated from its own channels alone.

    Args:
        logged: role to (N,).
        runs: method to (N,) readings.
    """

    def __init__(self, logged: dict[str, Array], runs: dict[str, Records]) -> None:
        self.logged = logged
        self._runs = runs

    def stiffness(self, method: str, part: str) -> Array:
        """Return a part's stiffness as one of ``METHODS`` finds it, (N,) N m/rad."""
        run = self._runs[method]
        if part == "total":
            return np.asarray(run["stiffness"])
        return np.asarray(run["part_stiffness"][:, int(part) - 1])

    def truth(self, part: str) -> Array:
        """Return a part's true stiffness, (N,) N m/rad."""
        return self.logged["stiffness_true" if part == "total" else f"stiffness{part}_true"]

    def deflection(self, part: str) -> Array:
        """Return the deflection of a transmission by the encoders, (N,) rad."""
        return self.logged["q"] - self.logged[f"theta{part}"]


def run_joint(device: Device, log: Log) -> JointRuns:
    """Estimate by ``METHODS``.

    Args:
        device: of the one joint.
        log: of the arm.
    """
    runs = (printed(device, log, "RESIDUAL", VSA2).out, weak(device, log).records)
    return JointRuns(channels(device, log), dict(zip(METHODS, runs, strict=True)))
