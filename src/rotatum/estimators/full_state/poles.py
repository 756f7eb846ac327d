"""Poles of the observer of deluca2007, its gains in closed form, and its exact discretisation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.full_state.drivetrain import Drivetrain

Array = NDArray[np.float64]

FREQUENCY, DAMPING = 250.0, 0.8  # rad/s: deluca2007 section V-A, "well damped"


class Pair(NamedTuple):
    """Two poles of the estimation error, roots of ``s^2 + 2 damping frequency s + frequency^2``.

    Args:
        frequency: [rad/s].
        damping: below 1 the poles are complex, from 1 on real.
    """

    frequency: float = FREQUENCY
    damping: float = DAMPING

    @property
    def roots(self) -> tuple[complex, complex]:
        """The two poles [1/s]."""
        real = -self.damping * self.frequency
        apart = self.frequency * complex(self.damping**2 - 1.0, 0.0) ** 0.5
        return real + apart, real - apart


Pairs = tuple[Pair, Pair]
DEFAULT: Pairs = (Pair(), Pair())


def check_poles(pairs: Sequence[Pair], period: float) -> None:
    """Refuse poles that are not two stable pairs, or too fast for the period.

    Args:
        pairs: of one joint.
        period: T [s]; no pole may be faster than pi / T, the Nyquist frequency.

    Raises:
        MethodError: naming the pair, the value and what is allowed.
    """
    if not (math.isfinite(period) and period > 0.0):
        raise MethodError("the period must be positive", where="period", value=period)
    if len(pairs) != 2:
        raise MethodError("an observer has two pairs of poles", where="poles", value=len(pairs))
    for which, pair in zip(("first", "second"), pairs, strict=True):
        where = f"{which} pair of poles"
        if not (math.isfinite(pair.frequency) and pair.frequency > 0.0):
            raise MethodError("the frequency must be positive", where=where, value=pair.frequency)
        if not (math.isfinite(pair.damping) and pair.damping > 0.0):
            raise MethodError("the poles are not stable", where=where, value=pair.damping,
                              allowed="a damping above 0; 0.7 to 1 is well damped")  # fmt: skip
        fastest = max(abs(root) for root in pair.roots)
        if fastest >= math.pi / period:
            raise MethodError(
                f"the poles are too fast for samples of {period:.6g} s", where=where,
                value=fastest, allowed=f"below pi / T = {math.pi / period:.6g} rad/s",
                hint="Lower the frequency or, above 1, the damping.",
            )  # fmt: skip


def coefficients(pairs: Sequence[Pair]) -> Array:
    """(4,) a3, a2, a1, a0 of the characteristic polynomial ``s^4 + a3 s^3 + .. + a0``."""
    (w, z), (v, y) = pairs
    b, c, e, f = 2.0 * z * w, w * w, 2.0 * y * v, v * v
    return np.array([b + e, c + f + b * e, b * f + e * c, c * f])


def injection(pairs: Sequence[Pair], gyro: float = 0.0) -> Array:
    """(4,) a3, a2, a1, a0 of the kernel: with a gyroscope its gain is part of the polynomial.

    ``(s + gyro) (s^3 + a3 s^2 + a2 s + a1) + a0`` is then the polynomial of the poles.

    Args:
        pairs: of one joint.
        gyro: gain of the gyroscope [1/s], 0: none.
    """
    p = coefficients(pairs)
    a3 = p[0] - gyro
    a2 = p[1] - gyro * a3
    a1 = p[2] - gyro * a2
    return np.array([a3, a2, a1, p[3] - gyro * a1])


def gains(pairs: Sequence[Pair], drivetrain: Drivetrain) -> Array:
    """(4,) L1 [1/s], L2 [1/s], L3 [1/s^2], L4 [1/s^2] of eq. 6, for (theta, q, theta', q').

    Remark 3 of deluca2007, ``L1 = a3 - D/B``, ``L2 = (B/K) a1 - (B D/K^2) a0``,
    ``L3 = a2 - (D/B) a3 + (D^2 - K B)/B^2``, ``L4 = (B/K) a0``; beyond it, viscous friction D_m of
    the motor, part of the model here and not compensated by the observed velocity:
    ``L1 = a3 - c``, ``L3 = a2 - K/B - c L1`` with ``c = (D + D_m)/B``. Without gyroscope.

    Args:
        pairs: of one joint.
        drivetrain: of the joint.
    """
    a3, a2, a1, a0 = coefficients(pairs)
    k, d = drivetrain.stiffness / drivetrain.inertia, drivetrain.damping / drivetrain.inertia
    c = d + drivetrain.motor_damping / drivetrain.inertia
    return np.array([a3 - c, a1 / k - a0 * d / k**2, a2 - k - c * (a3 - c), a0 / k])


def error_matrix(pairs: Sequence[Pair], gyro: float = 0.0) -> Array:
    """(4, 4) A of ``w' = A w + b``, and of its error: nothing but the poles is in it."""
    A = np.diag([1.0, 1.0, 1.0], 1)
    A[:, 0] = -injection(pairs, gyro)
    A[3, 3] = -gyro
    return A


class Discrete(NamedTuple):
    """``w(t + T) = transition w(t) + before b(t) + after b(t + T)``, b a straight line between.

    Args:
        transition: (4, 4) exp(A T).
        before, after: (4, 4) [s].
    """

    transition: Array
    before: Array
    after: Array


def discretise(pairs: Sequence[Pair], period: float, gyro: float = 0.0) -> Discrete:
    """Return the exact discretisation under first-order hold.

    ``before + after`` is that under zero-order hold. By one exponential of a block matrix, in
    coordinates where all entries are of one size: those of w are nine orders of magnitude apart.

    Args:
        pairs: of one joint.
        period: T [s].
        gyro: gain of the gyroscope [1/s], 0: none.

    Raises:
        MethodError: poles that are not stable or too fast.
    """
    from scipy.linalg import expm

    check_poles(pairs, period)
    if not (math.isfinite(gyro) and 0.0 <= gyro < math.pi / period):
        raise MethodError("the gain of the gyroscope does not fit the period", where="gyro",
                          value=gyro, allowed=f"0 to {math.pi / period:.6g} 1/s")  # fmt: skip
    # A power of two: scaling by it rounds nothing.
    unit = 2.0 ** round(math.log2(math.sqrt(pairs[0].frequency * pairs[1].frequency)))
    scale = unit ** np.arange(4)
    A = error_matrix(pairs, gyro) * scale / scale[:, None]
    block = np.zeros((12, 12))
    block[:4, :4] = A * period
    block[:4, 4:8] = block[4:8, 8:] = np.eye(4)
    whole = expm(block) * (np.tile(scale, 3)[:, None] / np.tile(scale, 3))
    transition, first, second = (whole[:4, 4 * i : 4 * i + 4] for i in range(3))
    # int exp(A (T - t)) (1 - t/T) dt and int exp(A (T - t)) t/T dt over the period.
    return Discrete(transition, period * (first - second), period * second)
