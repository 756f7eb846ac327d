"""Motion and stiffness of an antagonistic joint decoupled: input-output linearisation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState
from rotatum.control.pole_placement import PolePair
from rotatum.errors import RotatumError
from rotatum.models.elastic import Elastic

__all__ = ["Decoupled", "DecouplingGains", "DecouplingLaw", "Target", "steerability"]

Array = NDArray[np.float64]


class Target(NamedTuple):
    """What link and stiffness are to do at an instant.

    Parameters
    ----------
    q : (5,) q_d and its derivatives up to the fourth [rad, rad/s, ...].
    sigma : (3,) sigma_d and its derivatives up to the second [N m/rad, N m/(rad s), ...].
    """

    q: tuple[float, ...]
    sigma: tuple[float, ...]


@dataclass(frozen=True)
class DecouplingGains:
    """How errors of position and stiffness die away.

    ``e'''' + k_3 e''' + k_2 e'' + k_1 e' + k_0 e = 0`` and ``s'' + l_1 s' + l_0 s = 0``.

    Attributes
    ----------
    motion : (4,) k_0 to k_3 [1/s^4, 1/s^3, ...].
    stiffness : (2,) l_0, l_1 [1/s^2, 1/s].

    Raises `RotatumError` for gains that do not make errors die away.
    """

    motion: tuple[float, float, float, float]
    stiffness: tuple[float, float]

    @classmethod
    def of_poles(cls, motion: tuple[PolePair, PolePair], stiffness: PolePair) -> DecouplingGains:
        """Return the gains for these poles: four of the motion's errors, two of stiffness'."""
        whole = np.polymul(motion[0].polynomial, motion[1].polynomial)
        k3, k2, k1, k0 = whole[1:].tolist()
        l1, l0 = stiffness.polynomial[1:].tolist()
        return cls((k0, k1, k2, k3), (l0, l1))

    def __post_init__(self) -> None:
        """Refuse poles that are not on the left."""
        for name in ("motion", "stiffness"):
            given = getattr(self, name)
            roots = np.roots([1.0, *reversed(given)]) if np.all(np.isfinite(given)) else [math.inf]
            if not np.max(np.real(roots)) < 0.0:
                what = "these gains do not make errors die away"
                raise RotatumError(what, where=f"gains.{name}", value=given)


class Decoupled(NamedTuple):
    """What the law says at an instant.

    Parameters
    ----------
    torques : (2,) u_1, u_2 within the motors' limits [N m]; not finite where the matrix is
        singular.
    wanted : (2,) the same without limits [N m].
    steerability : of the stiffness here, see `steerability`.
    saturated : whether a limit took something.
    """

    torques: Array
    wanted: Array
    steerability: float
    saturated: bool


def steerability(springs: tuple[Elastic, Elastic], reach: float) -> float:
    """Return how much the motors can do to the stiffness, 0: nothing.

    ``c = reach (sigma_1 sigma_2' - sigma_2 sigma_1') / (sigma_1 + sigma_2)^2``, the determinant of
    the decoupling matrix without inertias and units: by what share of itself the total stiffness
    changes when phi_2 - phi_1 grows by `reach` and the link's torque stays. Springs that harden to
    both sides have it positive contracted one way, negative the other.

    Parameters
    ----------
    springs
        Both transmissions at their deflections.
    reach
        Deflection that a change is counted over [rad].
    """
    a, b = springs
    total = a.stiffness + b.stiffness
    if not total > 0.0:
        return 0.0
    return reach * (a.stiffness * b.slope - b.stiffness * a.slope) / (total * total)


@dataclass(frozen=True)
class DecouplingLaw:
    """Torques that make position and stiffness two linear systems that do not see each other.

    With ``(q'''', sigma_t'') = drift + A u`` (`AntagonisticJoint.outputs`)::

        u = A^-1 (v - drift)
        v_1 = q_d'''' + sum_j k_j (q_d^(j) - q^(j))
        v_2 = sigma_d'' + sum_j l_j (sigma_d^(j) - sigma_t^(j))

    Four derivatives of q and two of sigma_t are the joint's six states: nothing is left inside.
    Accelerations and jerks are the model's, of the elastic torques and their rates; no measured
    signal is differentiated more than once. Where ``sigma_1 sigma_2' = sigma_2 sigma_1'`` A is
    singular (springs that are not co-contracted, or the straight part of their laws): no torque
    moves the stiffness at once. The inverse is not damped there: damping would take the link off
    its path too, and never out of the singularity, which a motor position does.

    Attributes
    ----------
    joint : its constants.
    gains : how errors die away.
    reach : deflection that steerability is counted over [rad].
    """

    joint: AntagonisticJoint
    gains: DecouplingGains
    reach: float

    def torques(
        self, state: JointState, springs: tuple[Elastic, Elastic], target: Target
    ) -> Decoupled:
        """Return the motor torques at a state.

        Parameters
        ----------
        state
            Where the joint is.
        springs
            Both transmissions at its deflections, as they are known.
        target
            What position and stiffness are to do.
        """
        now = self.joint.outputs(state, springs)
        v_q, v_s = target.q[4], target.sigma[2]
        for k, wanted, is_ in zip(self.gains.motion, target.q, now.q, strict=False):
            v_q += k * (wanted - is_)
        for k, wanted, is_ in zip(self.gains.stiffness, target.sigma, now.sigma, strict=False):
            v_s += k * (wanted - is_)
        (a, b), (c, d) = now.matrix.tolist()
        x, y = v_q - now.drift[0], v_s - now.drift[1]
        determinant = a * d - b * c
        if determinant == 0.0:
            free = np.full(2, math.nan)
        else:
            free = np.array([d * x - b * y, a * y - c * x]) / determinant
        limits = np.array(self.joint.limits)
        limited = np.clip(free, -limits, limits)
        saturated = bool(np.any(np.abs(free) > limits))
        return Decoupled(limited, free, steerability(springs, self.reach), saturated)
