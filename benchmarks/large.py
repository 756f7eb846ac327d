"""Signals of many joints for as long as one likes: periodic, from inverse dynamics."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenario import PERIOD, device

JOINTS = 7
ROWS = 3_600_000
PIECE = 200_000  # rows written at once: a row group
CYCLE = 50_000  # samples in a period of 20 s

Signal = NDArray[np.float64]


def pieces() -> Iterator[dict[str, Signal]]:
    """Yield canonical columns, ``PIECE`` rows at a time; each joint in a shifted cycle."""
    channels = cycle()
    for first in range(0, ROWS, PIECE):
        index = np.arange(first, min(first + PIECE, ROWS))
        columns = {"time": PERIOD * index}
        for joint in range(JOINTS):
            place = (index + 1009 * joint) % CYCLE
            columns |= {f"j{joint}.{role}": values[place] for role, values in channels.items()}
        yield columns


def cycle() -> dict[str, Signal]:
    """Return one period of q, theta and tau: the torques that make the link follow a multisine."""
    joint = device().joints[0]
    motor, link, encoders = joint.motors[0], joint.link, joint.encoders
    if motor.inertia is None or link is None or link.inertia is None:
        raise AssertionError("the benchmark's device has a motor and a link")
    phase = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 40)
    angle = 2.0 * np.pi * np.arange(CYCLE) / CYCLE
    q = sum(0.4 / n * np.sin(n * angle + phase[n % 40]) for n in (11, 31, 71, 131, 211))
    elastic = -(link.inertia.value * _derivative(q, 2) + link.damping.value * _derivative(q, 1))
    theta = q - _deflection(elastic)
    speed = _derivative(theta, 1)
    tau = motor.inertia.value * _derivative(theta, 2) + motor.damping.value * speed
    tau = tau - elastic
    return {"q": _counted(q, encoders.link), "theta": _counted(theta, encoders.motor), "tau": tau}


def _derivative(x: Signal, order: int) -> Signal:
    rate = 2.0 * np.pi * np.fft.rfftfreq(CYCLE, PERIOD)
    return np.fft.irfft((1j * rate) ** order * np.fft.rfft(x), CYCLE)


def _deflection(torque: Signal) -> Signal:
    """Invert the cubic law by Newton's method, from the linear one's deflection."""
    k, c = 200.0, 1500.0
    phi = torque / k
    for _ in range(30):
        phi = phi - (k * phi + c * phi**3 - torque) / (k + 3.0 * c * phi**2)
    return phi


def _counted(x: Signal, counts: float | None) -> Signal:
    step = 2.0 * np.pi / (counts or 1e9)
    return step * np.round(x / step)
