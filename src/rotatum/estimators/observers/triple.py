"""The triple integrator of trumic2022: link position measured, jerk unknown."""

from __future__ import annotations

import numpy as np

from rotatum.estimators.observers.decoupled import Exact, assemble
from rotatum.estimators.observers.system import System, system

DELAY = 3


def triple_integrator(period: float, joints: int = 1) -> System:
    """Return eq. 8's A_n with B = (0, 0, T I), C = (I, 0, 0): Euler's rule on ``q''' = U``.

    Args:
        period: T [s].
        joints: n; states are (q, q', q''), n of each.
    """
    A = np.array([[1.0, period, 0.0], [0.0, 1.0, period], [0.0, 0.0, 1.0]])
    each = np.eye(joints)
    return system(
        np.kron(A, each),
        np.kron([[0.0], [0.0], [period]], each),
        np.kron([[1.0, 0.0, 0.0]], each),
    )


def printed_observer(period: float, joints: int = 1) -> Exact:
    """Return the observer of eqs 7-8 as printed; with one joint, that of eq. 13.

    E is nilpotent, ``E^3 = 0``: from the fourth window on, the input's estimate is the third
    backward difference ``(q(k) - 3 q(k-1) + 3 q(k-2) - q(k-3)) / T^3`` and the state the forward
    differences at k - 3. Seen as derivatives of q they belong to different instants: q to k - 3,
    q' to k - 2.5, q'' to k - 2, U to k - 1.5.

    Args:
        period: T [s].
        joints: n.
    """
    T = period
    each = np.eye(joints)
    E = np.array([[1.0, T, 0.0], [0.0, 1.0, T], [-1.0 / T**2, -3.0 / T, -2.0]])
    F = np.zeros((3, DELAY + 1))
    F[2, DELAY] = 1.0 / T**2
    E, F = np.asarray(np.kron(E, each), np.float64), np.asarray(np.kron(F, each), np.float64)
    return assemble(triple_integrator(T, joints), E, F, np.zeros(0, dtype=np.complex128))
