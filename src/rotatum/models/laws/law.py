"""What an elastic law is: constants, eight scalar functions, and where they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Constant",
    "Kernel",
    "Law",
    "Values",
    "Vector",
    "everywhere",
    "firm_range",
    "no_setpoint",
]

Array = NDArray[np.float64]


class Vector(Protocol):
    """Packed constants as a kernel sees them: a record's field, or an array (n,)."""

    def __len__(self) -> int:
        """Return how many there are."""

    def __getitem__(self, index: int, /) -> float:
        """Return one."""


Kernel = Callable[[Any, float, float], float]
Values = Mapping[str, tuple[float, ...]]
"""Constants by name as the file gives them; a single number is a tuple of one."""


class Constant(NamedTuple):
    """A constant of a law.

    Parameters
    ----------
    name : key in the device file.
    unit : SI unit; "" where it has none.
    doc : what it is.
    positive : whether it must be greater than 0.
    many : whether it is a list of numbers.
    """

    name: str
    unit: str
    doc: str
    positive: bool = True
    many: bool = False


def no_setpoint(c: Vector, phi: float, s: float) -> float:
    """Return the derivative with respect to a set-point the law does not have: 0."""
    return 0.0


def everywhere(c: Array, s: float) -> tuple[float, float]:
    """Return the range of a law that holds at any deflection."""
    return -inf, inf


def any_setpoint(c: Array) -> tuple[float, float]:
    """Return the range of a law that holds at any set-point."""
    return -inf, inf


def nothing_wrong(values: Values) -> str | None:
    """Accept all constants."""
    return None


def in_order(values: Values) -> tuple[float, ...]:
    """Put the constants one after the other."""
    return tuple(number for numbers in values.values() for number in numbers)


class Law(NamedTuple):
    """An elastic law: torque over deflection and, with one, set-point.

    The eight functions take ``(c, phi, s)``: `c` (n,) the packed constants, `phi` [rad] the
    deflection, `s` the set-point (0.0 where the law has none). They are kernels: scalar, in the
    exportable subset, and finite at any finite deflection, so that simulation, exported C and
    `Transmission` run the same text.

    Parameters
    ----------
    name : as in a device file.
    formula : the torque in TeX.
    constants : in the order of the file's documentation.
    energy : U_e [J], at least 0, and 0 only at the law's rest.
    torque : tau_e = dU/dphi [N m].
    stiffness : sigma = dtau/dphi [N m/rad].
    slope : dsigma/dphi [N m/rad^2].
    curvature : d2sigma/dphi2 [N m/rad^3].
    energy_setpoint : dU/ds; the reaction on the set-point's motor is this times ds/dtheta_c.
    torque_setpoint : dtau/ds.
    stiffness_setpoint : dsigma/ds.
    limits : (lowest, highest) deflection at which the law holds and sigma is not negative.
    setpoint_unit : "" where the law has no set-point.
    setpoint_limits : (lowest, highest) set-point at which the law holds.
    odd : whether tau(-phi) = -tau(phi).
    cites : keys of `rotatum.report.references`.
    source : where the law is from, in words.
    wrong : says what is wrong with constants that are well formed one by one, or None.
    pack : turns the constants of a file into `c`.
    """

    name: str
    formula: str
    constants: tuple[Constant, ...]
    energy: Kernel
    torque: Kernel
    stiffness: Kernel
    slope: Kernel
    curvature: Kernel
    source: str
    energy_setpoint: Kernel = no_setpoint
    torque_setpoint: Kernel = no_setpoint
    stiffness_setpoint: Kernel = no_setpoint
    limits: Callable[[Array, float], tuple[float, float]] = everywhere
    setpoint_unit: str = ""
    setpoint_limits: Callable[[Array], tuple[float, float]] = any_setpoint
    odd: bool = True
    cites: tuple[str, ...] = ()
    wrong: Callable[[Values], str | None] = nothing_wrong
    pack: Callable[[Values], tuple[float, ...]] = in_order

    @property
    def uses_setpoint(self) -> bool:
        """Whether the torque depends on a set-point."""
        return self.torque_setpoint is not no_setpoint


def firm_range(sigma: Array) -> tuple[float, float]:
    """Return the range around 0 in which a polynomial stiffness is not negative.

    Parameters
    ----------
    sigma : (n,) coefficients of the stiffness, lowest power first.
    """
    # A leading zero has no root; numpy would divide by it.
    highest = np.flatnonzero(sigma)[-1]
    roots = np.roots(sigma[highest::-1])
    real = np.sort(roots.real[np.abs(roots.imag) <= 1e-9 * (1.0 + np.abs(roots))])
    sides = []
    for side in (-1.0, 1.0):
        marks = [*np.sort(side * real[side * real > 0.0]), inf]
        sides.append(side * _first_soft(sigma, side, marks))
    return sides[0], sides[1]


def _first_soft(sigma: Array, side: float, marks: list[float]) -> float:
    """Return the first mark beyond which the stiffness is negative."""
    for mark, following in pairwise(marks):
        inside = 0.5 * (mark + following) if following < inf else 2.0 * mark
        if np.polynomial.polynomial.polyval(side * inside, sigma) < 0.0:
            return mark
    return inf
