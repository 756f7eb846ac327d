"""Section 6.1's simulation: two four-bar transmissions on one link, under gravity."""

from __future__ import annotations

from rotatum.evaluation.papers.variants import at_rest_zero, with_counts
from rotatum.logs import Log
from rotatum.models import Device, load_device
from rotatum.simulation import Drive, Sensors, simulate_joint, sine

__all__ = ["ASSUMED", "NAMES", "TORQUE_NOISE", "device", "motion"]

NAMES = ("vsa-ii", "vsa-ii-alt")
SECONDS = 20.0
PERIOD = 1e-3
TORQUE_NOISE = 2e-3  # N m, standard deviation, on motor torques and on the joint torque sensor
PAPER_DRIVES: dict[str, Drive] = {"tau1": sine(0.05, 0.05), "tau2": sine(0.05, 1.0)}

ASSUMED = (
    "The paper does not print k and C of the springs, inertia and friction of motors and link: "
    "the catalogue's vsa-ii and vsa-ii-alt have two pairs (k, C) that both give the stiffness "
    "level of Table 1.",
    "It prints neither the duration nor the noise: 20 s, and 2 N mm rms on motor torques and "
    "torque sensor, are taken, and scores are from 2 s on.",
)


def device(name: str = "vsa-ii", counts: float | None = None) -> Device:
    """Return the device; its motion begins at rest with all encoders at zero.

    Args:
        name: one of ``NAMES``.
        counts: encoder counts per turn; None: the paper's 4059.
    """
    found = at_rest_zero(load_device(name))
    return found if counts is None else with_counts(found, counts)


def motion(
    device: Device,
    seed: int,
    *,
    drives: dict[str, Drive] | None = None,
    ideal: bool = False,
) -> Log:
    """Return 20 s at 1 kHz under ``tau1 = 50 sin(0.1 pi t)``, ``tau2 = 50 sin(2 pi t)`` N mm.

    Args:
        device: from ``device``.
        seed: of the noise.
        drives: other torques, N m.
        ideal: sensors without noise and quantisation.
    """
    noisy = ("tau1", "tau2", "torque_measured1", "torque_measured2")
    sensors = Sensors(counts={}) if ideal else Sensors(noise=dict.fromkeys(noisy, TORQUE_NOISE))
    (joint,) = device.joints
    return simulate_joint(
        joint,
        seconds=SECONDS,
        period=PERIOD,
        drives=drives or PAPER_DRIVES,
        sensors=sensors,
        seed=seed,
    )
