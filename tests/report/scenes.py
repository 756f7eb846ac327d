"""Joints with known truth that the tests of report and command line share.

The small one has one basis term and an offset: a single stage to compile, whatever is done with
it. A pair of transmissions and a joint with a lever arm are from the catalogue.
"""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path

import numpy as np

from rotatum import Device, Estimate, Log, estimate, load_device, write_table
from rotatum.models import device_from_tables
from rotatum.simulation import Sensors, multisine, simulate_joint

STIFFNESS = 200.0  # N m/rad
SECONDS, PERIOD = 4.0, 1e-3

DEVICE = f"""\
name = "elbow"

[motor]
inertia = 4e-5
damping = 5e-5
gear_ratio = 80

[transmission]
law = "linear"
stiffness = {STIFFNESS}

[link]
inertia = 0.8
damping = 1.0

[encoders]
link = 65536
motor = 1310720

[basis]
deflection_range = 0.15
orders = 1

[estimator]
method = "weak"
cutoff = 300.0
fit = ["offset"]

[channels]
tau = {{ hold = "held" }}
"""


def small_device(text: str = DEVICE, source: str = "elbow.toml") -> Device:
    return device_from_tables(tomllib.loads(text), source)


@lru_cache(maxsize=1)
def small_log() -> Log:
    """Four seconds of shaking, torques a per cent noisy."""
    return simulate_joint(
        small_device().joints[0],
        seconds=SECONDS,
        period=PERIOD,
        drives={"tau": multisine(rms=5.0, low=0.3, high=10.0, count=20, seed=1)},
        sensors=Sensors(noise={"tau": 0.05, "torque_measured": 0.05}),
        seed=1,
    )


@lru_cache(maxsize=1)
def small_estimate() -> Estimate:
    return estimate(small_log(), small_device())


@lru_cache(maxsize=1)
def pair_log() -> Log:
    """Eight seconds of flacco2012's inputs to the VSA-II, both springs over most of their range."""
    return simulate_joint(
        load_device("vsa-ii").joints[0],
        seconds=8.0,
        period=1e-3,
        drives={
            "tau1": lambda t: 0.05 * np.sin(0.25 * np.pi * t),
            "tau2": lambda t: 0.05 * np.sin(2.0 * np.pi * t),
        },
        sensors=Sensors(noise={"tau1": 2e-3, "tau2": 2e-3}),
        seed=1,
    )


@lru_cache(maxsize=1)
def pair_estimate() -> Estimate:
    return estimate(pair_log(), load_device("vsa-ii"))


@lru_cache(maxsize=1)
def lever_log() -> Log:
    """Eight seconds of the AwAS, its lever arm from 0.1 m to 0.08 m and back."""
    return simulate_joint(
        load_device("awas").joints[0],
        seconds=8.0,
        period=1e-3,
        drives={
            "tau": lambda t: 15.0 * np.sin(1.6 * np.pi * t),
            "setpoint": lambda t: 0.09 + 0.01 * np.cos(0.25 * np.pi * t),
        },
        seed=1,
    )


@lru_cache(maxsize=1)
def lever_estimate() -> Estimate:
    return estimate(lever_log(), load_device("awas"))


def write_scene(folder: Path) -> tuple[Path, Path]:
    """Write log and device file; return their paths."""
    log, device = folder / "elbow.csv", folder / "elbow.toml"
    device.write_text(DEVICE)
    write_table(log, small_log().columns())
    return log, device
