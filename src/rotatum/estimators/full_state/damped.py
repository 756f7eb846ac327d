"""Solve for joint motions what sensors on the links tell of them, damped where they hardly do."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["DampedInverse", "Told", "damped_inverse", "told_generically"]

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

_POSES = 12  # at random; generic properties hold at almost every one
_SEED = 20070410
_RANK = 1e-9  # singular values below this part of the largest are 0: rounding is 1e-16 of it
_TOLD = 1e-6  # of a share of 1, far above rounding over `_RANK`, far below any damping


class Told(NamedTuple):
    """What sensors tell at almost every pose.

    Args:
        joints: (n,) whether the joint's own motion is determined, whatever the others do.
        rank: number of independent combinations that are told.
        scale: the largest singular value met.
    """

    joints: Bools
    rank: int
    scale: float


class DampedInverse(NamedTuple):
    """A left inverse (deluca2007 eq. 11), damped along directions that are hardly told.

    Args:
        matrix: (n, M).
        share: (n,) diagonal of the resolution matrix, ``matrix @ T``: 1 where the sensors tell a
            joint's own motion, 0 where they tell nothing of it.
        condition: largest singular value over the smallest of those generically not 0; inf.
    """

    matrix: Array
    share: Array
    condition: float


def damped_inverse(T: Array, threshold: float, rank: int) -> DampedInverse:
    """Return the inverse of a map of joint motions to readings.

    ``V diag(h(s)) U^T`` of ``T = U diag(s) V^T``, with ``h = 1/s`` where s is at least the
    threshold e, and below it::

        h = s / (s^2 + (e - s)^2)

    which is damping (Nakamura and Hanafusa 1986) of the small singular values only (Maciejewski and
    Klein 1988), by ``e (1 - s/e)``. Both ends meet with equal slopes, h(0) is 0, and h is nowhere
    above ``1.21 / e``: noise is not amplified beyond that. As h is odd and Lipschitz (2.56 / e^2),
    so is the inverse as a function of T, in the Frobenius norm: it does not jump, not where
    singular values cross either. Departure from eq. 11: its T must have full *column* rank.

    Args:
        T: (M, n), rows weighted by the sensors' precision; no NaN.
        threshold: e, in the unit of T.
        rank: generic rank, for the condition.
    """
    u, s, vt = np.linalg.svd(T, full_matrices=False)
    under = np.maximum(threshold - s, 0.0)
    h = s / (s * s + under * under)
    weighted = vt.T * h
    share = (weighted * s * vt.T).sum(axis=1)
    least = float(s[rank - 1]) if 0 < rank <= len(s) else 0.0
    condition = float(s[0]) / least if least > 0.0 else np.inf
    return DampedInverse(weighted.dot(u.T), share, condition)


def told_generically(matrix: Callable[[Array], Array], n: int) -> Told:
    """Find which joints' motions sensors determine at almost every pose.

    A joint i is determined where its unit vector lies in the row space of T(q): the others then
    have no part in it. Found from the singular vectors at a few random poses, the same each time:
    T is analytic in q, and what does not hold at one of them by chance holds at almost none.

    Args:
        matrix: of a pose (n,) [rad] to T(q), (M, n), weighted.
        n: number of joints.
    """
    poses = np.random.default_rng(_SEED).uniform(-np.pi, np.pi, (_POSES, n))
    found, scale = [], 0.0
    for q in poses:
        T = matrix(q)
        if not len(T):
            return Told(np.zeros(n, dtype=np.bool_), 0, 0.0)
        _, s, vt = np.linalg.svd(T, full_matrices=False)
        rows = vt[s > _RANK * s[0]]
        found.append((len(rows), (rows * rows).sum(axis=0) > 1.0 - _TOLD))
        scale = max(scale, float(s[0]))
    rank = max(count for count, _ in found)
    joints = np.all([told for count, told in found if count == rank], axis=0)
    return Told(joints, rank, scale)
