"""A pseudo-random binary sequence: two values that change by the beat, with a flat spectrum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.fields import refuse_infinite, refuse_not_positive

__all__ = ["Prbs"]

Array = NDArray[np.float64]
# Bits of the shift register: shorter hardly changes, longer takes a megabyte of sequence.
FEWEST, MOST = 2, 20
# Of a bit: 0.3 s / 0.1 s is 2.9999999999999996, and must count as the third beat.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Prbs:
    """A maximum-length sequence (PRBS) of `amplitude` and its negative, about `offset`.

    The bits of a shift register of `order` bits, one each `bit` seconds; it starts over after
    ``L = 2^order - 1`` bits. Its circular autocorrelation is A^2 at no lag and -A^2 / L at every
    other whole number of bits, so that its power is spread evenly up to about 0.4 / `bit` Hz.
    The sequence is that of `scipy.signal.max_len_seq`.

    Parameters
    ----------
    amplitude
        A [N m].
    bit
        Duration of a bit [s].
    seed
        Chooses where in the sequence it starts.
    order
        2 to 20.
    offset
        Mean of the two values [N m].
    """

    amplitude: float
    bit: float
    seed: int = 0
    order: int = 10
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Raise `RotatumError` for a bit without duration and an order out of range."""
        refuse_not_positive("prbs", bit=self.bit)
        refuse_infinite("prbs", amplitude=self.amplitude, offset=self.offset)
        if not FEWEST <= self.order <= MOST:
            allowed = f"{FEWEST} to {MOST}"
            raise RotatumError(
                "no such register", where="prbs.order", value=self.order, allowed=allowed
            )

    @property
    def bits(self) -> Array:
        """One period (2^order - 1,) of the sequence, each 1 or -1."""
        from scipy.signal import max_len_seq

        # any state but all zeros, from which the register never moves
        word = int(np.random.default_rng(self.seed).integers(1, 2**self.order))
        state = [word >> place & 1 for place in range(self.order)]
        ones: Array = max_len_seq(self.order, state=state)[0].astype(np.float64)
        return 2.0 * ones - 1.0

    def __call__(self, time: ArrayLike) -> Array:
        """Return the torque (N,) [N m] at times (N,) [s]."""
        bits = self.bits
        beat = np.floor(np.asarray(time, dtype=np.float64) / self.bit + ROUNDING)
        wave: Array = self.amplitude * bits[beat.astype(np.int64) % bits.size]
        return wave + self.offset
