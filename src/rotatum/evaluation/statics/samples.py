"""Which samples of a log a static characterisation may use: finite, slow, and no dropouts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError
from rotatum.estimators.shapes import ends_of
from rotatum.evaluation.statics.model import Cells, Signal
from rotatum.models import Joint

__all__ = ["Samples", "cells_of", "samples_of"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_SMOOTH = 0.05  # s over which speeds are taken, and at least five samples
_QUICK = 4.0  # times the usual speed; a sine's highest is 1.41 times its median
_SPIKE, _BESIDE = 10.0, 11  # deviations from the median of so many samples
_FINE = 400  # cells over the range of a deflection: a law is a line inside one
_TURN = math.pi  # rad of deflection that no elastic joint has
_RESTS = 0.01  # of the steps: a motor that only goes from preset to preset shows no count
_FEWEST = 100


@dataclass(frozen=True)
class Samples:
    """The samples that are used, (N,) each.

    Parameters
    ----------
    phi : (parts, N) deflections with preload; less the zero where it is not fitted [rad].
    setpoint : of the law, 0 where there is none.
    torque : (signals, N) [N m].
    rate : (parts, N) speed of the deflections [rad/s].
    acceleration : (N,) of the link [rad/s^2].
    preset : set-point; half of the motors' distance of an antagonistic joint [rad]; else 0.
    limit : speed above which samples are left out [rad/s].
    left_out : why -> how many.
    noise : (signals,) standard deviation of the sensors' noise [N m].
    """

    phi: Array
    setpoint: Array
    torque: Array
    rate: Array
    acceleration: Array
    preset: Array
    limit: float
    left_out: Mapping[str, int]
    noise: tuple[float, ...]

    def whole(self) -> Cells:
        """Return every sample as a cell."""
        return Cells(self.phi, self.setpoint, self.torque, np.ones(self.phi.shape[1]))


def samples_of(
    logged: Mapping[str, Array],
    time: Array,
    joint: Joint,
    signals: Sequence[Signal],
    *,
    zeros: bool,
    max_speed: float | None,
    source: str,
) -> Samples:
    """Choose the samples of a joint.

    Parameters
    ----------
    logged : role -> (N,) of the joint.
    time : (N,) [s].
    joint : encoders, zeros, preloads, set-point.
    signals : torque channels.
    zeros : whether the zeros are fitted, so that the file's are not subtracted.
    max_speed : of link and motors [rad/s]; None: four times the median.
    source : of the log, for messages.

    Raises
    ------
    LogError for a log without enough samples, or with deflections that must be in degrees.
    """
    motors = [f"theta{end}" for end in ends_of(joint.actuation)]
    wraps = (joint.encoders.wrap_link, *[joint.encoders.wrap_motor] * len(motors))
    turned = [_whole(logged[r], w) for r, w in zip(("q", *motors), wraps, strict=True)]
    torque = np.array([logged[signal.role] for signal in signals])
    setpoint = _setpoint(logged, joint)
    finite = np.isfinite([logged["q"], *(logged[m] for m in motors), *torque, setpoint, time])
    good = np.asarray(finite.all(axis=0))
    jumps = np.any([_spikes(each) for each in (*turned, *torque)], axis=0) & good
    speeds = np.array([_speed(angle, time) for angle in turned])
    speed = np.abs(speeds).max(axis=0)
    limit = _limit(speed[good], turned, time) if max_speed is None else max_speed
    fast = (speed > limit) & good & ~jumps
    used = good & ~jumps & ~fast
    if np.count_nonzero(used) < _FEWEST:
        what = f"{np.count_nonzero(used)} samples of joint {joint.name} are finite and slow"
        raise LogError(what, where=source, allowed=f"{_FEWEST} or more", hint="See --max-speed.")
    phi = np.array([turned[0] - motor for motor in turned[1:]])
    _refuse_degrees(phi[:, used], joint, source)
    if not zeros:
        phi -= [[_zero(joint, part)] for part in range(len(phi))]
    phi += [[spring.preload] for spring in joint.transmissions]
    return Samples(
        phi=phi[:, used],
        setpoint=setpoint[used],
        torque=torque[:, used],
        rate=(speeds[0] - speeds[1:])[:, used],
        acceleration=_speed(speeds[0], time)[used],
        preset=_preset(turned[1:], setpoint)[used],
        limit=limit,
        left_out={
            "not finite": int(np.count_nonzero(~good)),
            "dropouts": int(np.count_nonzero(jumps)),
            "too fast": int(np.count_nonzero(fast)),
        },
        noise=tuple(_noise(each) for each in torque),
    )


def cells_of(samples: Samples) -> tuple[Cells, NDArray[np.int64]]:
    """Return means over runs of samples whose deflections stay together, and where each begins.

    A law is a line over 1/400 of the range, so that the mean of its torques is the torque at the
    mean deflection: to 1/38400 of it for a sinh with a phi of 5 at either end.

    Parameters
    ----------
    samples : in the order of time.
    """
    coordinates = [*samples.phi, samples.setpoint]
    places = np.array([np.floor(_FINE * _share(each)) for each in coordinates])
    starts = np.concatenate([[0], 1 + np.flatnonzero(np.any(np.diff(places), axis=0))])
    count = np.diff(np.append(starts, places.shape[1])).astype(np.float64)
    phi = np.add.reduceat(samples.phi, starts, axis=1) / count
    setpoint = np.add.reduceat(samples.setpoint, starts) / count
    torque = np.add.reduceat(samples.torque, starts, axis=1) / count
    return Cells(phi, setpoint, torque, count), starts.astype(np.int64)


def _share(values: Array) -> Array:
    span = float(np.ptp(values))
    shares: Array = (values - values.min()) / span if span > 0.0 else np.zeros_like(values)
    return shares


def _whole(angle: Array, wrap: float | None) -> Array:
    """Return an angle without gaps and turns."""
    known = np.isfinite(angle)
    if not known.any():
        return np.zeros_like(angle)
    at = np.arange(len(angle))
    filled = np.interp(at, at[known], angle[known])
    return filled if wrap is None else np.unwrap(filled, period=wrap)


def _setpoint(logged: Mapping[str, Array], joint: Joint) -> Array:
    if "setpoint" not in logged:
        return np.zeros_like(logged["q"])
    return (
        logged["setpoint"] if joint.setpoint is None else joint.setpoint.value(logged["setpoint"])
    )


def _preset(motors: Sequence[Array], setpoint: Array) -> Array:
    return setpoint if len(motors) == 1 else 0.5 * np.abs(motors[0] - motors[1])


def _spikes(values: Array) -> Mask:
    """Single samples, or up to five, that stand out from their neighbours."""
    from scipy.ndimage import median_filter

    off = np.abs(values - median_filter(_whole(values, None), _BESIDE, mode="nearest"))
    known = off[np.isfinite(off)]
    if not known.size:
        return np.zeros(values.shape, dtype=bool)
    low, high = np.nanpercentile(values, [0.5, 99.5])
    spread = 1.4826 * float(np.median(known))
    return np.asarray(off > max(_SPIKE * spread, 0.02 * float(high - low)))


def _speed(angle: Array, time: Array) -> Array:
    """Central difference over some 50 ms, (N,), so that counts of an encoder are no speed."""
    half = _half(time)
    at = np.arange(len(angle))
    low, high = np.maximum(at - half, 0), np.minimum(at + half, len(angle) - 1)
    clock = _whole(time, None)
    return np.asarray((angle[high] - angle[low]) / np.maximum(clock[high] - clock[low], 1e-9))


def _half(time: Array) -> int:
    period = float(np.nanmedian(np.diff(time)))
    return max(2, round(0.5 * _SMOOTH / period))


def _limit(speed: Array, angles: Sequence[Array], time: Array) -> float:
    """Four times the median speed, and above what counts and noise make of standing still."""
    noise = max(_noise(angle) + _count(angle) for angle in angles)
    floor = 6.0 * noise / (2.0 * _half(time) * float(np.nanmedian(np.diff(time))))
    return max(_QUICK * float(np.median(speed)), floor)


def _count(values: Array) -> float:
    """Smallest step between neighbours, of a coarse reading its count; 0 of one that rests."""
    steps = np.abs(np.diff(values[np.isfinite(values)]))
    moved = steps[steps > 0.0]
    return float(moved.min()) if moved.size > _RESTS * steps.size else 0.0


def _noise(values: Array) -> float:
    """Standard deviation of what neighbours do not share, from second differences."""
    bends = np.abs(np.diff(values[np.isfinite(values)], 2))
    if not bends.size:
        return 0.0
    return max(1.4826 * float(np.median(bends)) / math.sqrt(6.0), _count(values) / math.sqrt(12.0))


def _refuse_degrees(phi: Array, joint: Joint, source: str) -> None:
    reach = float(np.max(np.percentile(phi, 99.5, axis=1) - np.percentile(phi, 0.5, axis=1)))
    if reach > 2.0 * _TURN:
        raise LogError(
            f"the deflection of joint {joint.name} spans {reach:.3g} rad, which no elastic "
            "joint can",
            where=source,
            hint='If its angles are in degrees: q = { unit = "deg" } in the device\'s [channels], '
            "and so the motors'; if they are the motor's, side = \"motor\".",
        )


def _zero(joint: Joint, part: int) -> float:
    """The file's number; a word of it is about logs that begin at rest, which these seldom do."""
    zero = joint.transmissions[part].zero
    return 0.0 if isinstance(zero, str) else zero
