"""Logs of any joint with a law: its motors obey their equations exactly, its sensors do not.

Deflections are sums of sines over most of the declared range, the set-point wanders over its own;
torques follow from the law and the motor's constants, with noise of a per cent.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rotatum.logs import Log
from rotatum.logs.clock import ClockWatch
from rotatum.models import Joint

Array = NDArray[np.float64]
COUNTS = 65536.0  # of an encoder the device does not describe
NOISE = 0.01  # of the torque's rms


def motion_log(
    joint: Joint, *, seed: int, seconds: float = 20.0, period: float = 1e-3, reach: float = 0.9
) -> Log:
    """A log in canonical roles, truth included; every torque, estimated or measured, is there."""
    rng = np.random.default_rng(seed)
    time = period * np.arange(round(seconds / period))
    q = _sines(time, 0.4, rng)
    roles = {"q": _counted(q[0], joint.encoders.link)}
    setpoint = np.zeros_like(time)
    if joint.actuation == "serial":
        low, high = joint.basis.setpoint_range or (-1.0, 1.0)
        wander = 0.9 * np.sin(2.0 * math.pi * 0.11 * time + rng.uniform(0.0, 6.0))
        setpoint = 0.5 * (low + high) + 0.5 * (high - low) * wander
        roles["setpoint"] = setpoint
        if joint.setpoint is not None:
            roles["setpoint"] = (setpoint - joint.setpoint.value(0.0)) / joint.setpoint.slope
    total = np.zeros_like(time)
    torques = np.zeros_like(time)
    ends = ("1", "2") if joint.actuation == "antagonistic" else ("",)
    for i, end in enumerate(ends):
        spring = joint.transmissions[i]
        phi = _sines(time, reach * (joint.basis.deflection_range or 0.01), rng)
        spring.check(phi[0], setpoint)
        elastic = spring.torque(phi[0], setpoint)
        sigma = spring.stiffness(phi[0], setpoint)
        theta = tuple(a - b for a, b in zip(q, phi, strict=True))
        noise = NOISE * float(np.sqrt(np.mean(elastic**2))) * rng.standard_normal((2, len(time)))
        roles[f"theta{end}"] = _counted(theta[0], joint.encoders.motor)
        roles[f"torque_measured{end}"] = elastic + noise[0]
        roles[f"stiffness{end}_true"], roles[f"torque{end}_true"] = sigma, elastic
        for motor in joint.motors[i : i + 1]:
            inertia = motor.reflected_inertia
            tau = (inertia.value if inertia else 0.0) * theta[2] - elastic + noise[1]
            tau = tau + motor.reflected_damping.value * theta[1]
            roles[f"tau{end}"] = tau + motor.reflected_coulomb.value * np.sign(theta[1])
        total, torques = total + sigma, torques + elastic
    roles["stiffness_true"], roles["torque_true"] = total, torques
    watch = ClockWatch(period)
    watch.add(time)
    holds = {joint.name: dict.fromkeys(roles, "sampled")}
    return Log("made up", time, {joint.name: roles}, holds, watch.clock())


def _sines(time: Array, size: float, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Four sines of 0.1 to 3 Hz whose sum stays within ``size``, with two derivatives."""
    w = 2.0 * math.pi * np.exp(rng.uniform(math.log(0.1), math.log(3.0), 4))
    phase, share = rng.uniform(0.0, 6.0, 4), rng.uniform(0.3, 1.0, 4)
    share = size * share / share.sum()
    arguments = np.outer(time, w) + phase
    return (
        np.sin(arguments) @ share,
        np.cos(arguments) @ (share * w),
        -np.sin(arguments) @ (share * w**2),
    )


def _counted(angle: Array, counts: float | None) -> Array:
    step = 2.0 * math.pi / (counts or COUNTS)
    return np.asarray(step * np.round(angle / step))
