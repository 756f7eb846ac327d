"""Smooth motions from rest to rest: every joint at once, on the polynomial of least degree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from rotatum.errors import RotatumError

__all__ = ["SMOOTH", "LinkTrajectory", "RestToRest", "blend", "shortest_duration"]

Array = NDArray[np.float64]

SMOOTH = 6
"""Derivatives that inverse dynamics of elastic joints with coupled rotors takes of a motion."""


def blend(smooth: int = SMOOTH) -> Polynomial:
    """Return s(u), 0 at u = 0 and 1 at u = 1, its first `smooth` derivatives 0 at both.

    Of degree ``2 smooth + 1``, the least that can: ``s' = c u^m (1 - u)^m``.
    """
    bump = Polynomial([0.0, 1.0, -1.0]) ** smooth
    # written in u - 1/2: in powers of u the coefficients are large and of both signs, and cancel
    middle = bump(Polynomial([0.5, 1.0]))
    rise = middle.integ(lbnd=-0.5)
    return rise / rise(0.5)


def shortest_duration(
    distances: Sequence[float] | Array, limits: Sequence[float], smooth: int = SMOOTH
) -> float:
    """Return the shortest duration [s] of a rest-to-rest motion within its limits.

    Parameters
    ----------
    distances
        (n,) rad, of each joint.
    limits
        Of the largest velocity [rad/s], acceleration [rad/s^2], and so on: as many as are given,
        at most `smooth`; inf: none.
    smooth
        Derivatives that are continuous.

    Raises `RotatumError` for limits that are not positive, or more than `smooth` of them.
    """
    if len(limits) > smooth or not all(limit > 0.0 for limit in limits):
        raise RotatumError(
            "limits of velocity, acceleration, ... must be positive",
            where="limits",
            value=list(limits),
            allowed=f"at most {smooth} numbers above 0",
        )
    farthest = float(np.max(np.abs(distances), initial=0.0))
    s, shortest = blend(smooth), 0.0
    for order, limit in enumerate(limits, start=1):
        shortest = max(shortest, (farthest * _peak(s.deriv(order)) / limit) ** (1.0 / order))
    return shortest


def _peak(x: Polynomial) -> float:
    """Return the largest magnitude of x on [-1/2, 1/2]."""
    turns = x.deriv().roots()
    real = turns.real[(np.abs(turns.imag) < 1e-6) & (np.abs(turns.real) <= 0.5)]
    return float(np.max(np.abs(x(np.array([-0.5, 0.5, *real])))))


class LinkTrajectory(Protocol):
    """A motion of all links with its derivatives; what inverse dynamics asks for."""

    @property
    def size(self) -> int:
        """Number of links n."""

    def derivatives(self, time: Array, most: int) -> Array:
        """Return q, q', ... to the derivative `most`, (most + 1, N, n) rad, rad/s, ..."""


@dataclass(frozen=True, eq=False)
class RestToRest:
    """All links from rest to rest together: ``q = start + (end - start) s((t - begin) / seconds)``.

    They hold before and after. Derivatives up to `smooth` are continuous; the polynomial has the
    least degree, ``2 smooth + 1``.

    Parameters
    ----------
    start, end
        (n,) rad.
    begin, seconds
        When the motion begins, and how long it lasts [s].
    smooth
        Derivatives that are continuous; `SMOOTH` is what motors coupled to the links ask for.

    Raises `RotatumError` for positions of two sizes, or a duration that is not positive.
    """

    start: Array
    end: Array
    begin: float
    seconds: float
    smooth: int = SMOOTH

    def __post_init__(self) -> None:
        """Check the numbers."""
        if np.shape(self.start) != np.shape(self.end) or np.ndim(self.start) != 1:
            raise RotatumError(
                "a motion begins and ends at one position for each joint",
                where="trajectory",
                value=(np.shape(self.start), np.shape(self.end)),
            )
        if not (self.seconds > 0.0 and np.isfinite(self.seconds)):
            what = "a motion needs a positive duration"
            raise RotatumError(what, where="trajectory.seconds", value=self.seconds)

    @property
    def size(self) -> int:
        """Number of links n."""
        return len(self.start)

    @property
    def stop(self) -> float:
        """When the links stand again [s]."""
        return self.begin + self.seconds

    def derivatives(self, time: Array, most: int = SMOOTH) -> Array:
        """Return q, q', ... to the derivative `most` at instants (N,) [s], (most + 1, N, n).

        In rad, rad/s, and so on; zero outside the motion but for q itself.
        """
        u = (np.asarray(time, dtype=np.float64) - self.begin) / self.seconds - 0.5
        inside = np.abs(u) < 0.5
        s, way = blend(self.smooth), np.asarray(self.end) - self.start
        rows = [np.where(inside, s(u), np.where(u > 0.0, 1.0, 0.0))[:, np.newaxis] * way]
        rows[0] += self.start
        for order in range(1, most + 1):
            rate = s.deriv(order)(u) / self.seconds**order
            rows.append(np.where(inside, rate, 0.0)[:, np.newaxis] * way)
        return np.array(rows)
