"""The full state a law is given: observed from sensors, or the truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.full_state.observer import StateObserver
from rotatum.simulation import Readings, Seen

__all__ = ["ObservedState", "true_state"]

Array = NDArray[np.float64]


class ObservedState:
    """The state observed out of what live sensors show, sample by sample.

    At an instant a loop knows the torques that acted until now; those from now on are the law's,
    who waits for this state. The observer therefore takes the torque of the interval that ends
    here as constant over it, which it is, whatever its designs say of logs (`Design.held`).

    Args:
        observer: of the device as it is told; forgets what it saw before.

    Attributes:
        status: (n,) status bits of the last sample.
    """

    def __init__(self, observer: StateObserver) -> None:
        observer.reset()
        self._observer = observer
        self.status = np.zeros(len(observer.designs), dtype=np.int64)

    def __call__(self, readings: Readings) -> Array:
        """Return theta, q, theta', q' in rows, (4, n) rad and rad/s.

        Args:
            readings: of the instant.
        """
        observer = self._observer
        found = observer.update(
            theta=readings.theta,
            tau=readings.tau,
            acted=True,
            readings=readings.acc,
            rates=readings.gyro if observer.gyro_columns else None,
            time=readings.time,
        )
        self.status = found.status.copy()
        return np.array([found.theta, found.q, found.dtheta, found.dq])


def true_state(seen: Seen, names: tuple[str, ...]) -> Array:
    """Return theta, q, theta', q' in rows, (4, n) rad and rad/s, of joints with one motor.

    Args:
        seen: in the simulator's loop.
        names: of the joints, in the device's order.
    """
    theta, dtheta = (
        np.concatenate([of[name] for name in names]) for of in (seen.theta, seen.dtheta)
    )
    return np.array([theta, seen.q, dtheta, seen.dq])
