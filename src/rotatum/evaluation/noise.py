"""How noisy the positions of a log are, from the log itself."""

from __future__ import annotations

from collections.abc import Mapping
from math import comb

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.measured import ACCELERATION, JERK, VELOCITY, Measured
from rotatum.estimators.operators import CENTRED, EXPONENTIAL, Operator
from rotatum.estimators.shapes import ends_of
from rotatum.estimators.widths import LINK_POLES
from rotatum.models import Device, Joint

Array = NDArray[np.float64]

ORDER = 6
"""Of the difference that leaves noise and takes motion away: a sine of w shrinks to (w T)^6."""

_GAIN = comb(2 * ORDER, ORDER)  # sum of the squared binomial coefficients
ENOUGH = 200  # samples below which nothing is measured
LONGEST = 100_000  # samples that are looked at
SMALL = 0.05  # noise over signal: attenuates a coefficient by a quarter of a per cent
JERK_POLES = 4  # one more than derivatives: else the noise has no end
SMALLER = 0.01  # of the link's acceleration, which on its side is all of the torque
HIGHEST, LOWEST = 300.0, 10.0  # rad/s
LARGEST = 5.0  # medians; of normal noise one in 1300 is larger


def position_noise(position: Array) -> float:
    """Return the standard deviation of white noise on a position, rad; 0: too short to say.

    Sixth differences of the samples, over the square root of 924. The mean of their sizes, each at
    most five times the median, is what noise spread over all samples gives, so that jumps, gaps and
    single bad samples do not count; where an encoder's steps are rare it is 0, and its resolution
    is what is known.

    Args:
        position: (N,) rad, evenly spaced.
    """
    bends = np.diff(position, ORDER)
    sizes = np.abs(bends[np.isfinite(bends)])
    if sizes.size < ENOUGH:
        return 0.0
    # Not the median itself: of an encoder's counts it is a whole number of them, up to half too
    # large. The mean of |x| of a normal distribution is 0.7979 standard deviations.
    limited = np.minimum(sizes, LARGEST * np.median(sizes))
    return float(limited.mean() / 0.7979 / np.sqrt(_GAIN))


def measured_noise(
    channels: Mapping[str, Mapping[str, Array]], device: Device
) -> dict[str, tuple[float, float]]:
    """Return each joint's noise of link and motor positions, rad, the larger of two motors'.

    Args:
        channels: device joint to role to samples.
        device: whose joints.
    """
    found = {}
    for joint in device.joints:
        logged = channels[joint.name]
        link, motor = (
            max((position_noise(logged[role]) for role in roles), default=0.0)
            for roles in _positions(joint, logged).values()
        )
        found[joint.name] = (link, motor)
    return found


def measure(
    channels: Mapping[str, Mapping[str, Array]], device: Device, period: float
) -> dict[str, Measured]:
    """Measure each joint's positions: their noise, and how wide an operator may be for it.

    Args:
        channels: device joint to role to samples.
        device: whose joints.
        period: s.
    """
    noise = measured_noise(channels, device)
    found = {}
    for joint in device.joints:
        logged = channels[joint.name]
        cutoffs: dict[tuple[str, str], float] = {}
        for (side, roles), std in zip(
            _positions(joint, logged).items(), noise[joint.name], strict=True
        ):
            counts = joint.encoders.resolution("link" if side == "link" else "motor") or 0.0
            least = max(std, counts / 12**0.5)
            kinds = [(VELOCITY, 1), (ACCELERATION, 2), *([(JERK, 3)] if side == "link" else [])]
            for kind, order in kinds:
                poles, small = 2, SMALL
                if side == "link":
                    poles = JERK_POLES if kind == JERK else LINK_POLES
                if (side, kind) == ("link", ACCELERATION):
                    small = SMALLER
                each = [
                    highest_cutoff(logged[role], least, order, period, poles=poles, small=small)
                    for role in roles
                ]
                cutoffs[side, kind] = min(each, default=HIGHEST)
        found[joint.name] = Measured(*noise[joint.name], cutoffs)
    return found


def _positions(joint: Joint, logged: Mapping[str, Array]) -> dict[str, list[str]]:
    """Side to the roles of its positions that there are."""
    motors = [f"theta{end}" for end in ends_of(joint.actuation)]
    sides = {"link": ["q"], "motor": motors}
    return {side: [role for role in roles if role in logged] for side, roles in sides.items()}


def highest_cutoff(
    position: Array,
    std: float,
    order: int,
    period: float,
    *,
    poles: int = 2,
    small: float = SMALL,
) -> float:
    """Return the highest cutoff, rad/s, at which noise is that small beside a derivative's rms.

    Both go through the poles; at the lowest cutoff tried, ``LOWEST``, it is what it is.

    Args:
        position: (N,) rad, evenly spaced.
        std: of its noise, rad.
        order: of the derivative, 1 to 3.
        period: s.
        poles: of the low-pass.
        small: noise over signal.
    """
    from scipy.signal import lfilter

    cutoff = min(HIGHEST, 0.5 / period)
    x = position[np.isfinite(position)][:LONGEST]
    if std == 0.0 or x.size < ENOUGH:
        return cutoff
    taps = np.array(CENTRED[order]) / period**order
    raw = np.convolve(x, taps, "valid")
    while cutoff > LOWEST:
        operator = Operator(EXPONENTIAL, poles, cutoff, period)
        through = raw
        for _ in range(poles):
            through = lfilter([1.0 - operator.pole], [1.0, -operator.pole], through)
        settled = through[min(raw.size // 2, round(12.0 / cutoff / period)) :]
        if std**2 * operator.noise_gain(order) <= (small * float(np.std(settled))) ** 2:
            break
        cutoff = max(LOWEST, 0.8 * cutoff)
    return cutoff
