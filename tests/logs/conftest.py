"""A small log with known values, and the devices that read it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotatum.models import Device, device_from_tables

SAMPLES = 300
PERIOD = 1e-3


@pytest.fixture
def table() -> dict[str, NDArray[Any]]:
    """A log of one joint in canonical columns: 300 samples at 1 kHz."""
    time = PERIOD * np.arange(SAMPLES)
    theta = 0.3 * np.sin(20.0 * time)
    return {
        "time": time,
        "j.q": theta + 0.01 * np.cos(20.0 * time),
        "j.theta": theta,
        "j.tau": 2.0 * np.cos(33.0 * time),
    }


@pytest.fixture
def plain() -> Device:
    """A device without [channels]: canonical columns."""
    return device_from_tables({"name": "rig"}, "rig.toml")
