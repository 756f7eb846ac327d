"""The scenario of `rotatum demo`: a robot's elbow with a hardening spring and honest sensors."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING

import numpy as np

from rotatum.models.device import device_from_tables
from rotatum.simulation.drivers.waves import After, multisine, sine
from rotatum.simulation.joint import simulate_joint
from rotatum.simulation.sensing.sensors import Sensors

if TYPE_CHECKING:
    from rotatum.logs.log import Log
    from rotatum.models.device import Device

SECONDS = 20.0
REST = 0.1  # seconds before the torque sets in: the deflection's zero is read there
PERIOD = 1e-3
# Standard deviation of the torque signals, relative to their rms: what motor currents show.
TORQUE_NOISE = 0.015

# Stiffness rises from 200 N m/rad by about a half over the deflections the scenario reaches.
DEVICE = """\
name = "demo-elbow"
actuation = "series"

[motor]
inertia = 4e-5
damping = 5e-5
coulomb = 0.01
gear_ratio = 80.0

[transmission]
law = "cubic"
stiffness = 200.0
cubic = 1500.0

[link]
inertia = 0.8
damping = 1.0
coulomb = 0.1
gravity_torque = 15.0

[encoders]
link = 32768.0
motor = 65536.0

[basis]
deflection_range = 0.15
orders = 2

[channels]
tau = { hold = "held" }
"""


def demo_log(seed: int = 0) -> tuple[Device, Log]:
    """Return a series-elastic joint and 20 s of its log at 1 kHz, with known truth.

    A large slow swing (0.15 Hz) carries the spring over its range, a multisine of 0.5-10 Hz shakes
    it on the way, after a tenth of a second at rest. Encoders are quantised, torques 1.5 % noisy,
    motor and link rub.

    Parameters
    ----------
    seed
        Of the multisine's phases and the noise.
    """
    device = device_from_tables(tomllib.loads(DEVICE), "demo")
    motion = sine(9.0, 0.15) + multisine(rms=4.0, low=0.5, high=10.0, count=20, seed=seed)
    torque = After(REST, motion)
    time = PERIOD * np.arange(round(SECONDS / PERIOD))
    noise = TORQUE_NOISE * float(np.sqrt(np.mean(torque(time) ** 2)))
    sensors = Sensors(noise={"tau": noise, "torque_measured": noise})
    log = simulate_joint(
        device.joints[0],
        seconds=SECONDS,
        period=PERIOD,
        drives={"tau": torque},
        sensors=sensors,
        seed=seed,
    )
    return device, log
