"""Joint accelerations from accelerometers on the links (deluca2007 eqs 8-11), joint rates too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError, check_names
from rotatum.estimators.full_state.damped import DampedInverse, damped_inverse, told_generically
from rotatum.kernels.status import NOT_FINITE, SINGULAR, UNSEEN
from rotatum.models.robot.accelerations import AccelerometerMap, GyroscopeMap, Mounted
from rotatum.models.robot.interface import Robot

__all__ = ["JointAccelerations", "Solved"]

Array = NDArray[np.float64]

LEVER = 0.025
"""Part of the largest lever arm that a direction's must have to be left undamped."""
SHARE = 0.9
"""Share of a joint's own motion below which it is flagged."""
_LARGEST = 1e12  # as in the guard: what is beyond it is no angle or speed of an arm


class Solved(NamedTuple):
    """What sensors tell of the joints at one instant.

    Args:
        motion: (n,) joint accelerations [rad/s^2], or rates [rad/s].
        share: (n,) of each joint's motion that is told and not damped away, 0 to 1.
        condition: of the weighted map, over the directions generically told; inf.
        status: (n,) SINGULAR where a joint that is generically determined has a share below
            `SHARE`; UNSEEN where it is not determined at any pose; NOT_FINITE, of all joints, where
            a reading, or the state, was not a number.
    """

    motion: Array
    share: Array
    condition: float
    status: NDArray[np.int64]


class JointAccelerations:
    """Joint accelerations out of what accelerometers on the links show; rates from gyroscopes.

    ``q'' = prior + T^+ (y - W(q, q') - T prior)``: eq. 11 with the damped left inverse of
    `damped_inverse`, rows weighted by the sensors' noise. A direction v of joint space, (n,) of
    length 1, has the lever arm ``|T v|`` [m]: what an acceleration of 1 rad/s^2 along it shows. It
    is damped where that is below `lever`, smoothly; what is damped away stays at the prior, by
    default 0. The noise of q'' is thus at most ``1.21 noise / lever`` along any direction.

    Of joints that the sensors do not determine at any pose (too few readings, or the sensor sits
    below the joint), UNSEEN, the prior is returned. They are not taken as standing still: all
    columns of T take part, so that a joint which is determined keeps its value whatever those do.
    Damped, it does get a part of another's: at most the root of ``share (1 - share)`` of it.

    Args:
        robot: the arm.
        accelerometers, gyroscopes: where they sit, as in the device.
        noise: sensor -> standard deviation of its readings [m/s^2, rad/s], all of them; None: each
            kind has the same, 1.
        lever: m; None: `LEVER` of the largest lever arm over random poses. Of weighted rows: of a
            sensor whose precision is the rms of all. Of gyroscopes the same part of the largest
            singular value is the threshold.

    Attributes:
        columns, gyro_columns: names of the readings, ``<name>.ax`` and ``<name>.gx``, in order.
        determined, gyro_determined: (n,) which joints they determine at almost every pose.
        lever, gyro_threshold: what is used; m, and without unit.

    Raises:
        MethodError: a noise or lever that is not positive, or noise of another sensor.
        DeviceError: a frame the arm does not have.
    """

    def __init__(
        self,
        robot: Robot,
        accelerometers: Sequence[Mounted],
        gyroscopes: Sequence[Mounted] = (),
        *,
        noise: Mapping[str, float] | None = None,
        lever: float | None = None,
    ) -> None:
        if lever is not None and not 0.0 < lever < np.inf:
            raise MethodError("a lever arm must be positive", where="lever", value=lever)
        if noise is not None:
            _check_noise(noise, [s.name for s in (*accelerometers, *gyroscopes)])
        self.map = AccelerometerMap(robot, accelerometers)
        self.gyro_map = GyroscopeMap(robot, gyroscopes)
        self.columns, self.gyro_columns = self.map.columns, self.gyro_map.columns
        self._weights, self._noise = _weights(accelerometers, noise)
        self._gyro_weights, self._gyro_noise = _weights(gyroscopes, noise)
        n = robot.size
        self._told = _generic(self.map, self._weights, n)
        self._gyro_told = _generic(self.gyro_map, self._gyro_weights, n)
        self.determined, self.gyro_determined = self._told.joints, self._gyro_told.joints
        # Without a sensor there is no scale, and any threshold will do.
        self.lever = lever or LEVER * self._told.scale or 1.0
        self.gyro_threshold = LEVER * self._gyro_told.scale or 1.0
        self._none = np.zeros(n)

    def solve(self, q: Array, dq: Array, readings: Array, prior: Array | None = None) -> Solved:
        """Return the joint accelerations; never raises for numbers.

        Args:
            q, dq: (n,) rad, rad/s.
            readings: (M,) m/s^2, as `columns` says; a NaN leaves its row out.
            prior: (n,) rad/s^2, what to fill in for what is not told; None: 0.
        """
        guess = self._none if prior is None else prior
        if not (_sound(q) and _sound(dq)):
            return self._lost(guess, self.determined)
        matrix, rest = self.map.both(q, dq)
        left = readings - rest if prior is None else readings - rest - matrix @ prior
        return self._out(matrix, left, self._weights, self.lever, guess, self._told)

    def rates(self, q: Array, readings: Array, prior: Array | None = None) -> Solved:
        """Return the joint rates that gyroscopes tell; never raises for numbers.

        Args:
            q: (n,) rad.
            readings: (G,) rad/s, as `gyro_columns` says; a NaN leaves its row out.
            prior: (n,) rad/s, what to fill in for what is not told; None: 0.
        """
        guess = self._none if prior is None else prior
        if not _sound(q):
            return self._lost(guess, self.gyro_determined)
        matrix = self.gyro_map.matrix(q)
        left = readings if prior is None else readings - matrix @ prior
        by, threshold = self._gyro_weights, self.gyro_threshold
        return self._out(matrix, left, by, threshold, guess, self._gyro_told)

    def inverse(self, q: Array) -> DampedInverse:
        """Return T^+ at a pose: (n, M) of the readings as they are, share and condition."""
        by = self._weights[:, None]
        found = damped_inverse(by * self.map.matrix(q), self.lever, self._told.rank)
        return found._replace(matrix=found.matrix * self._weights)

    def covariance(self, q: Array) -> Array:
        """Return the covariance of q'' by the sensors' noise at a pose, (n, n) rad^2/s^4.

        Of what is told: what is damped away has none, and a share below 1. With `noise` None it is
        that of readings with 1 m/s^2 each.
        """
        by_noise = self.inverse(q).matrix * self._noise
        covariance: Array = by_noise @ by_noise.T
        covariance[~self.determined] = 0.0
        covariance[:, ~self.determined] = 0.0
        return covariance

    def _out(
        self,
        matrix: Array,
        left: Array,
        weights: Array,
        threshold: float,
        guess: Array,
        told: _Generic,
    ) -> Solved:
        """Solve for what is left of the readings."""
        status = told.unseen.copy()
        if not _sound(left):
            good = np.abs(left) < _LARGEST
            weights, left = np.where(good, weights, 0.0), np.where(good, left, 0.0)
            status |= NOT_FINITE
        found = damped_inverse(weights[:, None] * matrix, threshold, told.rank)
        motion = guess + found.matrix.dot(weights * left) * told.joints
        low = found.share < SHARE
        if low.any():
            status[low & told.joints] |= SINGULAR
        return Solved(motion, found.share, found.condition, status)

    def _lost(self, guess: Array, determined: NDArray[np.bool_]) -> Solved:
        """Return the prior: where the arm is, or how it moves, is not known."""
        status = np.where(determined, SINGULAR, UNSEEN) | NOT_FINITE
        return Solved(guess.copy(), self._none.copy(), np.inf, status)


