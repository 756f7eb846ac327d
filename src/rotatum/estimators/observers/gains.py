"""Gains that put an observer's poles where they are wanted, zero included."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.system import null

Array = NDArray[np.float64]


def place(A: Array, S: Array, poles: ArrayLike) -> Array:
    """Return F, (n, r), with the eigenvalues of ``A - F S`` at ``poles``.

    Args:
        A: (n, n).
        S: (r, n), of full row rank, (S, A) observable.
        poles: (n,), complex ones in conjugate pairs, none repeated more than r times.

    Raises:
        MethodError: their number, their multiplicity or a missing conjugate.
    """
    from scipy.signal import place_poles  # heavy

    wanted = np.atleast_1d(np.asarray(poles))
    if len(wanted) != len(A):
        raise MethodError(
            "wrong number of poles: one for every state that is no fixed mode",
            where="poles",
            value=len(wanted),
            allowed=str(len(A)),
        )
    if (np.abs(wanted) >= 1.0).any():
        raise MethodError("poles must decay", where="poles", value=wanted.tolist(),
                          allowed="inside the unit circle")  # fmt: skip
    if len(A) == 0:
        return np.zeros((0, len(S)))
    try:
        # What may not converge is how little the poles mind errors of A, not where they stand.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            found = place_poles(A.T, S.T, wanted, maxiter=100, rtol=1e-6)
    except ValueError as error:
        raise MethodError(f"poles cannot be placed: {error}", where="poles",
                          value=wanted.tolist()) from None  # fmt: skip
    return np.asarray(found.gain_matrix.T, dtype=np.float64)


def deadbeat(A: Array, S: Array) -> Array:
    """Return F, (n, r), with ``A - F S`` nilpotent, in the fewest steps.

    Dual to control: V_j, the states of ``z+ = A^T z + S^T w`` that j steps take to zero, are
    nested; the gain takes every vector of V_j into V_(j-1).

    Args:
        A: (n, n).
        S: (r, n), (S, A) observable but for modes at zero.

    Raises:
        MethodError: a mode that is not zero is unobservable.
    """
    At, St = A.T, S.T
    n = len(A)
    V = np.zeros((n, 0))
    W = np.zeros((len(S), 0))
    while V.shape[1] < n:
        outside = null(V.T).T if V.shape[1] else np.eye(n)  # rows: what must vanish
        reach = null((outside @ St).T).T @ outside
        larger = null(reach @ At) if len(reach) else np.eye(n)
        fresh = larger - V @ (V.T @ larger)
        U, sizes, _ = np.linalg.svd(fresh, full_matrices=False)
        new = U[:, sizes > 0.5]  # singular values are 0 or 1: two nested orthonormal bases
        if new.shape[1] == 0:
            raise MethodError("a mode that is not zero is unobservable", where="deadbeat")
        W = np.hstack([W, np.linalg.pinv(outside @ St, rcond=1e-10) @ (outside @ At @ new)])
        V = np.hstack([V, new])
    return np.asarray((W @ V.T).T)
