"""Springs that are no straight lines, as the observers see them: their tangents."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.models.joint import Joint

__all__ = ["Tangents"]

Array = NDArray[np.float64]
_STRAIGHT = "linear"


def law_setpoints(joints: Sequence[Joint], logged: Array) -> Array:
    """Return set-points in the laws' units, (n,), of those logged; 0 where there is none."""
    found = [
        0.0 if joint.setpoint is None else joint.setpoint.value(float(s))
        for joint, s in zip(joints, logged, strict=True)
    ]
    return np.array(found)


class Tangents:
    """Stiffness and bias torque of each joint's law at a deflection.

    ``tau_e = sigma phi + bias`` near it, phi the deflection from the spring's zero. Of a linear law
    both stay 0, which stands for the observer's own stiffness.

    Args:
        joints: n series or serial joints.
    """

    def __init__(self, joints: Sequence[Joint]) -> None:
        n = len(joints)
        self._bent = [
            (i, joint) for i, joint in enumerate(joints)
            if joint.transmission.law not in (None, _STRAIGHT)
        ]  # fmt: skip
        self.stiffness, self.bias = np.zeros(n), np.zeros(n)

    def move(self, deflection: Array, setpoint: Array) -> None:
        """Fill `stiffness` [N m/rad] and `bias` [N m].

        Args:
            deflection: (n,) rad, as observed; beyond a law's range its end is taken.
            setpoint: (n,) in the laws' units.
        """
        for i, joint in self._bent:
            spring, s = joint.transmission, float(setpoint[i])
            low, high = spring.limits(s)
            phi = min(max(float(deflection[i]), low), high)
            sigma = float(spring.stiffness(phi, s))
            self.stiffness[i] = sigma
            self.bias[i] = float(spring.torque(phi, s)) - sigma * phi
