"""The cubic pair of section IV: its motion, and its stiffness by every method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.columns import basis_scales
from rotatum.evaluation.papers.flacco2012 import modality
from rotatum.evaluation.papers.flacco2012.settings import Bounds, PaperSettings
from rotatum.evaluation.papers.menard2013.printed import Observer, printed, stiffness_of
from rotatum.evaluation.papers.variants import with_basis
from rotatum.evaluation.run import estimate
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.simulation.scenario import load_scenario

__all__ = [
    "ALWAYS_AT_REST",
    "METHODS",
    "SECTION4",
    "Found",
    "by_flacco",
    "by_observer",
    "by_rotatum",
    "every_method",
    "motion",
    "truth_of",
]

Array = NDArray[np.float64]

METHODS = ("as printed", "Flacco et al.", "algebraic", "weak")

SECTION4 = Observer(order=2, spread=1e10)
# K_I = 1e3; least squares as it was before the stability factor, whose c is not given: c = 1.
FLACCO = PaperSettings(spread=1e6, c=1.0, gain=1e3)
FLACCO_TERMS = 4
# Eq. 20 of flacco2012 goes from V_max = 10 at rest to V_min = 0.1 at some counts a sample.
# Positions without counts move by more than those whenever they move.
ALWAYS_AT_SPEED = Bounds(0.1, 0.1)
ALWAYS_AT_REST = Bounds(10.0, 10.0)

SWING = 5.0  # N m, amplitude of torques about zero


class Found(NamedTuple):
    """What a method makes of a log.

    Args:
        stiffness: (N,) total on line: read out at the measured deflection, N m/rad.
        parts: (N, 2) of each transmission.
        law: (N,) total by the law of each instant at the true deflection.
    """

    stiffness: Array
    parts: Array
    law: Array


def motion(
    noise: float, torque_noise: float, seed: int, *, swing: bool = False
) -> tuple[Device, Log]:
    """Simulate section IV; return what the estimators are told of the device, and the log.

    Args:
        noise: standard deviation of all three positions, rad.
        torque_noise: of both torques, N m.
        seed: of the noise.
        swing: sines about zero, under which the springs go slack, in place of the scenario's.
    """
    values: dict[str, float] = dict.fromkeys(
        ("sensors.noise.q", "sensors.noise.theta1", "sensors.noise.theta2"), noise
    )
    values |= dict.fromkeys(("sensors.noise.tau1", "sensors.noise.tau2"), torque_noise)
    if swing:
        for role in ("tau1", "tau2"):
            values |= {f"drives.{role}.amplitude": SWING, f"drives.{role}.offset": 0.0}
    scenario = load_scenario("menard2013/section4").with_values(values)
    return scenario.device, scenario.run(seed)


def every_method(device: Device, log: Log) -> dict[str, Found]:
    """Run ``METHODS``.

    Args:
        device: of the cubic pair.
        log: of its motion, with truth.
    """
    runs = (
        by_observer(device, log),
        by_flacco(device, log),
        by_rotatum(device, log, "algebraic"),
        by_rotatum(device, log, "weak"),
    )
    return dict(zip(METHODS, runs, strict=True))


def by_observer(device: Device, log: Log, observer: Observer = SECTION4) -> Found:
    """Run the paper's observer as printed."""
    run = printed(device, log, observer)
    law = sum(
        (stiffness_of(run.coefficients[:, i], phi) for i, phi in enumerate(_true(device, log))),
        np.zeros(log.samples),
    )
    return Found(run.stiffness, run.parts, law)


def by_flacco(
    device: Device, log: Log, bounds: Bounds = ALWAYS_AT_SPEED, *, full: bool = False
) -> Found:
    """Run flacco2012's residual with the settings menard2013 gives.

    Args:
        device, log: as ever.
        bounds: variances of the kinematic filter.
        full: powers 0 to 3 of the deflection in place of 1, 3, 5, 7.
    """
    told = with_basis(device, orders=FLACCO_TERMS, full=full)
    out = modality.printed(told, log, "RESIDUAL", FLACCO, bounds).out
    powers = range(FLACCO_TERMS) if full else range(1, 2 * FLACCO_TERMS, 2)
    a = np.asarray(out["coefficients"]).reshape(log.samples, 2, FLACCO_TERMS)
    law = _law(powers, a, _true(device, log))
    return Found(np.asarray(out["stiffness"]), np.asarray(out["part_stiffness"]), law)


def by_rotatum(device: Device, log: Log, method: str) -> Found:
    """Run a method of ours with its defaults.

    Args:
        device, log: as ever.
        method: ``"weak"`` or ``"algebraic"``.
    """
    (joint,) = device.joints
    (found,) = estimate(log, device, method=method).joints.values()
    out, own = found.records, len(found.powers)
    each = np.asarray(out["coefficients"]).reshape(log.samples, 2, -1)[:, :, -own:]
    a = each / np.array(basis_scales(joint, found.powers))
    law = _law([power.deflection for power in found.powers], a, _true(device, log))
    return Found(np.asarray(out["stiffness"]), np.asarray(out["part_stiffness"]), law)


def truth_of(device: Device, log: Log, part: str) -> Array:
    """Return the true stiffness, (N,) N m/rad, in total or of transmission ``"1"`` or ``"2"``."""
    (joint,) = device.joints
    return log.joints[joint.name]["stiffness_true" if part == "total" else f"stiffness{part}_true"]


def _true(device: Device, log: Log) -> list[Array]:
    (joint,) = device.joints
    logged = log.joints[joint.name]
    return [logged["q_true"] - logged[f"theta{end}_true"] for end in ("1", "2")]


def _law(powers: Sequence[int], coefficients: Array, phis: Sequence[Array]) -> Array:
    """Stiffness of both laws ``sum_h a_h phi^i_h``, coefficients (N, 2, b), at every sample."""
    found = np.zeros(len(coefficients))
    for i, phi in enumerate(phis):
        for h, power in enumerate(powers):
            if power > 0:
                found += coefficients[:, i, h] * power * phi ** (power - 1)
    return found
