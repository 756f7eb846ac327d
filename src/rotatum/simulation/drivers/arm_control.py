"""One controller for all joints of a device, asked once an instant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.feedback import Feedback, Seen

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["ArmControl", "Controller"]

Array = NDArray[np.float64]

Controller = Callable[[Seen], Array]
"""What is seen -> torques (n,) or (n, M) [N m] at the joint side, joints in the device's order."""

_ROLES = {1: ("tau",), 2: ("tau1", "tau2")}


class ArmControl:
    """A controller of all joints; each motor's driver takes its share of what it says.

    It is asked once an instant, however many motors there are, and within the motors' limits its
    torques act from that instant until the next control period.

    Parameters
    ----------
    controller
        Seen -> torques (n,) or (n, M) [N m] at the joint side, M the most motors of a joint.
    joints
        Of the device, in its order.
    """

    def __init__(self, controller: Controller, joints: Sequence[Joint]) -> None:
        self.controller = controller
        self.joints = tuple(joints)
        self._most = max(len(joint.motors) for joint in self.joints)
        self._seen: Seen | None = None
        self._torques = np.zeros((len(self.joints), self._most))

    def drives(self) -> dict[str, dict[str, Feedback]]:
        """Return joint -> role -> driver, the argument `drives` of `rotatum.simulation.simulate`.

        A serial joint's set-point is to be added.
        """
        return {
            joint.name: {
                role: _Share(self, place, motor)
                for motor, role in enumerate(_ROLES[len(joint.motors)])
            }
            for place, joint in enumerate(self.joints)
        }

    def torques(self, seen: Seen) -> Array:
        """Return what the controller says at this instant, (n, M) N m.

        Raises `RotatumError` unless it is one number for each motor.
        """
        if seen is not self._seen:
            self._torques = self._checked(self.controller(seen), seen.time)
            self._seen = seen
        return self._torques

    def _checked(self, given: Array, time: float) -> Array:
        torques = np.asarray(given, dtype=np.float64)
        n = len(self.joints)
        if torques.shape == (n,) and self._most == 1:
            return torques[:, np.newaxis]
        if torques.shape != (n, self._most):
            raise RotatumError(
                "a controller gives one torque for each motor",
                where=f"controller, t = {time:.6g} s",
                value=torques.shape,
                allowed=f"shape {(n, self._most)}",
            )
        return torques


class _Share:
    """One motor's part of a controller of all joints."""

    def __init__(self, whole: ArmControl, place: int, motor: int) -> None:
        self._whole, self._place, self._motor = whole, place, motor

    def torque(self, seen: Seen) -> float:
        """Return its torque [N m] at the joint side."""
        return self._whole.torques(seen).item(self._place, self._motor)
