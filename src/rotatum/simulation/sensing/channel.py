"""What one channel of a joint shows of what is there: mechanics, electronics and converter."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.sensing.sensors import Sensors
from rotatum.simulation.sensing.streams import stream

__all__ = ["Channel", "quantise", "wrapped"]

Array = NDArray[np.float64]

# Of a wrap: a reading this close below it is a count that was rounded, not a turn short of one.
_WRAP_ROUNDING = 1e-9


class Channel:
    """A channel's faults but those of time, whole rows and runs of samples.

    Its noise goes on from one call to the next: sample by sample it shows what it shows at once.

    Parameters
    ----------
    role
        Of the channel, of `rotatum.simulation.sensing.sensors.ROLES`.
    sensors
        What goes wrong.
    counts
        Per turn of its encoder; None: not quantised.
    of_motor
        Whether it is a motor's angle, which the zero of the deflection shifts.
    seed, number
        Of the random faults, and of the joint in its device.
    """

    def __init__(
        self,
        role: str,
        sensors: Sensors,
        *,
        counts: float | None,
        of_motor: bool,
        seed: int,
        number: int = 0,
    ) -> None:
        self.role, self.sensors, self.counts = role, sensors, counts
        self._zero = sensors.deflection_zero if of_motor else 0.0
        self._phase = 0.0
        if sensors.eccentricity.get(role, 0.0) != 0.0:
            drawn = stream(seed, f"eccentricity.{role}", number)
            self._phase = drawn.uniform(0.0, 2.0 * math.pi)
        noisy = sensors.noise.get(role, 0.0) > 0.0
        self._noise = stream(seed, f"noise.{role}", number) if noisy else None

    def show(self, x: Array) -> Array:
        """Return the readings of true values (K,) [rad, N m] that follow the last call's, fresh."""
        x = self._eccentric(x)
        if self._zero != 0.0:
            x = x - self._zero
        return self._converted(self._measured(x))

    def _eccentric(self, x: Array) -> Array:
        amplitude = self.sensors.eccentricity.get(self.role, 0.0)
        if amplitude == 0.0:
            return x
        turns = self.sensors.eccentricity_turns.get(self.role, 1.0)
        return x + amplitude * np.sin(turns * x + self._phase)

    def _measured(self, x: Array) -> Array:
        """Return what the electronics make of it, (K,)."""
        sensors, role = self.sensors, self.role
        if role in sensors.gain:
            x = sensors.gain[role] * x
        if role in sensors.offset:
            x = x + sensors.offset[role]
        if self._noise is not None:
            x = x + sensors.noise[role] * self._noise.standard_normal(x.size)
        return x

    def _converted(self, x: Array) -> Array:
        """Return the numbers that come out of the converter or the counter, (K,)."""
        sensors, role = self.sensors, self.role
        if role in sensors.saturation:
            x = np.clip(x, -sensors.saturation[role], sensors.saturation[role])
        x = x.copy() if self.counts is None else quantise(x, self.counts)
        return wrapped(x, sensors.wrap[role]) if role in sensors.wrap else x


def quantise(x: Array, counts: float) -> Array:
    """Return angles (N,) [rad] rounded to the nearest of `counts` per turn."""
    step = 2.0 * math.pi / counts
    return step * np.round(x / step)


def wrapped(x: Array, wrap: float) -> Array:
    """Return angles (N,) [rad] that start again from zero at `wrap` [rad]."""
    rest = np.mod(x, wrap)
    return np.where(rest > (1.0 - _WRAP_ROUNDING) * wrap, 0.0, rest)
