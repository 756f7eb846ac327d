"""Bias, misalignment and delay of an accelerometer from a motion whose link angles are known."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.full_state.calibration import Calibration, prior_of, whole_sensor
from rotatum.estimators.full_state.regression import PRIOR, TOLD, fit_readings, fitted_mask
from rotatum.models.inertial import Accelerometer
from rotatum.models.robot.accelerations import AccelerometerMap
from rotatum.models.robot.interface import Robot

__all__ = ["calibrate_motion", "delay_between"]

Array = NDArray[np.float64]
Force = Callable[[float], tuple[Array, Array]]

CUTOFF = 150.0
"""rad/s, of the low-pass on angles and readings alike: above the swinging of arms on their gears,
below where the second derivative of an encoder's steps is as large as an accelerometer's noise."""
_LONGEST = 0.05  # s, of a delay
_FORGOTTEN = 8.0  # over the cutoff, s: the low-pass' memory, e^-3 of it in either direction
_ORDER = 4
_FEWEST = 20  # rows
_LEAST = 1e-6  # m/s^2, of noise: no accelerometer is quieter, and simulated ones divide by it
_CORRELATED = 2.0 * math.pi  # over the cutoff, s: beyond it the low-pass' noise is unrelated
_DIFFERENCES = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0)  # central, of order six


def calibrate_motion(
    robot: Robot,
    sensor: Accelerometer,
    period: float,
    q: Array,
    readings: Array,
    *,
    fit: Sequence[str] = ("bias", "misalignment", "delay"),
    cutoff: float = CUTOFF,
    prior: Calibration | None = None,
) -> Calibration:
    """Fit readings along a motion to ``T(q) q'' + W(q, q')`` of the link angles.

    Angles and readings go through the same zero-phase low-pass (Butterworth, forwards and back),
    whose lag and loss thus cancel; the angles are then differentiated by central differences of
    order six. The delay starts at the peak of the cross-correlation and is fitted together with
    the rest, between samples, by maximum likelihood. Deviations are for noise of the
    low-pass' colour, or wider where what is left asks for it.

    The angles have to be the links', measured or observed. Those of motors, with the deflection at
    rest, do only where springs hardly move: a vibration that q lacks is left in the residual. It
    widens the deviations, but what of it looks like an error of the sensor is taken for one.

    Args:
        robot: the arm.
        sensor: as the device file has it.
        period: s; uniform.
        q: (N, n) rad, finite.
        readings: (N, A) m/s^2, of the sensor's axes; a NaN and its surroundings are left out.
        fit: some of "bias", "misalignment", "scale", "delay".
        cutoff: rad/s.
        prior: an earlier calibration of the same sensor, such as the static one; None: `PRIOR`.

    Raises:
        MethodError: arrays that do not belong together, a log too short for the low-pass, a cutoff
            above half the Nyquist frequency, or an unknown parameter.
    """
    fitted = fitted_mask(fit, ("bias", "misalignment", "scale", "delay"))
    edge = _check(sensor, period, q, readings, cutoff)
    axes = ["xyz".index(axis) for axis in sensor.axes]
    filled, known = _filled(readings, edge)
    smooth = _lowpass(np.column_stack([q, filled]), cutoff * period)
    n = q.shape[1]
    force = _force(robot, sensor, smooth[:, :n], period)
    shown, margin = smooth[3:-3, n:], edge + math.ceil(_LONGEST / period)
    kept = np.zeros(len(shown), dtype=np.bool_)
    kept[margin:-margin] = known[3:-3][margin:-margin]
    every = max(1, round(math.pi / cutoff / period / 4.0))  # a quarter of what Nyquist asks for
    rows = np.flatnonzero(kept)[::every]
    if len(rows) < _FEWEST:
        what = "too little of the log is left between its edges and missing readings"
        raise MethodError(what, where=sensor.name, value=len(rows), allowed=f"{_FEWEST} rows")
    mean, covariance = prior_of(prior)
    if fitted[9] and covariance[9, 9] > (TOLD * PRIOR[9]) ** 2:
        mean = mean.copy()
        # Only a start: a prior this wide does not hold it there.
        mean[9] = delay_between(force[:, axes], shown, period, _LONGEST)
    gain, colour = _colour(cutoff, period, every)
    found = fit_readings(
        _later(force, period, rows),
        shown[rows],
        np.ones((len(rows), len(axes))) * gain * _noise(filled),
        axes,
        fitted,
        mean,
        covariance,
        colour=colour,
    )
    return Calibration(sensor, found.values, found.covariance, found.residual, len(rows))


def delay_between(expected: Array, shown: Array, period: float, longest: float) -> float:
    """Return how late readings are, by the peak of their cross-correlation [s].

    Between samples by the parabola through the peak and its neighbours; of several axes the
    correlations are added, each over the same readings. 0 where nothing moves.

    Args:
        expected, shown: (N, A), in one unit, finite.
        period: s.
        longest: s, of a delay either way.
    """
    from scipy.signal import correlate

    most = max(1, min(round(longest / period), len(shown) // 4))
    # The same readings at every lag: a sum that loses its ends is pulled towards no delay.
    one, other = (
        expected - expected.mean(axis=0),
        shown[most:-most] - shown[most:-most].mean(axis=0),
    )
    pairs = zip(one.T, other.T, strict=True)
    whole = np.sum([correlate(a, b, mode="valid", method="fft") for a, b in pairs], axis=0)
    energy = correlate(np.sum(one**2, axis=1), np.ones(len(other)), mode="valid", method="direct")
    if not energy.min() > 0.0:
        return 0.0
    near = (whole / np.sqrt(energy))[::-1]
    peak = int(np.argmax(near))
    if not 0 < peak < 2 * most:
        return 0.0
    before, top, after = near[peak - 1 : peak + 2]
    bend = before - 2.0 * top + after
    part = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float((peak - most + part) * period)


def _force(robot: Robot, sensor: Accelerometer, q: Array, period: float) -> Array:
    """Return the specific force along (N, n) angles, (N - 6, 3), from the fourth row on."""
    at = AccelerometerMap(robot, [whole_sensor(sensor)])
    dq = _rate(q, period)
    ddq = _rate(dq, period)
    states = zip(q[6:-6], dq[3:-3], ddq, strict=True)
    inner = np.array([at.readings(*state) for state in states])
    # The second difference has lost three rows more at either end; they are never used.
    return np.pad(inner, ((3, 3), (0, 0)), mode="edge")


def _rate(x: Array, period: float) -> Array:
    """Return the first derivative of (N, n), (N - 6, n)."""
    middle = len(x) - 3
    terms = [
        weight * (x[3 + k : middle + k] - x[3 - k : middle - k])
        for k, weight in enumerate(_DIFFERENCES, start=1)
    ]
    rate: Array = np.sum(terms, axis=0) / period
    return rate


def _later(force: Array, period: float, rows: NDArray[np.intp]) -> Force:
    """Return the force and its rate at rows, of readings that are late, by a cubic spline."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(period * np.arange(len(force)), force, axis=0)
    rate, last = spline.derivative(), period * (len(force) - 1)

    def at(delay: float) -> tuple[Array, Array]:
        when = np.clip(period * rows - delay, 0.0, last)
        return spline(when), rate(when)

    return at


def _lowpass(x: Array, cutoff: float) -> Array:
    from scipy.signal import butter, sosfiltfilt

    smooth: Array = sosfiltfilt(butter(_ORDER, cutoff / math.pi, output="sos"), x, axis=0)
    return smooth


def _colour(cutoff: float, period: float, every: int) -> tuple[float, Array]:
    """Return the gain of white noise's deviation by the low-pass, and its autocorrelation then."""
    reach = math.ceil(_CORRELATED / cutoff / period / every) * every
    impulse = np.zeros(4 * reach + 1)
    impulse[2 * reach] = 1.0
    answer = _lowpass(impulse, cutoff * period)
    whole = np.correlate(answer, answer, mode="full")[4 * reach : 5 * reach + 1 : every]
    return math.sqrt(whole[0]), whole / whole[0]


def _filled(readings: Array, edge: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return readings with gaps bridged, and which rows no gap bears on."""
    from scipy.ndimage import minimum_filter1d

    good = np.isfinite(readings)
    at = np.arange(len(readings))
    columns = [
        np.interp(at, at[ok], x[ok]) if ok.any() else np.zeros(len(x))
        for x, ok in zip(readings.T, good.T, strict=True)
    ]
    whole = good.all(axis=1).astype(np.int8)
    return np.column_stack(columns), minimum_filter1d(whole, 2 * edge + 1) == 1


def _noise(readings: Array) -> Array:
    """Return the deviation of the readings' white noise, by second differences, (A,) m/s^2."""
    noise: Array = np.maximum(np.diff(readings, 2, axis=0).std(axis=0) / math.sqrt(6.0), _LEAST)
    return noise


def _check(sensor: Accelerometer, period: float, q: Array, readings: Array, cutoff: float) -> int:
    """Refuse what does not belong together; returns the low-pass' memory in rows."""
    if len(q) != len(readings) or readings.shape[1:] != (len(sensor.axes),):
        what = "a motion needs a reading for each axis and instant"
        allowed = f"({len(q)}, {len(sensor.axes)})"
        raise MethodError(what, where=sensor.name, value=readings.shape, allowed=allowed)
    if not 0.0 < cutoff * period <= 0.5 * math.pi:
        allowed = f"up to {0.5 * math.pi / period:g} rad/s"
        raise MethodError("no such cutoff", where="cutoff", value=cutoff, allowed=allowed)
    if not np.isfinite(q).all():
        raise MethodError("link angles must be numbers at every row", where="q")
    edge = math.ceil(_FORGOTTEN / cutoff / period)
    if len(q) < 4 * edge:
        what = "too short for the low-pass"
        raise MethodError(what, where=sensor.name, value=len(q), allowed=f"{4 * edge} rows or more")
    return edge
