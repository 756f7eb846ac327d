"""A fitted law on its own: evaluated anywhere, or read in powers of the set-point itself."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.columns import Power, setpoint_scale
from rotatum.evaluation.estimate import JointEstimate
from rotatum.models import Joint

__all__ = ["FrozenLaw", "frozen", "raw_powers"]

Array = NDArray[np.float64]


class FrozenLaw(NamedTuple):
    """``tau = sum_h a_h phi^i_h (s - middle)^j_h`` of one transmission, SI.

    Args:
        powers: (i_h, j_h).
        coefficients: (b,) a_h.
        middle: of the set-point's range.
    """

    powers: tuple[Power, ...]
    coefficients: Array
    middle: float = 0.0

    def torque(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return the elastic torque [N m] at deflections [rad] and set-points."""
        x, s = np.asarray(phi, np.float64), np.asarray(setpoint, np.float64) - self.middle
        terms = zip(self.powers, self.coefficients.tolist(), strict=True)
        return sum((a * x**i * s**j for (i, j), a in terms), np.zeros_like(x + s))

    def stiffness(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return the stiffness [N m/rad] there (flacco2012 eqs 28 and 37)."""
        x, s = np.asarray(phi, np.float64), np.asarray(setpoint, np.float64) - self.middle
        terms = zip(self.powers, self.coefficients.tolist(), strict=True)
        found = (a * i * x ** (i - 1) * s**j for (i, j), a in terms if i > 0)
        return sum(found, np.zeros_like(x + s))

    def raw(self) -> dict[Power, float]:
        """Return the coefficients of ``phi^i s^j``, the eta_ij of flacco2012 eq. 35."""
        return raw_powers(self.powers, self.coefficients.tolist(), self.middle)


def raw_powers(
    powers: Sequence[Power], coefficients: Sequence[float], middle: float
) -> dict[Power, float]:
    """Expand ``sum_h a_h phi^i_h (s - middle)^j_h`` into coefficients of ``phi^i s^j``.

    ``(s - m)^j = sum_l C(j, l) (-m)^(j - l) s^l``.

    Args:
        powers: (i_h, j_h), each once.
        coefficients: a_h.
        middle: m.
    """
    found: dict[Power, float] = {}
    for (i, j), a in zip(powers, coefficients, strict=True):
        for lower in range(j + 1):
            power = Power(i, lower)
            share = a * comb(j, lower) * (-middle) ** (j - lower)
            found[power] = found.get(power, 0.0) + share
    return found


def frozen(joint: Joint, estimate: JointEstimate) -> tuple[FrozenLaw, ...]:
    """Return the final law of each transmission of an estimate.

    Args:
        joint: as it was estimated.
        estimate: its result.
    """
    own = len(estimate.powers)
    middle = setpoint_scale(joint).middle
    return tuple(
        FrozenLaw(estimate.powers, part.coefficients[len(part.coefficients) - own :], middle)
        for part in estimate.parts
    )
