"""Parameters of what learns from rows and judges what was learnt."""

from __future__ import annotations

import math
from typing import Any

from rotatum.estimators.columns import Power, first_shrunk, fit_scales, known_std
from rotatum.estimators.noise import column_noise
from rotatum.estimators.settings import Settings
from rotatum.estimators.stiffness import LEVELS
from rotatum.kernels.probes import DRAG, PULL
from rotatum.models import Joint

PRIOR = 1e8  # prior variance over row variance, normalised: 1e-8 of one row with a column of 1
BLOCK = 16  # samples in the shortest block of residuals
FEWEST = 1  # rows in it, where rows are rare
MEMORY = 10.0  # seconds the tests of the model look back
BIAS = 0.02  # relative error of the stiffness below which no model is called wrong


def fill_solver(
    part: Any,
    joint: Joint,
    motor: int,
    settings: Settings,
    powers: tuple[Power, ...],
    arm: bool,
) -> None:
    """Fill the records of solver, evidence, shrinking and read-out of one transmission.

    Args:
        part: holds them.
        joint: constants.
        motor: which of its motors.
        settings: every choice.
        powers: terms of the basis.
        arm: whether the link belongs to an arm.
    """
    solver, evidence = part["solver"], part["evidence"]
    fitted, scales = len(settings.fit), fit_scales(joint, settings)
    solver["forgetting"] = settings.forgetting
    solver["variance"] = 1.0
    solver["spread"][:] = PRIOR
    evidence["spread"][:] = PRIOR
    evidence["forgetting"] = settings.forgetting
    evidence["memory"] = math.exp(-_block(settings) * settings.operator.row_period / MEMORY)
    lag = 0.25 / (settings.cutoff * settings.operator.row_period)
    evidence["lag"] = min(31, max(1, round(lag)))
    evidence["accuracy"] = joint.encoders.accuracy or 0.0
    known, base = _constants(joint, motor, settings)
    noise = column_noise(joint, settings, powers, known, arm)
    evidence["noise"][:] = noise.columns
    evidence["shared"][:] = noise.common
    evidence["common"] = noise.acceleration * (-known if settings.side == "link" else known)
    evidence["given"][:fitted] = [
        base.get(name, 0.0) * scale for name, scale in zip(settings.fit, scales, strict=True)
    ]
    evidence["scale2"] = _scale2(joint, settings, arm)
    evidence["bias"] = BIAS
    # From the link all torque is made of its acceleration: none is left to follow it but noise.
    evidence["mute"][PULL] = "inertia" in settings.fit or settings.side == "link"
    evidence["mute"][DRAG] = bool({"skew", "damping", "link_damping"} & set(settings.fit))
    evidence["known"][:fitted] = [
        (known_std(joint, name, motor) * scale) ** 2
        for name, scale in zip(settings.fit, scales, strict=True)
    ]
    if "shrink" in part.dtype.names:
        part["shrink"]["first"] = first_shrunk(powers, fitted)
    fill_readout(part["readout"], settings)


def _constants(joint: Joint, motor: int, settings: Settings) -> tuple[float, dict[str, float]]:
    """Inertia that is known and not fitted; what fitted quantities add to, at the joint."""
    if settings.side == "link":
        if joint.link is None:
            return 0.0, {}
        inertia = joint.link.inertia.value if joint.link.inertia is not None else 0.0
        return inertia, {"link_damping": -joint.link.damping.value}
    if not joint.motors or settings.torque != "estimated":
        return 0.0, {}
    described = joint.motors[motor]
    reflected = described.reflected_inertia
    value = reflected.value if reflected is not None else 0.0
    base = {"inertia": value, "damping": described.reflected_damping.value}
    return (0.0 if "inertia" in settings.fit else value), base


def _scale2(joint: Joint, settings: Settings, arm: bool) -> float:
    """A pendulum's torque is as sure as its inertia, from which all of it is made."""
    if settings.side != "link" or arm or joint.link is None or joint.link.inertia is None:
        return 0.0
    return ((joint.link.inertia.std or 0.0) / joint.link.inertia.value) ** 2


def _block(settings: Settings) -> int:
    """Rows in the shortest block."""
    return max(FEWEST, BLOCK // settings.operator.every) if settings.operator.every > 1 else BLOCK


def fill_sums(sums: Any, settings: Settings) -> None:
    """Fill ``BlockParams``."""
    shortest, row_period = _block(settings), settings.operator.row_period
    sums["shortest"] = shortest
    lengths = [shortest * 2.0**k for k in range(LEVELS)]
    sums["fade"][:] = [settings.forgetting ** (2.0 * n) for n in lengths]
    sums["fade_single"][:] = [math.exp(-2.0 * n * row_period / MEMORY) for n in lengths]


def fill_readout(readout: Any, settings: Settings) -> None:
    """Fill ``ReadoutParams``: the thresholds of the verdict, and the noise of the positions."""
    readout["period"] = settings.operator.period
    readout["link2"], readout["motor2"] = (std**2 for std in settings.noise)
    readout["starved"], readout["informative"], readout["hold"] = 0.5, 0.1, 1.0
    readout["shrink"] = 0.01
