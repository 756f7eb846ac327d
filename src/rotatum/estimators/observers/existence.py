"""Whether an unknown-input observer exists, with which delay, and what stands in the way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.observers.system import (
    Scaled,
    System,
    invertibility,
    null,
    observability,
    rank,
    scaled,
)

Array = NDArray[np.float64]
MARGIN = 1e-7  # a zero this close to the unit circle, or outside, does not decay


class Existence(NamedTuple):
    """What an observer of a system can do.

    Args:
        inputs_independent: (B; D) has full column rank.
        delay: smallest L with rank H^L - rank H^(L-1) = m; None: no delay makes the inputs
            recoverable.
        zeros: invariant zeros [per sample]: modes of the observer that no design moves.
        unstable: those of them that do not decay.
    """

    inputs_independent: bool
    delay: int | None
    zeros: NDArray[np.complex128]
    unstable: NDArray[np.complex128]

    @property
    def ok(self) -> bool:
        """Whether an observer exists that converges, with some delay."""
        return self.inputs_independent and self.delay is not None and len(self.unstable) == 0


class Decoupling(NamedTuple):
    """What is left to choose once the inputs are decoupled, in scaled units.

    ``N Y(k) = (S1; S2) x(k-L) + (0; u(k-L))``; then ``F = (F1, B) N``, ``E = Abar - F1 S1`` with
    ``Abar = A - B S2``. Rows of N1 and S1 are orthonormal combinations: S1 has full row rank.

    Args:
        N1: (r, (L + 1) p).
        N2: (m, (L + 1) p).
        S1: (r, n).
        Abar: (n, n).
        unseen: (n, z) orthonormal basis of the unobservable subspace of (S1, Abar).
    """

    N1: Array
    N2: Array
    S1: Array
    Abar: Array
    unseen: Array

    def zeros(self) -> NDArray[np.complex128]:
        """Invariant zeros of the system: the modes of Abar that S1 does not see."""
        V = self.unseen
        return np.asarray(np.linalg.eigvals(V.T @ self.Abar @ V), dtype=np.complex128)


def exists(given: System) -> Existence:
    """Tell whether an observer exists.

    The inputs are recoverable with delay L where ``rank H^L - rank H^(L-1) = m``; if no L up to n
    does it, none does (Sundaram and Hadjicostis 2008; Sain and Massey 1969). The states are where
    besides all invariant zeros lie within the unit circle (strong detectability).

    Args:
        given: the system.

    Returns:
        Every condition; no exception where one fails.
    """
    s = scaled(given)
    delay = smallest_delay(s)
    independent = rank(np.vstack([s.system.B, s.system.D])) == given.sizes[1]
    if delay is None:
        nothing = np.zeros(0, dtype=np.complex128)
        return Existence(independent, None, nothing, nothing)
    zeros = decouple(s, delay).zeros()
    return Existence(independent, delay, zeros, zeros[np.abs(zeros) > 1.0 - MARGIN])


def require(given: System, delay: int, *, stable: bool = True) -> None:
    """Refuse a system or a delay for which there is no observer.

    Args:
        given: the system.
        delay: L.
        stable: also refuse zeros that do not decay.

    Raises:
        MethodError: names the condition, the smallest delay that works, or the zeros.
    """
    found = exists(given)
    if not found.inputs_independent:
        raise MethodError("inputs act alike: (B; D) lacks full column rank", where="system")
    if found.delay is None:
        raise MethodError(
            "no delay makes the inputs recoverable: rank H^L - rank H^(L-1) stays below the "
            "number of inputs",
            where="system",
            hint="Measure more outputs, or model fewer inputs.",
        )
    if delay < found.delay:
        raise MethodError(
            "delay too short: rank H^L - rank H^(L-1) is below the number of inputs",
            where="delay",
            value=delay,
            allowed=f"{found.delay} or more",
        )
    if stable and len(found.unstable):
        listed = ", ".join(f"{z:.6g}" if z.imag else f"{z.real:.6g}" for z in found.unstable)
        raise MethodError(
            f"not strongly detectable: invariant zeros that do not decay ({listed})",
            where="system",
            hint="The outputs stay zero while such a mode grows: measure something else.",
        )


def smallest_delay(s: Scaled) -> int | None:
    """Smallest L for which the inputs are recoverable, up to n; None if there is none."""
    n, m, _ = s.system.sizes
    before = 0
    for L in range(n + 1):
        now = rank(invertibility(*s.system, L))
        if now - before == m:
            return L
        before = now
    return None


def decouple(s: Scaled, L: int) -> Decoupling:
    """Decouple the inputs: N with ``N H^L = (0, 0; I, 0)``, after Sundaram and Hadjicostis 2008.

    The rows of the left null space of H^(L-1) take all later inputs out of a window; of what is
    left, a combination isolates u(k-L) and the others do not see it.

    Args:
        s: a scaled system for which L is long enough.
        L: delay.
    """
    A, B, C, _ = s.system
    n, m, p = s.system.sizes
    blind = null(invertibility(*s.system, L - 1).T).T if L > 0 else np.zeros((0, 0))
    Nbar = np.zeros((p + len(blind), (L + 1) * p))
    Nbar[:p, :p] = np.eye(p)
    Nbar[p:, p:] = blind
    first = Nbar @ invertibility(*s.system, L)[:, :m]  # full column rank: L is long enough
    N2 = np.linalg.pinv(first) @ Nbar
    N1 = null(first.T).T @ Nbar
    seen = observability(A, C, L)
    U, sizes, V = np.linalg.svd(N1 @ seen)
    r = rank(N1 @ seen)
    S1 = V[:r]
    N1 = U[:, :r].T @ N1 / sizes[:r, None]
    Abar = A - B @ (N2 @ seen)
    return Decoupling(N1, N2, S1, Abar, _unseen(Abar, S1, n))


def _unseen(A: Array, S: Array, n: int) -> Array:
    """Largest subspace of the kernel of S that A maps into itself."""
    V = null(S) if len(S) else np.eye(n)
    while V.shape[1]:
        image = A @ V
        outside = image - V @ (V.T @ image)
        kept = null(outside)
        if kept.shape[1] == V.shape[1]:
            break
        V = V @ kept
    return V
