"""One transmission of each law, with the deflections and set-points it is examined at."""

from __future__ import annotations

from math import log
from typing import Any, NamedTuple

from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from rotatum.models import Transmission


class Case(NamedTuple):
    """A law with numbers.

    Parameters
    ----------
    table : the [transmission] table.
    reach : largest deflection examined, inside the range [rad].
    setpoints : those examined.
    rest : deflection at rest [rad].
    """

    table: dict[str, Any]
    reach: float
    setpoints: tuple[float, ...] = (0.0,)
    rest: float = 0.0

    @property
    def transmission(self) -> Transmission:
        """The transmission."""
        return Transmission.model_validate(self.table)


MACCEPA = {"law": "maccepa", "spring": 323.0, "lever": 0.03, "base": 0.17, "drum": 0.01}
KNOTS = [-0.5, -0.3, -0.1, 0.05, 0.2, 0.35, 0.6]
TORQUES = [-4.0, -1.9, -0.55, 0.21, 1.1, 2.3, 7.0]
REST = brentq(PchipInterpolator(KNOTS, TORQUES), -0.1, 0.05, xtol=1e-16)
CASES = {
    "linear": Case({"law": "linear", "stiffness": 103.0}, 0.3),
    "cubic": Case({"law": "cubic", "stiffness": 250.0, "cubic": 2e4}, 0.08),
    "cubic, softening": Case({"law": "cubic", "stiffness": 250.0, "cubic": -1e4}, 0.08),
    "odd_polynomial": Case({"law": "odd_polynomial", "coefficients": [2.0, 5.0, -1.0, 0.5]}, 0.9),
    "odd_polynomial, toy": Case({"law": "odd_polynomial", "coefficients": [0.0, 10.0]}, 0.9),
    "polynomial": Case({"law": "polynomial", "coefficients": [3.0, 0.8, 2.0, -0.3, 0.1]}, 0.5),
    "sinh": Case({"law": "sinh", "k": 0.0227, "a": 6.7328}, 0.8),
    "exponential": Case(
        {"law": "exponential", "k": 1.6e5, "ke": 8.71, "a": 1.21e-6, "b": 2.38e-6},
        0.27,
        rest=log(1.21 / 2.38) / (2.0 * 8.71),
    ),
    "fourbar": Case({"law": "fourbar", "spring": 2.5, "ratio": 2**0.5}, 1.2),
    "fourbar, steep": Case({"law": "fourbar", "spring": 0.41, "ratio": 2.0}, 0.85),
    "lever": Case({"law": "lever", "spring": 14220.0}, 0.7, (0.05, 0.1, 0.12)),
    "lever_ratio": Case(
        {"law": "lever_ratio", "spring": 10.0, "length": 0.05, "arm": 0.015},
        0.3,
        (0.005, 0.02, 0.04),
    ),
    "maccepa": Case(MACCEPA, 1.0, (0.5, 1.0, 3.0)),
    "table": Case({"law": "table", "deflection": KNOTS, "torque": TORQUES}, 0.45, rest=REST),
}
