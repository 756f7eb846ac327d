"""What a log's motion can tell of a joint: how far, how fast, how loud beside the noise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.measured import ACCELERATION
from rotatum.estimators.operators import CENTRED, WINDOW, Operator
from rotatum.estimators.shapes import ends_of
from rotatum.estimators.widths import choose_operator
from rotatum.evaluation.noise import measure
from rotatum.models import Device, Joint

__all__ = ["LONG", "Balance", "Motion", "motion_of"]

Array = NDArray[np.float64]
LONG = 0.2
"""Seconds of a window where the motion is slow: some ten times what the default low-pass looks
back."""
_POWER = 3  # of the windows
_FEWEST = 20  # samples under one
_PASSES = 0.5  # of the deflection's rms: of faster motion a window would see next to nothing
_BINS = 2  # to either side of a line: where a Hann window spreads it
_REST = 0.05  # s at the start that the deflection's zero is read from, as estimators do


@dataclass(frozen=True)
class Balance:
    """One side's torque balance as rows see it, without what fitting would correct.

    Args:
        load: rms of the elastic torque that the balance gives, N m.
        noise: rms of what the noise of the position that is differentiated twice puts there, N m.
        inertial: rms of the part that is inertia times acceleration, N m.
    """

    load: float
    noise: float
    inertial: float

    @property
    def ratio(self) -> float:
        """Load without its noise over the noise; infinite without noise."""
        signal = math.sqrt(max(0.0, self.load**2 - self.noise**2))
        return signal / self.noise if self.noise > 0.0 else math.inf

    @property
    def share(self) -> float:
        """Share of the load that hangs on the inertia, at most 1."""
        return min(1.0, self.inertial / self.load) if self.load > 0.0 else 0.0


@dataclass(frozen=True)
class Motion:
    """Facts about one joint, from the first piece of a log.

    Args:
        reach: largest deflection of its transmissions from their zeros but for one sample in a
            thousand, rad.
        deflection: rms about its mean, rad, the smallest of the transmissions'.
        noise: of link and motor positions, rad.
        line: share of its power that the strongest line has, of deflection or motor speed where it
            is smaller: near 1 all of it is one sine, whose stiffness, inertia and damping are one.
        window: s, of a window that suits the motion: 0.2 s, halved until half of the rms of every
            deflection passes, but no shorter than 20 samples.
        motor, link: balances; None where channels or constants for it are missing.
    """

    reach: float
    deflection: float
    noise: tuple[float, float]
    line: float
    window: float
    motor: Balance | None
    link: Balance | None


def motion_of(
    logged: Mapping[str, Array], joint: Joint, device: Device, period: float
) -> Motion | None:
    """Measure a joint's motion; None where the log lacks its positions.

    Args:
        logged: role to (N,) samples, a piece of the log.
        joint: constants, encoders.
        device: of the joint.
        period: s.
    """
    ends = ends_of(joint.actuation)
    if any(role not in logged for role in ("q", *(f"theta{end}" for end in ends))):
        return None
    only = device.only([joint.name])
    measured = measure({joint.name: logged}, only, period)[joint.name]
    counts = [joint.encoders.resolution(end) or 0.0 for end in ("link", "motor")]
    link, motor = (max(a, b / math.sqrt(12.0)) for a, b in zip(measured[:2], counts, strict=True))
    bends = (("acceleration", measured.cutoffs["link", ACCELERATION]),)
    of_motor = _operator(joint, device, period, (link, motor), "motor", ())
    of_link = _operator(joint, device, period, (link, motor), "link", bends)
    q = _whole(logged["q"], joint.encoders.wrap_link)
    parts = [_whole(logged[f"theta{end}"], joint.encoders.wrap_motor) for end in ends]
    deflections = [_zeroed(q - theta, joint, i, period) for i, theta in enumerate(parts)]
    return Motion(
        reach=max(float(np.percentile(np.abs(phi), 99.9)) for phi in deflections),
        deflection=min(float(np.std(phi)) for phi in deflections),
        noise=(link, motor),
        line=min(
            min(_line(_through(phi, of_motor, 0)), _line(_through(theta, of_motor, 1)))
            for phi, theta in zip(deflections, parts, strict=True)
        ),
        window=min(_window(phi, period) for phi in deflections),
        motor=_motor(logged, joint, parts, of_motor, motor),
        link=_link(joint, q, of_link, link),
    )


def _operator(
    joint: Joint,
    device: Device,
    period: float,
    noise: tuple[float, float],
    side: str,
    highest: tuple[tuple[str, float], ...],
) -> Operator:
    """What rows of ``weak`` would go through."""
    return choose_operator(
        joint,
        "weak",
        period,
        device.source,
        {},
        cutoff=None,
        window=None,
        order=None,
        stride=None,
        noise=noise,
        cutoffs=highest,
        side=side,
    )


def _whole(angle: Array, wrap: float | None) -> Array:
    """Return an angle without gaps and turns."""
    known = np.isfinite(angle)
    if not known.any():
        return np.zeros_like(angle)
    at = np.arange(len(angle))
    filled = np.interp(at, at[known], angle[known])
    return filled if wrap is None else np.unwrap(filled, period=wrap)


def _zeroed(phi: Array, joint: Joint, which: int, period: float) -> Array:
    zero = joint.transmissions[which].zero
    if zero == "first":
        zero = float(np.mean(phi[: max(1, round(_REST / period))]))
    elif zero == "mean":
        zero = float(np.mean(phi))
    return np.asarray(phi - zero)


def _through(x: Array, operator: Operator, difference: int) -> Array:
    """A derivative of samples as rows see it, where the operator has settled."""
    taps = np.convolve(operator.response(), CENTRED[difference])
    if len(taps) > len(x):
        return np.zeros(1)
    return np.asarray(_convolved(x, taps) / operator.period**difference)


def _convolved(x: Array, taps: Array) -> Array:
    # scipy.signal takes longer to import than most estimates need to start.
    from scipy.signal import fftconvolve

    return np.asarray(fftconvolve(x, taps, mode="valid"))


def _window(phi: Array, period: float) -> float:
    seconds, shortest = LONG, _FEWEST * period
    whole = float(np.std(phi))
    while seconds > shortest:
        operator = Operator(WINDOW, _POWER, round(seconds / period) * period, period)
        if operator.length < len(phi):
            passed = _convolved(phi, operator.weights())
            if float(np.std(passed)) >= _PASSES * whole:
                return seconds
        seconds *= 0.5
    return shortest


def _line(x: Array) -> float:
    """Share of the power in the strongest line of a Hann-windowed spectrum, two bins each way."""
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(len(x)))) ** 2
    total = float(power.sum())
    at = int(np.argmax(power))
    return float(power[max(0, at - _BINS) : at + _BINS + 1].sum()) / total if total else 0.0


def _motor(
    logged: Mapping[str, Array], joint: Joint, parts: list[Array], operator: Operator, noise: float
) -> Balance | None:
    """The weaker of two motors' balances."""
    found: list[Balance] = []
    for motor, theta, end in zip(joint.motors, parts, ends_of(joint.actuation), strict=False):
        if f"tau{end}" not in logged:
            return None
        tau = _through(_whole(logged[f"tau{end}"], None), operator, 0)
        inertia = motor.reflected_inertia
        inertial = (inertia.value if inertia else 0.0) * _through(theta, operator, 2)
        speed = _through(theta, operator, 1)
        friction = motor.reflected_damping.value * speed
        friction = friction + motor.reflected_coulomb.value * np.sign(speed)
        size = inertia.value if inertia else 0.0
        found.append(_balance(inertial + friction - tau, inertial, size, operator, noise))
    return min(found, key=lambda balance: balance.ratio, default=None)


def _link(joint: Joint, q: Array, operator: Operator, noise: float) -> Balance | None:
    link = joint.link
    if link is None or link.inertia is None:
        return None
    speed = _through(q, operator, 1)
    inertial = link.inertia.value * _through(q, operator, 2)
    load = inertial + link.damping.value * speed + link.coulomb.value * np.sign(speed)
    load = load + link.gravity_torque * _through(np.sin(q), operator, 0)
    return _balance(load, inertial, link.inertia.value, operator, noise)


def _balance(
    load: Array, inertial: Array, inertia: float, operator: Operator, noise: float
) -> Balance:
    spread = inertia * noise * math.sqrt(operator.noise_gain(2))
    return Balance(float(np.std(load)), spread, float(np.std(inertial)))
