"""Section 6.2's simulation: a spring whose lever arm a second motor moves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.papers.variants import at_rest_zero, with_basis, with_counts
from rotatum.logs import Log
from rotatum.models import Device, load_device
from rotatum.simulation import Drive, Sensors, simulate_joint, sine

__all__ = ["ASSUMED", "PAPER_ORDERS", "Sweep", "device", "motion"]

SECONDS = 40.0
PERIOD = 1e-3
TORQUE_NOISE = 0.3  # N m at the joint, standard deviation
PAPER_ORDERS = 6  # n of eq. 33; m = 3 is the catalogue's set-point order 2
PAPER_TORQUE = sine(15.0, 0.1)  # 0.3 sin(0.2 pi t) N m at the motor, times the gear ratio of 50

ASSUMED = (
    "The paper draws the second motor's torque (fig. 10) without numbers: the lever arm is "
    "prescribed instead, a cosine 100 -> 80 -> 100 mm over a run of 40 s, which gives the "
    "deflection of the order of 0.005 rad the paper speaks of.",
    "It prints no noise: 0.3 N m rms at the joint is taken on motor torque and torque sensor; "
    "scores are from 2 s on.",
)


@dataclass(frozen=True)
class Sweep:
    """A lever arm that swings from ``high`` to ``low`` and back, m, in ``period`` s."""

    high: float = 0.1
    low: float = 0.08
    period: float = SECONDS

    def __call__(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the lever arm (N,) [m] at times (N,) [s]."""
        middle, half = 0.5 * (self.high + self.low), 0.5 * (self.high - self.low)
        swing: NDArray[np.float64] = middle + half * np.cos(2.0 * math.pi / self.period * time)
        return swing


PAPER_LEVER = Sweep()


def device(orders: int = 3, counts: float | None = None) -> Device:
    """Return the device; its motion begins at rest with both encoders at zero.

    Args:
        orders: odd powers of the deflection.
        counts: encoder counts per turn of link and motor; None: the paper's 40,000.
    """
    found = with_basis(at_rest_zero(load_device("awas")), orders=orders)
    return found if counts is None else with_counts(found, counts)


def motion(
    device: Device,
    seed: int,
    *,
    torque: Drive = PAPER_TORQUE,
    lever: Drive = PAPER_LEVER,
    noise: float = TORQUE_NOISE,
    ideal: bool = False,
) -> Log:
    """Return 40 s at 1 kHz.

    Args:
        device: from ``device``.
        seed: of the noise.
        torque: of the motor, at the joint, N m.
        lever: lever arm by time, m.
        noise: of motor torque and torque sensor, N m.
        ideal: sensors without noise and quantisation.
    """
    noisy = Sensors(noise={"tau": noise, "torque_measured": noise})
    (joint,) = device.joints
    return simulate_joint(
        joint,
        seconds=SECONDS,
        period=PERIOD,
        drives={"tau": torque, "setpoint": lever},
        sensors=Sensors(counts={}) if ideal else noisy,
        seed=seed,
    )
