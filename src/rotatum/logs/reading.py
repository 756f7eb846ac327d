"""Opening a log for reading piece by piece, and reading it whole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotatum.logs.formats import open_source
from rotatum.logs.log import Log
from rotatum.logs.mapping import map_channels
from rotatum.logs.reader import LogReader
from rotatum.models import Device

__all__ = ["open_log", "read_log"]

Array = NDArray[np.float64]


def open_log(
    path: str | Path,
    device: Device,
    *,
    chunk: int = 262144,
    inertial: bool = True,
    true_states: bool = False,
) -> LogReader:
    """Open a log for reading piece by piece.

    Every column read takes its time: who needs no sensor of the links may leave them out.

    Parameters
    ----------
    path : CSV (any delimiter, gzip), NPZ, MAT, HDF5 or Parquet.
    device : says where the log keeps each channel; see `map_channels`.
    chunk : samples per piece, at least 2. CSV and Parquet need memory for two pieces, however
        long they are.
    inertial : whether the readings of the device's accelerometers and gyroscopes are read, those
        the log has.
    true_states : whether the true positions and rates of a simulated log are read as roles of the
        joints: "q_true", "theta_true", "dq_true", ... [rad, rad/s]; an antagonistic joint has
        "theta1_true" and "theta2_true", a serial one "setpoint_true", of the set-point's motor.

    Raises
    ------
    LogError if the file cannot be read, lacks a channel, has a clock that does not increase, a
    period that is not the device's, or fewer than 100 samples; ExtraError if its format needs a
    package that is not installed.
    """
    source = open_source(path)
    mapped = map_channels(
        device, source.names, str(path), inertial=inertial, true_states=true_states
    )
    return LogReader(str(path), source, mapped, device.period, chunk)


def read_log(
    path: str | Path, device: Device, *, inertial: bool = True, true_states: bool = False
) -> Log:
    """Read a whole log into memory.

    Parameters
    ----------
    path, device, inertial, true_states : as in `open_log`.

    Raises
    ------
    LogError and ExtraError as in `open_log`.
    """
    reader = open_log(path, device, inertial=inertial, true_states=true_states)
    pieces = list(reader)
    return Log(
        source=reader.source,
        time=np.concatenate([piece.time for piece in pieces]),
        joints=_whole([piece.joints for piece in pieces]),
        holds=reader.holds,
        clock=reader.clock,
        warnings=reader.warnings,
        inertial=_whole([piece.inertial for piece in pieces]),
        inertial_warnings=reader.inertial_warnings,
    )


def _whole(pieces: Sequence[Mapping[str, Mapping[str, Array]]]) -> dict[str, dict[str, Array]]:
    """Join owner -> role -> values."""
    return {
        owner: {role: np.concatenate([piece[owner][role] for piece in pieces]) for role in roles}
        for owner, roles in pieces[0].items()
    }
