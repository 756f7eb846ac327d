"""A linear recursion over a window of outputs: the form every observer here is written in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError

Array = NDArray[np.float64]
_EPS = 2.0**-52


_DOUBLINGS = 60  # 2^60 samples: beyond, E is not stable to working precision


def stable_sum(E: Array, X: Array) -> Array:
    """Return ``sum_k E^k X (E^k)^T``, the solution of ``P = E P E^T + X``.

    By doubling, ``P <- P + E P E^T``, ``E <- E^2``: indifferent to the units of the states, which
    a linear solver is not (positions and jerks are 12 orders of magnitude apart).

    Raises:
        MethodError: E is not stable.
    """
    P, power = X.astype(np.float64), E.astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_DOUBLINGS):
            more = power @ P @ power.T
            P = P + more
            power = power @ power
            if np.all(np.abs(more) <= _EPS * np.abs(P)):
                return P
    raise MethodError(
        "the recursion does not forget its start",
        where="observer",
        value=float(np.abs(np.linalg.eigvals(E)).max()),
        allowed="eigenvalues within the unit circle",
    )


class Recursion(NamedTuple):
    """A recursion with n states over a window of w outputs of p channels each.

    ``Y(k) = (y(k-w+1), ..., y(k))``, oldest first, ``x(k+1) = E x(k) + F Y(k)``,
    ``out(k) = G x(k) + K Y(k)``; ``out(k)`` belongs to the instant ``k - lag``.

    Args:
        E: (n, n).
        F: (n, w p).
        G: (o, n).
        K: (o, w p).
        channels: p.
        lag: samples by which the instant of ``out`` lies before the newest output.
    """

    E: Array
    F: Array
    G: Array
    K: Array
    channels: int
    lag: int

    @property
    def window(self) -> int:
        """Outputs in the window, w."""
        return int(self.F.shape[1]) // self.channels

    def block(self, matrix: Array, age: int) -> Array:
        """Return the (., p) columns of F or K that multiply ``y(k - age)``."""
        first = (self.window - 1 - age) * self.channels
        return matrix[:, first : first + self.channels]

    def rest(self) -> Array:
        """(n, p): the state that outputs lead to which have stood still for ever, per output."""
        total = sum((self.block(self.F, a) for a in range(self.window)), np.zeros(1))
        return np.asarray(np.linalg.solve(np.eye(len(self.E)) - self.E, total))

    def run(self, y: Array) -> Array:
        """Run over all of ``y``, (N, p), from rest at its first sample; (N - w + 1, o).

        Row i is ``out(i + w - 1)``: the estimate of the instant ``i + w - 1 - lag``.
        """
        y = np.asarray(y, dtype=np.float64).reshape(len(y), self.channels)
        x = self.rest() @ y[0]
        found = np.empty((len(y) - self.window + 1, len(self.G)))
        for i in range(len(found)):
            Y = y[i : i + self.window].ravel()
            found[i] = self.G @ x + self.K @ Y
            x = self.E @ x + self.F @ Y
        return found

    def augmented(self) -> Recursion:
        """Return the same recursion with the window's older outputs as states: w = 1.

        ``s = (x, y(k-w+1), ..., y(k-1))``, ``s+ = E s + F y(k)``, ``out = G s + K y(k)``.
        """
        n, p, w = len(self.E), self.channels, self.window
        old = (w - 1) * p
        E = np.zeros((n + old, n + old))
        F = np.zeros((n + old, p))
        E[:n, :n], E[:n, n:] = self.E, self.F[:, :old]
        F[:n] = self.F[:, old:]
        if old:
            E[n : n + old - p, n + p :] = np.eye(old - p)
            F[n + old - p :] = np.eye(p)
        G = np.hstack([self.G, self.K[:, :old]])
        return Recursion(E, F, G, self.K[:, old:].copy(), p, self.lag)

    def impulse(self, samples: int) -> Array:
        """(samples, o, p): what an impulse on each output does to ``out``, from its instant on."""
        x = np.zeros((len(self.E), self.channels))
        found = np.zeros((samples, len(self.G), self.channels))
        for k in range(samples):
            found[k] = self.G @ x
            x = self.E @ x
            if k < self.window:
                found[k] += self.block(self.K, k)
                x = x + self.block(self.F, k)
        return found

    def noise(self, covariance: Array | float = 1.0) -> Array:
        """(o, o): covariance of ``out`` in the steady state, for white noise on the outputs.

        The sum of the squared impulse response, exactly: the first w samples one by one, the
        rest by a Lyapunov equation. Windows that overlap are thereby accounted for.

        Args:
            covariance: (p, p) of the noise, or one variance for all outputs.
        """
        R = np.asarray(covariance, dtype=np.float64)
        R = R * np.eye(self.channels) if R.ndim == 0 else R
        first = self.impulse(self.window)
        x = np.zeros((len(self.E), self.channels))
        for age in range(self.window):
            x = self.E @ x + self.block(self.F, age)
        P = stable_sum(self.E, x @ R @ x.T)
        return np.asarray(np.einsum("kop,pq,krq->or", first, R, first) + self.G @ P @ self.G.T)

    def response(self, angles: Array) -> NDArray[np.complex128]:
        """(m, o, p): transfer from the outputs to ``out``, its lag taken away.

        Args:
            angles: (m,) frequency times period [rad], 0 to pi.
        """
        z = np.exp(1j * angles)
        shifts = z[:, None] ** np.arange(1 - self.window, 1)
        F, K = (
            np.einsum("nwp,mw->mnp", M.reshape(len(M), self.window, self.channels), shifts)
            for M in (self.F, self.K)
        )
        x = np.linalg.solve(z[:, None, None] * np.eye(len(self.E)) - self.E, F)
        return np.asarray((self.G @ x + K) * z[:, None, None] ** self.lag)
