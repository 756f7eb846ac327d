"""A measured characteristic: monotone cubic interpolation (Fritsch and Carlson 1980)."""

from __future__ import annotations

import numpy as np

from rotatum.models.laws.law import Array, Constant, Law, Values, Vector

__all__ = ["TABLE"]

# One interval in `c`: where it starts, the energy there, and the torque's coefficients of
# powers 0 to 3 of the distance from its start. The last entry is where the last interval ends.
ROW = 6


def row(c: Vector, phi: float) -> int:
    """Return where the interval of a deflection starts in `c`; the nearest one from outside."""
    low = 0
    high = int(float(len(c) - 1) / ROW)
    while high - low > 1:
        middle = int(0.5 * float(low + high))
        if phi < c[ROW * middle]:
            high = middle
        else:
            low = middle
    return ROW * low


def inside(c: Vector, phi: float) -> float:
    """Return the deflection, kept inside the table."""
    if phi < c[0]:
        return c[0]
    if phi > c[len(c) - 1]:
        return c[len(c) - 1]
    return phi


def torque_at(c: Vector, p: float) -> float:
    """Return the interpolated torque."""
    i = row(c, p)
    t = p - c[i]
    return ((c[i + 5] * t + c[i + 4]) * t + c[i + 3]) * t + c[i + 2]


def stiffness_at(c: Vector, p: float) -> float:
    """Return the derivative of the interpolated torque."""
    i = row(c, p)
    t = p - c[i]
    return (3.0 * c[i + 5] * t + 2.0 * c[i + 4]) * t + c[i + 3]


def energy(c: Vector, phi: float, s: float) -> float:
    """Return the integral of the torque from rest on."""
    p = inside(c, phi)
    i = row(c, p)
    t = p - c[i]
    inner = ((0.25 * c[i + 5] * t + c[i + 4] / 3.0) * t + 0.5 * c[i + 3]) * t + c[i + 2]
    d = phi - p
    return c[i + 1] + inner * t + (torque_at(c, p) + 0.5 * stiffness_at(c, p) * d) * d


def torque(c: Vector, phi: float, s: float) -> float:
    """Return the interpolated torque; beyond the table it goes on with the last stiffness."""
    p = inside(c, phi)
    return torque_at(c, p) + stiffness_at(c, p) * (phi - p)


def stiffness(c: Vector, phi: float, s: float) -> float:
    """Return the derivative of the interpolated torque; beyond the table it stays."""
    return stiffness_at(c, inside(c, phi))


def slope(c: Vector, phi: float, s: float) -> float:
    """Return the second derivative, which jumps between intervals; beyond the table 0."""
    if inside(c, phi) != phi:
        return 0.0
    i = row(c, phi)
    return 6.0 * c[i + 5] * (phi - c[i]) + 2.0 * c[i + 4]


def curvature(c: Vector, phi: float, s: float) -> float:
    """Return the third derivative, constant in each interval; beyond the table 0."""
    if inside(c, phi) != phi:
        return 0.0
    return 6.0 * c[row(c, phi) + 5]


def limits(c: Array, s: float) -> tuple[float, float]:
    """Return the ends of the table."""
    return float(c[0]), float(c[-1])


def wrong(values: Values) -> str | None:
    """Ask for two lists of one length, both growing, the torque through 0."""
    deflection, torques = (np.array(values[name]) for name in ("deflection", "torque"))
    if len(deflection) != len(torques) or len(deflection) < 3:
        return "deflection and torque must be lists of one length, at least 3"
    if np.any(np.diff(deflection) <= 0.0) or np.any(np.diff(torques) <= 0.0):
        return "deflection and torque must both grow from each point to the next"
    if torques[0] > 0.0 or torques[-1] < 0.0:
        return "the table must contain the deflection at which the torque is 0"
    return None


def pack(values: Values) -> tuple[float, ...]:
    """Return the intervals of scipy's `PchipInterpolator`, one after the other."""
    from scipy.interpolate import PchipInterpolator

    curve = PchipInterpolator(values["deflection"], values["torque"])
    work = curve.antiderivative()
    # A torque that grows strictly is 0 in one place; at a knot both its intervals tell it.
    rest = float(curve.roots(extrapolate=False)[0])
    starts = curve.x[:-1]
    rows = np.column_stack([starts, work(starts) - work(rest), curve.c[::-1].T])
    return (*map(float, rows.ravel()), float(curve.x[-1]))


TABLE = Law(
    name="table",
    formula=r"\text{monotone cubic through the points}",
    constants=(
        Constant("deflection", "rad", "of the points, growing", positive=False, many=True),
        Constant("torque", "N m", "at the points, growing through 0", positive=False, many=True),
    ),
    energy=energy,
    torque=torque,
    stiffness=stiffness,
    slope=slope,
    curvature=curvature,
    source="measured characteristics; Fritsch and Carlson 1980",
    limits=limits,
    odd=False,
    wrong=wrong,
    pack=pack,
)
