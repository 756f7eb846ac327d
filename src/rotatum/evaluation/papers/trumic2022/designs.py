"""What poles, delay and bandwidth of the observer buy on the same encoder."""

from __future__ import annotations

import math

from rotatum.estimators.observers.decoupled import exact_observer
from rotatum.estimators.observers.jerk import jerk_observer
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.triple import printed_observer, triple_integrator
from rotatum.evaluation.papers.case import Value
from rotatum.evaluation.papers.trumic2022.printed import through
from rotatum.evaluation.papers.trumic2022.runs import track
from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["design_values", "designs", "jerk_noise"]

POLES = (0.8, 0.8 + 0.1j, 0.8 - 0.1j)
LONGER = 6  # samples
LAGS = (5, 10, 20)  # samples on either side of the fitted polynomial
BANDWIDTHS = (120.0, 60.0, 30.0, 15.0, 8.0)  # rad/s


def designs(period: float) -> dict[str, Recursion]:
    """Return observers of (q, q', q'', q''') by what they are.

    Args:
        period: T, s.
    """
    plant = triple_integrator(period)
    found = {
        "as printed, deadbeat": printed_observer(period).recursion,
        "exact, poles at 0.8": exact_observer(plant, 3, POLES).recursion,
        f"exact, {LONGER} samples late": exact_observer(plant, LONGER).recursion,
        "deadbeat at one instant, 5 samples": jerk_observer(period, bandwidth=None).recursion,
    }
    for lag in LAGS:
        name = f"polynomial over {2 * lag + 1} samples"
        found[name] = jerk_observer(period, bandwidth=None, lag=lag).recursion
    for bandwidth in BANDWIDTHS:
        name = f"smoother of {bandwidth:g} rad/s"
        found[name] = jerk_observer(period, bandwidth=bandwidth).recursion
    return found


def jerk_noise(observer: Recursion, resolution: float) -> float:
    """Return the standard deviation of the jerk from rounding alone, taken for white, rad/s^3.

    Args:
        observer: with ``out = (q, q', q'', q''')``.
        resolution: of the encoder, rad.
    """
    return resolution / math.sqrt(12.0) * math.sqrt(float(observer.noise()[3, 3]))


def design_values(device: Device, log: Log, start: float) -> list[Value]:
    """Return lines for every design on one log: its delay, noise of the jerk and MSREP.

    Rows by that observer, then the paper's regressor and least squares in all of them.

    Args:
        device: of one joint, with encoders.
        log: of its motion, with truth.
        start: seconds from which it is scored.
    """
    (joint,) = device.joints
    resolution = joint.encoders.resolution("link")
    assert resolution is not None  # a scenario with encoders
    truth = log.joints[joint.name]["stiffness_true"]
    values = []
    for name, observer in designs(log.period).items():
        found = track(log.time, through(device, log, observer), truth, start)
        said = f"{name}, {1e3 * observer.lag * log.period:g} ms late"
        noise = jerk_noise(observer, resolution)
        values += [
            Value(f"{said}: noise of the jerk", "rad/s^3", own=noise),
            Value(f"{said}: MSREP", "%", own=found.msrep),
        ]
    return values
