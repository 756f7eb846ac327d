"""Textbook systems with unknown inputs, and their simulation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.observers.system import System, system

Array = NDArray[np.float64]


def simulate(given: System, u: Array, x0: Array | float = 0.0) -> tuple[Array, Array]:
    """States (N, n) and outputs (N, p) under inputs (N, m)."""
    n, _, p = given.sizes
    A, B, C, D = given
    x, y = np.zeros((len(u) + 1, n)), np.zeros((len(u), p))
    x[0] = x0
    for k, now in enumerate(u):
        y[k] = C @ x[k] + D @ now
        x[k + 1] = A @ x[k] + B @ now
    return x[:-1], y


def siso(zero: float) -> System:
    """``(z - zero) / ((z - 0.5) (z - 0.3))`` in controllable form: p = m = 1."""
    return system([[0.0, 1.0], [-0.15, 0.8]], [[0.0], [1.0]], [[-zero, 1.0]])


def redundant(seed: int = 5, states: int = 4, feedthrough: bool = False) -> System:
    """Two inputs, three outputs: no invariant zeros but by accident; delay 1, or 0."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((states, states))
    A *= 0.9 / np.abs(np.linalg.eigvals(A)).max()
    B, C = rng.standard_normal((states, 2)), rng.standard_normal((3, states))
    return system(A, B, C, rng.standard_normal((3, 2)) if feedthrough else None)


def mixed() -> System:
    """An input seen at once through D, one two integrations away: delay 2, a zero at 0.2."""
    A = [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.7]]
    B = [[0.0, 0.0], [0.1, 0.0], [0.0, 1.0]]
    return system(A, B, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [[0.0, 0.0], [0.0, 2.0]])
