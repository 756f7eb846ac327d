"""The exact design with the least noise: best linear unbiased estimates over a finite memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.existence import decouple, require
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.system import (
    System,
    invertibility,
    observability,
    scaled,
)

Array = NDArray[np.float64]
_GAIN = 0.01  # memory grows until half as much again lowers no input's variance by more
_LONGEST = 300  # samples of memory; a pseudo-inverse of that size is still quick
_UNBIASED = 1e-7  # error of a unit input or state that rounding may leave


def least_noise_observer(
    given: System, delay: int, noise: Array | float = 1.0, memory: int | None = None
) -> Recursion:
    """Design the unbiased observer of least variance with a memory of ``memory`` samples.

    Over the window ``Y = O x(k-W) + H u + v``, W = memory - 1, first state and all inputs are
    unknown constants: x(k-L) and u(k-L) are linear in them, and generalised least squares gives
    their unbiased estimates of least variance (Gauss and Markov). Inputs of any size are
    decoupled, as in trumic2022 A1; the error is forgotten in finite time; and as the memory grows
    the variance falls to that of the best unbiased observer with delay L there is.

    A Kalman formula for F1 in ``E = Abar - F1 S1`` would not be that: the noise of ``N Y(k)``
    is coloured, since a sample stays in L + 1 windows that follow each other, and the best
    observer then needs more memory than the n states of eq. 6.

    With p > m there are more outputs than needed, and the variance is below that of placed poles.
    With p = m estimates are unique and so is their variance (see `exact_observer`).

    A recursion of n + m states that comes as close as one likes, and does not mind zeros, is
    `finite_observer` with an intensity far above the noise.

    Args:
        given: the system.
        delay: L.
        noise: (p, p) covariance of the outputs' white noise, or one variance for all.
        memory: samples in the window; None: as many as it takes until half as many more would
            lower no variance of an input by more than 1 %, 300 at most.

    Returns:
        A recursion without state, ``out = (x, u)`` of the instant k - L.

    Raises:
        MethodError: no observer exists (see `require`), a zero outside z = 0 (then no finite
            memory tells the state: place poles, or give the input an intensity), or a memory that
            is too short.
    """
    require(given, delay)
    zeros = decouple(scaled(given), delay).zeros()
    if (np.abs(zeros) > _UNBIASED**0.5).any():
        raise MethodError(
            "least noise needs a system without invariant zeros",
            where="system",
            value=zeros.tolist(),
            hint="Place the poles of the other modes, or give the input an intensity.",
        )
    n, _, p = given.sizes
    R = np.asarray(noise, dtype=np.float64)
    R = R * np.eye(p) if R.ndim == 0 else R
    root = np.asarray(np.linalg.cholesky(R), dtype=np.float64)
    if memory is not None:
        return _best(given, delay, root, memory)
    length = delay + 1 + n
    while True:
        found = _best(given, delay, root, length)
        longer = _best(given, delay, root, min(length + (length + 1) // 2, _LONGEST))
        before, after = (np.diag(r.noise(root @ root.T))[n:] for r in (found, longer))
        if (after >= (1.0 - _GAIN) * before).all() or longer.window >= _LONGEST:
            return found if (after >= (1.0 - _GAIN) * before).all() else longer
        length = longer.window


def _best(given: System, L: int, root: Array, memory: int) -> Recursion:
    n, m, p = given.sizes
    W = memory - 1
    if W < L:
        raise MethodError("memory shorter than the delay", where="memory", value=memory,
                          allowed=f"{L + 1} or more")  # fmt: skip
    white = np.linalg.inv(root)
    s = scaled(given._replace(C=white @ given.C, D=white @ given.D), np.ones(p))
    A, B, C, D = s.system
    M = np.hstack([observability(A, C, W), invertibility(A, B, C, D, W)])
    wanted = np.zeros((n + m, M.shape[1]))
    since = W - L  # x(k-L) = A^since x(k-W) + sum A^(since-1-i) B u(k-W+i)
    wanted[:n, :n] = np.linalg.matrix_power(A, since)
    for i in range(since):
        columns = slice(n + i * m, n + (i + 1) * m)
        wanted[:n, columns] = np.linalg.matrix_power(A, since - 1 - i) @ B
    wanted[n:, n + since * m : n + (since + 1) * m] = np.eye(m)
    size = np.linalg.norm(M, axis=0)
    size[size == 0.0] = 1.0
    K = (wanted / size) @ np.linalg.pinv(M / size, rcond=1e-11)
    if np.abs(K @ M - wanted).max() > _UNBIASED * np.abs(wanted).max():
        raise MethodError(
            "memory too short to tell state and input, or too long for this system's numbers",
            where="memory",
            value=memory,
        )
    K = K * np.concatenate([s.x, s.u])[:, None] @ np.kron(np.eye(memory), white)
    nothing = np.zeros((1, 1))
    return Recursion(nothing, np.zeros((1, memory * p)), np.zeros((n + m, 1)), K, p, L)
