"""Parameter records of a stage from a device's constants and the settings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from rotatum.estimators.gains import noise_gain, steady_gains, velocity_std
from rotatum.estimators.series import Shape, series_stage
from rotatum.estimators.settings import MOTOR_COLUMNS, Settings
from rotatum.estimators.stiffness import LEVELS
from rotatum.kernels import rows
from rotatum.kernels.evidence import DRAG, PULL
from rotatum.models import Joint
from rotatum.record import Records
from rotatum.runtime.stage import Stage

KINDS = {
    "inertia": rows.INERTIA,
    "damping": rows.DAMPING,
    "coulomb": rows.COULOMB,
    "skew": rows.SKEW,
    "transmission_damping": rows.TRANSMISSION_DAMPING,
    "offset": rows.OFFSET,
}
PRIOR = 1e8  # prior variance over row variance, normalised: 1e-8 of one row with a column of 1
ZERO_SECONDS = 0.05  # of rest at the start from which the deflection's zero is read
BLOCK = 16  # rows in the shortest block of residuals
MEMORY = 10.0  # seconds the tests of the model look back
BIAS = 0.02  # relative error of the stiffness below which no model is called wrong
MISSING = 8  # samples bridged by straight lines
TOP_SPEED = 100.0  # rad/s at the joint: faster than any joint, slower than a jump of an encoder
SLOW = 0.01  # rad/s at which the motor should move by a count in the span of the velocity
REST = 1e-3  # rad/s below which Coulomb friction has no sign, however good the encoder


class Prepared(NamedTuple):
    """One joint ready to run.

    Args:
        joint: as described.
        settings: every choice.
        shape: what decides the code.
        stage: the estimator.
        params: ``(1,)`` record of ``stage.params``.
        columns: names of the regressors, basis terms first.
        scales: what each coefficient is divided by to be in SI at the joint.
        notes: setting to a sentence: its value and why.
    """

    joint: Joint
    settings: Settings
    shape: Shape
    stage: Stage
    params: Records
    columns: tuple[str, ...]
    scales: tuple[float, ...]
    notes: dict[str, str]


def prepare(
    joint: Joint,
    settings: Settings,
    *,
    period: float,
    holds: Mapping[str, str],
    zero: float | None = None,
) -> Prepared:
    """Fill a stage's parameters.

    Args:
        joint: constants, encoders, basis.
        settings: from ``settle``.
        period: sample period, s.
        holds: role to ``"sampled"`` or ``"held"``.
        zero: deflection at rest, rad, where the caller has measured it (``zero = "mean"``);
            ``None`` follows the device file.
    """
    powers = _powers(joint)
    terms, columns = len(powers), len(powers) + len(settings.fit)
    shape = Shape(settings.method, settings.torque, terms, columns, max(powers), settings.solver)
    stage = series_stage(shape)
    params = stage.params.zeros(1)
    inner = params["inner"][0]
    notes = _setting_notes(settings)
    scales = _column_scales(joint, settings, period)
    _guard(params["guard"][0], joint, settings, period, notes)
    _zero(inner["rows"]["zero"], joint, period, zero, notes)
    _basis(inner["rows"]["basis"], joint, powers, notes)
    held = holds.get("tau") == "held"
    if settings.method == "weak":
        _weak(inner["rows"]["weak"], joint, settings, period, held)
        _friction(inner["rows"]["weak"], joint, settings, period, notes)
        inner["rows"]["weak"]["scale"][:] = [1.0] * terms + list(scales)
        inner["rows"]["weak"]["kind"][:] = [0] * terms + [KINDS[name] for name in settings.fit]
    else:
        width = _kinematic(inner["rows"]["kinematic"], joint, settings, period, notes)
        _residual(inner["rows"]["residual"], joint, settings, period, held)
        inner["rows"]["residual"]["width"] = width
    _solver(inner, joint, settings, period, powers, scales, notes)
    si = tuple(_range(joint) ** power for power in powers)
    names = tuple("constant" if i == 0 else f"phi^{i}" for i in powers)
    return Prepared(joint, settings, shape, stage, params, names + settings.fit, si + scales, notes)


def _powers(joint: Joint) -> list[int]:
    if joint.basis.full:
        return list(range(joint.basis.orders))
    return [2 * h + 1 for h in range(joint.basis.orders)]


def _range(joint: Joint) -> float:
    # With a single power the range only scales; 0.01 rad is a middling elastic joint.
    return joint.basis.deflection_range or 0.01


def _column_scales(joint: Joint, settings: Settings, period: float) -> tuple[float, ...]:
    """Typical size of each fitted column, within a few orders: the prior is relative to it."""
    scale = {
        "inertia": settings.cutoff,
        "damping": 1.0,
        "coulomb": 1.0,
        "skew": 1.0,
        "transmission_damping": _range(joint) * settings.cutoff,
        "offset": 1.0,
    }
    return tuple(scale[name] for name in settings.fit)


def _setting_notes(settings: Settings) -> dict[str, str]:
    fitted = ", ".join(settings.fit) or "nothing beside the stiffness"
    values = {
        "method": settings.method,
        "torque": settings.torque,
        "cutoff": f"{settings.cutoff:g} rad/s",
        "fit": fitted,
        "forgetting": f"{settings.forgetting:g}",
        "solver": settings.solver,
    }
    return {name: f"{value} ({settings.reasons[name]})" for name, value in values.items()}


def _guard(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> None:
    jump = max(0.05, TOP_SPEED * period)
    record["period"] = period
    record["missing"] = MISSING
    record["jump"][:2] = jump
    record["wrap"][:2] = (joint.encoders.wrap_link or 0.0, joint.encoders.wrap_motor or 0.0)
    motor = joint.motors[0] if joint.motors else None
    if motor is not None and motor.torque_limit is not None and settings.torque == "estimated":
        record["limit"][2] = motor.torque_limit * abs(motor.gear_ratio)
    notes["guard"] = (
        f"up to {MISSING} missing samples are bridged; an angle moving by more than {jump:.3g} rad "
        "in a sample is a jump"
    )


def _zero(
    record: Any, joint: Joint, period: float, zero: float | None, notes: dict[str, str]
) -> None:
    filed = joint.transmission.zero
    if zero is None and isinstance(filed, float | int):
        zero = float(filed)
    if zero is None:
        record["samples"] = max(1, round(ZERO_SECONDS / period))
        notes["zero"] = f"mean deflection of the first {record['samples']} samples"
    else:
        record["zero"] = zero
        source = "mean of the log" if filed == "mean" else "device file"
        notes["zero"] = f"{zero:.6g} rad ({source})"


def _basis(record: Any, joint: Joint, powers: list[int], notes: dict[str, str]) -> None:
    record["scale"] = _range(joint)
    record["half"] = 1.0
    record["power"][:] = powers
    listed = ", ".join(str(i) for i in powers)
    notes["basis"] = f"powers {listed} of the deflection over {_range(joint):g} rad"


def _resolution(joint: Joint) -> tuple[float, float]:
    return joint.encoders.resolution("link") or 0.0, joint.encoders.resolution("motor") or 0.0


def _kinematic(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> float:
    """Fill the kinematic filter; returns the speed below which friction has no clear sign."""
    bandwidth = min(10.0 * settings.cutoff, 1.0 / period)
    record["period"] = period
    alpha, beta = steady_gains(bandwidth, period)
    record["position_gain"], record["velocity_gain"] = alpha, beta
    resolution = _resolution(joint)[1]
    std = velocity_std(bandwidth, period, resolution)
    notes["velocity"] = (
        f"steady kinematic Kalman filter, bandwidth {bandwidth:g} rad/s, acceleration variance "
        f"{bandwidth**4 * resolution**2 / 12.0:.3g} rad^2/s^4, velocity noise {std:.3g} rad/s "
        f"from a resolution of {resolution:.3g} rad"
    )
    return max(3.0 * std, REST)


def _friction(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> None:
    """Choose the span of the velocity whose sign Coulomb friction has: 0 without friction."""
    if "coulomb" not in settings.fit and record["coulomb"] == 0.0:
        return
    resolution = _resolution(joint)[1]
    longest = min(31, int(2.0 / (settings.cutoff * period)))
    delay = max(1, min(longest, math.ceil(resolution / (2.0 * period * SLOW))))
    # Two quantised positions, 2 delay apart: std resolution sqrt(2 / 12) over that time.
    std = resolution / math.sqrt(6.0) / (2.0 * delay * period)
    record["delay"] = delay
    record["width"] = max(3.0 * std, REST)
    notes["friction"] = (
        f"sign of the velocity across +-{delay} samples, linear below {record['width']:.3g} rad/s; "
        f"rows lag by {1e3 * delay * period:.3g} ms"
    )


def _motor_constants(record: Any, joint: Joint) -> None:
    if joint.motors:
        motor = joint.motors[0]
        inertia = motor.reflected_inertia
        record["inertia"] = inertia.value if inertia is not None else 0.0
        record["damping"] = motor.reflected_damping.value
        record["coulomb"] = motor.reflected_coulomb.value


def _weak(
    record: Any,
    joint: Joint,
    settings: Settings,
    period: float,
    held: bool,
) -> None:
    record["period"] = period
    record["pole"] = math.exp(-settings.cutoff * period)
    # No transient to wait for (see kernels.weak), only for the low-pass to average noise.
    record["settle"] = 3 + math.ceil(3.0 / (settings.cutoff * period))
    record["held"] = int(held)
    _motor_constants(record, joint)


def _residual(
    record: Any,
    joint: Joint,
    settings: Settings,
    period: float,
    held: bool,
) -> None:
    record["period"] = period
    record["gain"] = settings.cutoff
    # The residual starts from 0: exp(-8) of the first torque is left after 8 time constants.
    record["settle"] = 1 + math.ceil(8.0 / (settings.cutoff * period))
    record["held"] = int(held)
    offset = len(_powers(joint)) if "offset" in settings.fit else -1
    record["offset"] = offset
    _motor_constants(record, joint)


def _solver(
    inner: Any,
    joint: Joint,
    settings: Settings,
    period: float,
    powers: list[int],
    scales: tuple[float, ...],
    notes: dict[str, str],
) -> None:
    solver, evidence, sums = inner["solver"], inner["evidence"], inner["sums"]
    solver["forgetting"] = settings.forgetting
    solver["variance"] = 1.0
    solver["spread"][:] = PRIOR
    evidence["spread"][:] = PRIOR
    evidence["forgetting"] = settings.forgetting
    evidence["memory"] = math.exp(-BLOCK * period / MEMORY)
    evidence["lag"] = min(31, max(1, round(0.25 / (settings.cutoff * period))))
    evidence["accuracy"] = joint.encoders.accuracy or 0.0
    noise, base = _column_noise(joint, settings, period, scales)
    evidence["noise"][:] = [noise["phi"] if i == 1 else 0.0 for i in powers] + [
        noise[name] for name in settings.fit
    ]
    inertia = joint.motors[0].reflected_inertia if joint.motors else None
    if inertia is not None and settings.torque == "estimated" and "inertia" not in settings.fit:
        evidence["common"] = inertia.value * noise["inertia"]
    evidence["given"][len(powers) :] = [base.get(name, 0.0) for name in settings.fit]
    evidence["bias"] = BIAS
    evidence["mute"][PULL] = "inertia" in settings.fit
    evidence["mute"][DRAG] = "skew" in settings.fit or "damping" in settings.fit
    evidence["known"][len(powers) :] = [
        (_known_std(joint, name) * scale) ** 2
        for name, scale in zip(settings.fit, scales, strict=True)
    ]
    sums["shortest"] = BLOCK
    lengths = [BLOCK * 2.0**k for k in range(LEVELS)]
    sums["fade"][:] = [settings.forgetting ** (2.0 * n) for n in lengths]
    sums["fade_single"][:] = [math.exp(-2.0 * n * period / MEMORY) for n in lengths]
    readout = inner["readout"]
    readout["period"] = period
    readout["starved"], readout["informative"], readout["hold"] = 0.5, 0.1, 1.0
    readout["shrink"] = 0.01
    notes["verdict"] = "starved above +-50 %, informative below +-10 % for 1 s"
    if joint.encoders.accuracy:
        notes["accuracy"] = f"deflection trusted to {joint.encoders.accuracy:g} rad (device file)"


def _column_noise(
    joint: Joint, settings: Settings, period: float, scales: tuple[float, ...]
) -> tuple[dict[str, float], dict[str, float]]:
    """Variance that quantisation gives each scaled column, and what its coefficient adds to."""
    link, motor = (step**2 / 12.0 for step in _resolution(joint))
    pole = math.exp(-settings.cutoff * period) if settings.method == "weak" else 0.0
    still, speed, bend = (noise_gain(pole, order, period) for order in range(3))
    scale = dict(zip(settings.fit, scales, strict=True))
    noise = {
        "phi": (link + motor) * still / _range(joint) ** 2,
        "inertia": motor * bend / scale.get("inertia", 1.0) ** 2,
        "damping": motor * speed / scale.get("damping", 1.0) ** 2,
        "coulomb": 0.0,
        "skew": link * speed / scale.get("skew", 1.0) ** 2,
        "transmission_damping": (link + motor)
        * speed
        / scale.get("transmission_damping", 1.0) ** 2,
        "offset": 0.0,
    }
    base = {}
    if joint.motors and settings.torque == "estimated":
        inertia = joint.motors[0].reflected_inertia
        base["inertia"] = (inertia.value if inertia else 0.0) * scale.get("inertia", 1.0)
        base["damping"] = joint.motors[0].reflected_damping.value * scale.get("damping", 1.0)
    return noise, base


def _known_std(joint: Joint, name: str) -> float:
    """Standard deviation of what the device file says, at the joint; 0: it says nothing."""
    if name not in MOTOR_COLUMNS[:3] or not joint.motors:
        return 0.0
    motor = joint.motors[0]
    value = {
        "inertia": motor.reflected_inertia,
        "damping": motor.reflected_damping,
        "coulomb": motor.reflected_coulomb,
    }[name]
    return value.std or 0.0 if value is not None else 0.0
