"""When the rows of a log were taken, which of them arrived, and what its clock says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.logs.clock import Clock, ClockWatch
from rotatum.simulation.sensing.sensors import Sensors
from rotatum.simulation.sensing.streams import runs, stream

Array = NDArray[np.float64]

# Of `Sensors`, what happens to whole rows: the joints of a device share it.
ROW_FAULTS = ("jitter", "stamped", "clock_rate", "repeats", "dropouts", "dropout_rows")
# Jittered instants stay this far from the middle between two nominal ones, in periods.
_FURTHEST = 0.45
_MOST_JITTER = 0.25


def lateness(samples: int, sensors: Sensors, *, period: float, seed: int) -> Array | float:
    """Return how late each sample is taken (N,) [s]; 0 without jitter.

    White Gaussian, cut at 0.45 periods so that the instants stay in order.

    Raises `RotatumError` for jitter of more than a quarter of the period.
    """
    if sensors.jitter == 0.0:
        return 0.0
    if sensors.jitter > _MOST_JITTER * period:
        raise RotatumError(
            "so much jitter would bring the samples out of order",
            where="sensors.jitter",
            value=sensors.jitter,
            allowed=f"at most {_MOST_JITTER * period:.6g} s, a quarter of the sampling period",
        )
    late = sensors.jitter * stream(seed, "jitter").standard_normal(samples)
    return np.clip(late, -_FURTHEST * period, _FURTHEST * period)


def logged_rows(samples: int, sensors: Sensors, *, seed: int) -> NDArray[np.int64]:
    """Return the sample number behind each row of the log: repeats twice, dropouts not at all."""
    repeated = runs("repeats", samples, sensors.repeats, 1, seed)
    times = np.ones(samples, dtype=np.int64)
    times[repeated] = 2
    times[runs("dropouts", samples, sensors.dropouts, sensors.dropout_rows, seed)] = 0
    return np.repeat(np.arange(samples), times)


@dataclass(frozen=True)
class Rows:
    """The rows of a log.

    Parameters
    ----------
    time : (K,) s, nominal instants of the samples.
    period : s, between them.
    faults : of whole rows; nothing else of these sensors counts.
    seed : of all random faults.
    """

    time: Array
    period: float
    faults: Sensors
    seed: int

    @property
    def late(self) -> Array | float:
        """How late each sample is taken (K,) [s]."""
        return lateness(self.time.size, self.faults, period=self.period, seed=self.seed)

    @property
    def shown_late(self) -> Array | float:
        """How late each sample is by the log's own clock (K,) [s]: 0 unless that is stamped."""
        return self.late if self.faults.stamped else 0.0

    @property
    def kept(self) -> NDArray[np.int64]:
        """Sample behind each row (R,)."""
        return logged_rows(self.time.size, self.faults, seed=self.seed)

    @property
    def stamps(self) -> Array:
        """What the log's clock says at each row (R,) [s]: ``(1 + clock_rate) (t + shown_late)``."""
        time: Array = (1.0 + self.faults.clock_rate) * (self.time + self.shown_late)
        return time[self.kept]

    @property
    def clock(self) -> Clock:
        """Period, jitter and gaps of that clock."""
        watch = ClockWatch(self.period * (1.0 + self.faults.clock_rate))
        watch.add(self.stamps)
        return watch.clock()


def with_shared_rows(sensors: Mapping[str, Sensors]) -> Sensors:
    """Return sensors without faults but those of whole rows, which all joints share.

    Parameters
    ----------
    sensors
        Joint -> sensors; a joint that is not named has no say.

    Raises `RotatumError` if two joints differ in a fault of whole rows.
    """
    if not sensors:
        return Sensors()
    first, *others = sensors
    for name in others:
        for fault in ROW_FAULTS:
            one, other = getattr(sensors[first], fault), getattr(sensors[name], fault)
            if one != other:
                raise RotatumError(
                    f"a log has one clock, but joints {first} and {name} differ in {fault}",
                    where=f"{name}, sensors.{fault}",
                    value=other,
                    allowed=f"{one}, as for {first}",
                )
    return with_rows_of(Sensors(), sensors[first])


def with_rows_of(sensors: Sensors, shared: Sensors) -> Sensors:
    """Return sensors whose faults of whole rows are those of others."""
    return replace(sensors, **{fault: getattr(shared, fault) for fault in ROW_FAULTS})
