"""What a motor cannot give: torques are limited before they act and before they are logged."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.feedback import Feedback, Seen

if TYPE_CHECKING:
    from rotatum.models.parts import Motor

__all__ = ["LimitedFeedback", "limited"]


def limited(motor: Motor, tau: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return torques (N,) [N m] at the joint within what the motor can give."""
    if motor.torque_limit is None:
        return tau
    limit = motor.reflected_torque_limit
    return np.clip(tau, -limit, limit)


@dataclass(frozen=True)
class LimitedFeedback:
    """A feedback within what its motor can give.

    Parameters
    ----------
    feedback
        The law.
    limit
        Of its torque [N m], at the joint.
    where
        Joint and role, for messages.
    """

    feedback: Feedback
    limit: float
    where: str

    def torque(self, seen: Seen) -> float:
        """Return the torque [N m]; raise `RotatumError` if the law gives none that is finite."""
        tau = self.feedback.torque(seen)
        if not math.isfinite(tau):
            where = f"{self.where}, t = {seen.time:.6g} s"
            raise RotatumError(
                "the feedback's torque must be a finite number", where=where, value=tau
            )
        return min(max(tau, -self.limit), self.limit)
