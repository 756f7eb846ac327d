"""One joint of each actuation, and its equations written out again for scipy."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from rotatum.models import Joint, device_from_tables
from rotatum.simulation.demo import DEVICE

# VSA-II with the constants of the table in section 1.4 of the parameters: C = sqrt 2.
VSA = """\
name = "vsa"
actuation = "antagonistic"
[[motor]]
inertia = 1e-4
damping = 1.27e-3
[[motor]]
inertia = 1e-4
damping = 1.27e-3
[transmission]
law = "fourbar"
spring = 2.5
ratio = 1.4142135623730951
[link]
inertia = 8.33e-3
damping = 0.0127
gravity_torque = 0.245
[encoders]
link = 4059
motor = 4059
"""

# AwAS, flacco2012 eq. 53; its secondary motor's friction stops it at 1.1e5 1/s.
AWAS = """\
name = "awas"
actuation = "serial"
[motor]
inertia = 2.3e-5
damping = 1e-3
gear_ratio = 50
[setpoint]
law = "lever"
r0 = 0.1
b = 3.978873577297384e-4
[setpoint.motor]
inertia = 1.29e-7
damping = 0.0141
gear_ratio = 23
[transmission]
law = "lever"
spring = 14220.0
[link]
inertia = 0.1
damping = 0.15
[encoders]
link = 40000
motor = 40000
setpoint = 1024
"""

B_LEVER = 2.5e-3 / (2 * math.pi)


def joint_of(text: str, **tables: object) -> Joint:
    """Return a device text's joint with some of its tables changed, or taken away (None)."""
    changed = {**tomllib.loads(text), **tables}
    kept = {key: table for key, table in changed.items() if table is not None}
    return device_from_tables(kept, "test").joints[0]


def series_joint(**tables: object) -> Joint:
    return joint_of(DEVICE, **tables)


def four_bar(phi: float) -> float:
    """The torque of the VSA-II out of its linkage (flacco2012 eqs 47-48)."""
    C = math.sqrt(2.0)
    x = C * np.sin(phi / 2)
    rate = C / 2 * np.cos(phi / 2) / np.sqrt(1 - x * x) - 0.5
    return 2 * 2.5 * (np.arcsin(x) - phi / 2) * rate


Rates = Callable[[float, NDArray[np.float64]], list[float]]


def reference(
    rates: Callable[..., list[float]],
    start: list[float],
    samples: int,
    inputs: tuple[NDArray[np.float64], ...],
    *,
    method: str,
    period: float = 1e-3,
) -> NDArray[np.float64]:
    """Return the states (samples, n) under inputs held over each period, by scipy."""
    states = [np.array(start)]
    for k in range(samples - 1):
        held = tuple(x[k] for x in inputs)
        ahead = tuple(x[k + 1] for x in inputs)
        found = solve_ivp(
            lambda t, y, held=held, ahead=ahead: rates(t / period, y, held, ahead),
            (0.0, period),
            states[-1],
            method=method,
            rtol=1e-10,
            atol=1e-14,
        )
        states.append(found.y[:, -1])
    return np.array(states)


def series_rates(part, y, held, ahead):
    q, dq, th, dth = y
    spring = 200 * (q - th) + 1500 * (q - th) ** 3
    return [
        dq,
        (-spring - 15 * np.sin(q) - dq) / 0.8,
        dth,
        (held[0] + spring - 0.32 * dth) / 0.256,
    ]


def vsa_rates(part, y, held, ahead):
    q, dq, th1, dth1, th2, dth2 = y
    one, two = four_bar(q - th1), four_bar(q - th2)
    return [
        dq,
        (-one - two - 0.245 * np.sin(q) - 0.0127 * dq) / 8.33e-3,
        dth1,
        (held[0] + one - 1.27e-3 * dth1) / 1e-4,
        dth2,
        (held[1] + two - 1.27e-3 * dth2) / 1e-4,
    ]


def awas_rates(part, y, held, ahead):
    """With a prescribed lever arm, straight between the samples."""
    q, dq, th, dth = y
    r = held[1] + part * (ahead[1] - held[1])
    spring = 14220 * r**2 * np.sin(2 * (q - th))
    return [dq, (-spring - 0.15 * dq) / 0.1, dth, (held[0] + spring - 2.5 * dth) / 0.0575]


def awas_motor_rates(part, y, held, ahead):
    """With a torque on the secondary motor, its inertia included."""
    q, dq, th, dth, angle, dangle = y
    r = 0.1 - B_LEVER * angle
    spring = 14220 * r**2 * np.sin(2 * (q - th))
    push = -2 * 14220 * B_LEVER * r * np.sin(q - th) ** 2
    gear = 23.0**2
    return [
        dq,
        (-spring - 0.15 * dq) / 0.1,
        dth,
        (held[0] + spring - 2.5 * dth) / 0.0575,
        dangle,
        (held[1] - push - gear * 0.0141 * dangle) / (gear * 1.29e-7),
    ]


def awas_creep_rates(part, y, held, ahead):
    """With a torque on the secondary motor, without its inertia."""
    q, dq, th, dth, angle = y
    full = awas_motor_rates(part, np.array([q, dq, th, dth, angle, 0.0]), held, ahead)
    return [*full[:4], full[5] * 1.29e-7 / 0.0141]
