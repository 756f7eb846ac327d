"""A discrete linear system with unknown inputs, its observability and invertibility matrices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError

Array = NDArray[np.float64]
RANK = 1e-10  # singular values below this share of the largest are zero; all matrices are scaled


class System(NamedTuple):
    """``x(k+1) = A x(k) + B u(k)``, ``y(k) = C x(k) + D u(k)``: trumic2022 eq. 5, u unknown.

    Args:
        A: (n, n).
        B: (n, m).
        C: (p, n).
        D: (p, m).
    """

    A: Array
    B: Array
    C: Array
    D: Array

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of states n, inputs m and outputs p."""
        return len(self.A), self.B.shape[1], len(self.C)


def system(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None) -> System:
    """Make a system of matrices that fit together.

    Args:
        A, B, C: (n, n), (n, m), (p, n).
        D: (p, m); None: no direct feedthrough.

    Raises:
        MethodError: a shape does not fit, or a number is not finite.
    """
    a, b, c = (np.atleast_2d(np.asarray(m, dtype=np.float64)) for m in (A, B, C))
    d = np.zeros((len(c), b.shape[1])) if D is None else np.atleast_2d(np.asarray(D, np.float64))
    n, m, p = len(a), b.shape[1], len(c)
    fits = {"A": (a, (n, n)), "B": (b, (n, m)), "C": (c, (p, n)), "D": (d, (p, m))}
    for name, (matrix, shape) in fits.items():
        if matrix.shape != shape:
            raise MethodError("shape does not fit", where=name, value=matrix.shape,
                              allowed=str(shape))  # fmt: skip
        if not np.isfinite(matrix).all():
            raise MethodError("a number is not finite", where=name)
    return System(a, b, c, d)


def observability(A: Array, C: Array, L: int) -> Array:
    """Return ``O^L = (C; C A; ...; C A^L)``, ((L + 1) p, n)."""
    blocks = [C]
    for _ in range(L):
        blocks.append(blocks[-1] @ A)
    return np.vstack(blocks)


def invertibility(A: Array, B: Array, C: Array, D: Array, L: int) -> Array:
    """Return the block Toeplitz ``H^L`` of the Markov parameters, ((L + 1) p, (L + 1) m).

    ``Y = O^L x(k-L) + H^L (u(k-L); ...; u(k))``: D on the diagonal, ``C A^(i-1) B`` i blocks
    below it.
    """
    p, m = D.shape
    markov = [D, *np.split(observability(A, C, L) @ B, L + 1)[:L]]
    H = np.zeros(((L + 1) * p, (L + 1) * m))
    for row in range(L + 1):
        for column in range(row + 1):
            H[row * p : (row + 1) * p, column * m : (column + 1) * m] = markov[row - column]
    return H


class Scaled(NamedTuple):
    """A system in units in which its matrices are of order one.

    Args:
        system: the system in those units.
        x, u, y: (n,), (m,), (p,) sizes of those units in the caller's: ``x = x_scaled * size``.
    """

    system: System
    x: Array
    u: Array
    y: Array


def scaled(given: System, noise: Array | None = None) -> Scaled:
    """Choose units: ranks and null spaces must not depend on those of the caller.

    An output's unit is the largest of its row of O^n, or its noise; a state's makes its column of
    O^n of unit norm; an input's does so with the first column of H^n.

    Args:
        given: a system.
        noise: (p,) standard deviations of the outputs, or None.
    """
    n, m, p = given.sizes
    seen = observability(given.A, given.C, n)
    H = invertibility(*given, n)[:, :m]
    rows = np.hstack([seen, H]).reshape(n + 1, p, n + m)
    y = np.abs(rows).max(axis=(0, 2)) if noise is None else np.asarray(noise, np.float64)
    y = np.where(y > 0.0, y, 1.0)
    per = np.tile(1.0 / y, n + 1)[:, None]
    x, u = (_inverse(np.linalg.norm(per * matrix, axis=0)) for matrix in (seen, H))
    A, B, C, D = given
    return Scaled(
        System(A * x / x[:, None], B * u / x[:, None], C * x / y[:, None], D * u / y[:, None]),
        x,
        u,
        y,
    )


def rank(matrix: Array) -> int:
    """Rank of a matrix that is of order one; 0 if it is all zeros or empty."""
    if matrix.size == 0:
        return 0
    return int(np.linalg.matrix_rank(matrix, tol=_tolerance(matrix)))


def null(matrix: Array) -> Array:
    """Orthonormal basis, as columns, of what the matrix takes to zero."""
    if matrix.size == 0:
        return np.eye(matrix.shape[1])
    _, _, V = np.linalg.svd(matrix)
    return np.asarray(V[rank(matrix) :].T)


def _tolerance(matrix: Array) -> float:
    return RANK * max(1.0, float(np.abs(matrix).max(initial=0.0)))


def _inverse(size: Array) -> Array:
    return np.asarray(1.0 / np.where(size > 0.0, size, 1.0))