class _Generic(NamedTuple):
    """What is told at almost every pose, and the status of joints of which it is not."""

    joints: NDArray[np.bool_]
    rank: int
    scale: float
    unseen: NDArray[np.int64]


def _generic(at: AccelerometerMap | GyroscopeMap, weights: Array, n: int) -> _Generic:
    """Ask a map, its rows weighted."""
    told = told_generically(lambda q: weights[:, None] * at.matrix(q), n)
    return _Generic(*told, np.where(told.joints, 0, UNSEEN))


def _sound(x: Array) -> bool:
    # a handful of Python's floats: a tenth of the time of numpy's functions, and no warnings
    return all(-_LARGEST < value < _LARGEST for value in x.tolist())


def _weights(sensors: Sequence[Mounted], noise: Mapping[str, float] | None) -> tuple[Array, Array]:
    """Return weights, mean square 1, and standard deviations of the readings."""
    stds = [1.0 if noise is None else noise[s.name] for s in sensors for _ in s.axes]
    std = np.array(stds, dtype=np.float64)
    if not len(std):
        return std, std
    return 1.0 / (std * np.sqrt(np.mean(std**-2.0))), std


def _check_noise(noise: Mapping[str, float], names: Sequence[str]) -> None:
    what = "noise of a sensor the device does not have"
    check_names(noise, names, what=what, where="noise")
    for name in names:
        value = noise.get(name, np.nan)
        if not 0.0 < value < np.inf:
            what = "noise must be given for every sensor, and positive"
            raise MethodError(what, where=f"noise.{name}", value=noise.get(name))
