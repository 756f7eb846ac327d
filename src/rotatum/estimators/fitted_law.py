"""The elastic law an estimator has found so far, to be evaluated at any deflection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rotatum.errors import MethodError
from rotatum.estimators.columns import deflection_range
from rotatum.estimators.tuning import Prepared
from rotatum.models.elastic import Elastic

__all__ = ["FittedLaw", "fitted_laws", "zeros_of"]


@dataclass(frozen=True)
class FittedLaw:
    """A polynomial of the deflection: ``tau_e = sum_h a_h x^h``, ``x = (q - theta - zero) / r``.

    It is what the estimator says now, and stays as it is when the estimator goes on. Beyond the
    deflections that were met it is an extrapolation.

    Attributes
    ----------
    coefficients : a_0, a_1, ..., from the lowest power on [N m].
    reach : r, half the declared range of the deflection [rad].
    zero : q - theta at rest [rad].
    offset : of the motor's torque, where it is fitted: what the data could not tell apart from the
        spring's torque is in one of the two, and right in their sum [N m].
    """

    coefficients: tuple[float, ...]
    reach: float
    zero: float = 0.0
    offset: float = 0.0

    def evaluate(self, phi: float) -> Elastic:
        """Return the transmission at q - theta [rad]."""
        x = (phi - self.zero) / self.reach
        value = first = second = third = 0.0
        # Horner's rule, each derivative over its factorial
        for a in reversed(self.coefficients):
            third = third * x + second
            second = second * x + first
            first = first * x + value
            value = value * x + a
        r = self.reach
        return Elastic(value, first / r, 2.0 * second / r**2, 6.0 * third / r**3, self.offset)


def fitted_laws(
    prepared: Prepared, coefficients: Sequence[float], zeros: Sequence[float]
) -> tuple[FittedLaw, ...]:
    """Return the law of each transmission of a joint.

    Args:
        prepared: the joint; columns of a transmission are the fitted ones, then the basis.
        coefficients: of all transmissions, agonist first, in normalised coordinates, N m.
        zeros: of each transmission's deflection, rad.

    Raises:
        MethodError: the law depends on a set-point, so that it is none of the deflection alone.
    """
    joint = prepared.joint
    if any(power.setpoint for power in prepared.powers):
        what = "a law that depends on a set-point is not one of the deflection alone"
        raise MethodError(what, where=f"joint {joint.name}, basis.setpoint_orders")
    highest = max(power.deflection for power in prepared.powers)
    width, fitted = len(prepared.columns), len(prepared.columns) - len(prepared.powers)
    laws = []
    for i, zero in enumerate(zeros):
        dense = [0.0] * (highest + 1)
        own = coefficients[i * width + fitted : (i + 1) * width]
        for power, a in zip(prepared.powers, own, strict=True):
            dense[power.deflection] = a
        offset = 0.0
        if "offset" in prepared.columns and prepared.settings.side == "motor":
            offset = coefficients[i * width + prepared.columns.index("offset")]
        laws.append(FittedLaw(tuple(dense), deflection_range(joint), zero, offset))
    return tuple(laws)


def zeros_of(rows: Any) -> list[float]:
    """Return the zeros of the deflections in the state of a part's rows, ``(1,)`` records [rad]."""
    names = [name for name in ("zero", "zero2") if name in rows.dtype.names]
    return [rows[name]["zero"].item() for name in names]
