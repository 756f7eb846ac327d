"""Opening a log for reading piece by piece, and reading it whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rotatum.logs.formats import open_source
from rotatum.logs.log import Log
from rotatum.logs.mapping import map_channels
from rotatum.logs.reader import LogReader
from rotatum.models import Device

__all__ = ["open_log", "read_log"]


def open_log(path: str | Path, device: Device, *, chunk: int = 262144) -> LogReader:
    """Open a log for reading piece by piece.

    Parameters
    ----------
    path : CSV (any delimiter, gzip), NPZ, MAT, HDF5 or Parquet.
    device : says where the log keeps each channel; see `map_channels`.
    chunk : samples per piece, at least 2. CSV and Parquet need memory for two pieces, however
        long they are.

    Raises
    ------
    LogError if the file cannot be read, lacks a channel, has a clock that does not increase, a
    period that is not the device's, or fewer than 100 samples; ExtraError if its format needs a
    package that is not installed.
    """
    source = open_source(path)
    mapped = map_channels(device, source.names, str(path))
    return LogReader(str(path), source, mapped, device.period, chunk)


def read_log(path: str | Path, device: Device) -> Log:
    """Read a whole log into memory.

    Parameters
    ----------
    path, device : as in `open_log`.

    Raises
    ------
    LogError and ExtraError as in `open_log`.
    """
    reader = open_log(path, device)
    pieces = list(reader)
    joints = {
        joint: {
            role: np.concatenate([piece.joints[joint][role] for piece in pieces]) for role in roles
        }
        for joint, roles in reader.roles.items()
    }
    return Log(
        source=reader.source,
        time=np.concatenate([piece.time for piece in pieces]),
        joints=joints,
        holds=reader.holds,
        clock=reader.clock,
        warnings=reader.warnings,
    )
