"""Logs to observe: an arm that is simulated once, and three joints whose motion is a formula."""

from __future__ import annotations

import tomllib
from functools import lru_cache

import numpy as np

from rotatum import Device, Log
from rotatum.logs.clock import Clock
from rotatum.models import device_from_tables
from rotatum.simulation import load_scenario
from rotatum.simulation.scenario.scenario import scenario_from_tables

TIMES = [0.1, 0.4, 0.5, 0.8]  # s: within the short log axis 1 goes and comes back
PERIOD = 1e-3

OWN = """\
name = "three"

[[joint]]
name = "straight"
[joint.motor]
inertia = 0.02
damping = 0.3
[joint.transmission]
law = "linear"
stiffness = 300.0
damping = 0.4

[[joint]]
name = "lever"
actuation = "serial"
[joint.motor]
inertia = 0.05
[joint.setpoint]
law = "lever"
r0 = 0.1
b = 4e-4
[joint.transmission]
law = "lever"
spring = 14220.0
[joint.basis]
deflection_range = 0.05
orders = 2
setpoint_range = [0.06, 0.12]
setpoint_orders = 2

[[joint]]
name = "hardening"
[joint.motor]
inertia = 0.05
[joint.transmission]
law = "cubic"
stiffness = 250.0
cubic = 2e4
"""


@lru_cache(maxsize=1)
def short_arm() -> tuple[Log, Device, str]:
    """0.8 s of deluca2007/short, gyroscope left out: log with true states, device and its file."""
    base = load_scenario("deluca2007/short")
    tables = {key: value for key, value in base.tables.items() if key != "gyroscope"}
    scenario = scenario_from_tables(tables, base.source).with_values(
        {"seconds": 0.8, "joint.axis1.drives.motors.path.times": TIMES}
    )
    return scenario.run(), scenario.device, scenario.device_text()


def wave(t: np.ndarray, amplitude: float, rate: float) -> tuple[np.ndarray, ...]:
    """``a (1 - cos w t)``, its rate and acceleration: at rest in the beginning."""
    return (
        amplitude * (1.0 - np.cos(rate * t)),
        amplitude * rate * np.sin(rate * t),
        amplitude * rate**2 * np.cos(rate * t),
    )


def own_accelerations(seconds: float = 1.0) -> tuple[Log, Device]:
    """Three joints, each link's acceleration measured: links and deflections are cosines.

    The links' dynamics are anyone's: only the motors' balance ``B th'' + D th' - tau_e = tau``
    has to hold, with ``tau_e = K phi + D_s phi'``, or the law of the joint.
    """
    device = device_from_tables(tomllib.loads(OWN), "three.toml")
    t = PERIOD * np.arange(round(seconds / PERIOD))
    q, dq, ddq = wave(t, 0.4, 6.0)
    phi, dphi, ddphi = wave(t, 0.015, 17.0)
    theta, dtheta, ddtheta = q - phi, dq - dphi, ddq - ddphi
    angle = 20.0 + 10.0 * np.sin(3.0 * t)  # rad, of the second motor
    arm = 0.1 - 4e-4 * angle
    torques = {
        "straight": (0.02 * ddtheta + 0.3 * dtheta, 300.0 * phi + 0.4 * dphi),
        "lever": (0.05 * ddtheta, 14220.0 * arm**2 * np.sin(2.0 * phi)),  # flacco2012 eq. 49
        "hardening": (0.05 * ddtheta, 250.0 * phi + 2e4 * phi**3),
    }  # fmt: skip
    joints = {
        name: {"theta": theta, "tau": motor - elastic, "acc": ddq, "q_true": q,
               "theta_true": theta, "dq_true": dq, "dtheta_true": dtheta}
        for name, (motor, elastic) in torques.items()
    }  # fmt: skip
    joints["lever"]["setpoint"] = angle
    return Log("formula", t, joints, {name: {} for name in joints}, Clock(PERIOD)), device
