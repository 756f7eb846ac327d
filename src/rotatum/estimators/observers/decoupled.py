"""The exact design: inputs of any size decoupled, the error's poles placed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.observers.existence import decouple, require
from rotatum.estimators.observers.gains import deadbeat, place
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.system import System, null, scaled

Array = NDArray[np.float64]


class Exact(NamedTuple):
    """An observer ``X(k+1) = E X(k) + F Y(k)``, ``U(k) = J [X(k+1) - A X(k); y(k-L) - C X(k)]``.

    X(k) estimates x(k - L) from the outputs up to k - 1; U(k) estimates u(k - L).

    Args:
        E, F: (n, n), (n, (L + 1) p).
        J: (m, n + p), a left inverse of (B; D).
        fixed: modes that no design moves, the invariant zeros.
        recursion: the same with ``out = (X, U)``.
    """

    E: Array
    F: Array
    J: Array
    fixed: NDArray[np.complex128]
    recursion: Recursion


def exact_observer(given: System, delay: int, poles: ArrayLike | None = None) -> Exact:
    """Design the observer of trumic2022 Proposition 1 (Sundaram and Hadjicostis 2008).

    ``F = (F1, B) N`` decouples the inputs, ``F H^L = (B, 0)``; ``E = A - F O^L``; F1 places the
    poles. Invariant zeros of the system stay where they are, as poles of E.

    Where there are as many outputs as inputs, and the system is invertible, poles buy no noise:
    after the start, X and U are what any unbiased observer gives. Without noise y = G(z) u, and
    U = z^-L u for every u, so the transfer T(z) of the observer from y to U has T G = z^-L I; G
    is square and invertible, hence T = z^-L G^-1, in which neither F1 nor E appears (for X:
    z^-L (z I - A)^-1 B G^-1). The outputs do not reach the modes that were placed: only the error
    of the start runs through them. A longer delay only delays. With more outputs than inputs T
    is not unique: see `least_noise_observer`.

    Departure from eq. 6 as printed: the output in the residual is y(k-L), the one of the instant
    that X(k) belongs to.

    Args:
        given: the system.
        delay: L.
        poles: for all modes but the fixed ones; None: deadbeat, the error vanishes in the fewest
            steps but for fixed modes.

    Raises:
        MethodError: no observer exists, with this delay or at all (see `require`), or poles that
            cannot be placed.
    """
    require(given, delay)
    s = scaled(given)
    left = decouple(s, delay)
    seen = null(left.unseen.T)
    inner, outputs = seen.T @ left.Abar @ seen, left.S1 @ seen
    F1 = seen @ (deadbeat(inner, outputs) if poles is None else place(inner, outputs, poles))
    N = np.vstack([left.N1, left.N2])
    F = np.hstack([F1, s.system.B]) @ N * s.x[:, None] / np.tile(s.y, delay + 1)
    E = (left.Abar - F1 @ left.S1) * s.x[:, None] / s.x
    return assemble(given, E, F, left.zeros())


def assemble(given: System, E: Array, F: Array, fixed: NDArray[np.complex128]) -> Exact:
    """Complete E and F by the read-out of the input.

    Args:
        given: the system.
        E, F: in its units; conditions A1 and A2 hold.
        fixed: modes to report.
    """
    A, C = given.A, given.C
    n, _, p = given.sizes
    # Numbers of one unit: B may be 1e-9 in SI and D of order one.
    s = scaled(given)
    J = np.linalg.pinv(np.vstack([s.system.B, s.system.D]))
    J = J * s.u[:, None] / np.concatenate([s.x, s.y])
    first = np.hstack([np.eye(p), np.zeros((p, F.shape[1] - p))])
    G = np.vstack([np.eye(n), J[:, :n] @ (E - A) - J[:, n:] @ C])
    K = np.vstack([np.zeros((n, F.shape[1])), J[:, :n] @ F + J[:, n:] @ first])
    return Exact(E, F, J, fixed, Recursion(E, F, G, K, p, F.shape[1] // p - 1))
