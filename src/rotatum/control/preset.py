"""Where the motors of an antagonistic joint have to stand for a position and a stiffness."""

from __future__ import annotations

import math

from rotatum.models.elastic import ElasticLaw

__all__ = ["preset"]

_STEPS = 12  # a loop asks at every sample, from where it was before
_LARGEST = 0.3  # of the reach that one step may move a deflection: laws harden
_CLOSE = 1e-9  # of torque and stiffness, relative


def preset(
    laws: tuple[ElasticLaw, ElasticLaw],
    load: float,
    stiffness: float,
    guess: tuple[float, float],
    reach: float,
) -> tuple[float, float] | None:
    """Return the deflections at which two springs carry a load with a stiffness.

    ``tau_1(phi_1) + tau_2(phi_2) = load``, ``sigma_1(phi_1) + sigma_2(phi_2) = stiffness``, by
    Newton's method; of the solutions (co-contracted or the other way round) the one it comes to
    from the guess. None where it comes to none: a stiffness below what the load leaves.

    Parameters
    ----------
    laws
        Of both transmissions.
    load
        The elastic torque on the link, -g(q) at rest [N m].
    stiffness
        sigma_t [N m/rad].
    guess
        (2,) deflections to begin at [rad].
    reach
        Deflection of the order of the joint's [rad]; a step is at most a part of it.
    """
    x, y = guess
    for _ in range(_STEPS):
        a, b = laws[0].evaluate(x), laws[1].evaluate(y)
        miss = a.torque + b.torque - load
        soft = a.stiffness + b.stiffness - stiffness
        scale = abs(a.torque) + abs(b.torque) + abs(load)
        if abs(miss) <= _CLOSE * scale and abs(soft) <= _CLOSE * stiffness:
            return x, y
        determinant = a.stiffness * b.slope - b.stiffness * a.slope
        if determinant == 0.0 or not math.isfinite(determinant):
            return None
        dx = (b.slope * miss - b.stiffness * soft) / determinant
        dy = (a.stiffness * soft - a.slope * miss) / determinant
        short = min(1.0, _LARGEST * reach / max(abs(dx), abs(dy), 1e-300))
        x, y = x - short * dx, y - short * dy
    return None
