"""Drivers that look at the motion: what they see, and what is asked of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Feedback", "Seen"]

Array = NDArray[np.float64]


class Seen(NamedTuple):
    """The true state of all joints at an instant; an honest inner loop's view, without sensors.

    Parameters
    ----------
    time : s.
    q, dq : (n,) rad and rad/s, links in the order of the device's joints.
    theta, dtheta : joint -> (M,) rad and rad/s, its motors at the joint side.
    ddq : (n,) rad/s^2, links, just before the torques of this instant act; 0 at the first one.
    tau : joint -> (M,) N m, what acted on its motors until now, within their limits; 0 at first.

    The arrays are the simulator's own: what is kept for later is to be copied.
    """

    time: float
    q: Array
    dq: Array
    theta: Mapping[str, Array]
    dtheta: Mapping[str, Array]
    ddq: Array
    tau: Mapping[str, Array]


class Feedback(Protocol):
    """A driver of one motor that looks at the motion."""

    def torque(self, seen: Seen) -> float:
        """Return the torque [N m] at the joint side, held until the next instant."""
