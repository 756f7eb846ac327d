"""Parameter records of a stage from a device's constants and the settings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from rotatum.estimators.columns import (
    KINDS,
    Power,
    basis_scales,
    column_noise,
    deflection_range,
    first_shrunk,
    fit_scales,
    known_std,
    powers_of,
    setpoint_scale,
)
from rotatum.estimators.filters import fill_friction, fill_kinematic, fill_residual, fill_weak
from rotatum.estimators.settings import Settings
from rotatum.estimators.shapes import Shape, joint_stage, roles
from rotatum.estimators.stiffness import LEVELS
from rotatum.kernels.evidence import DRAG, PULL
from rotatum.models import Joint
from rotatum.record import Records
from rotatum.runtime.stage import Stage

PRIOR = 1e8  # prior variance over row variance, normalised: 1e-8 of one row with a column of 1
ZERO_SECONDS = 0.05  # of rest at the start from which the deflection's zero is read
BLOCK = 16  # rows in the shortest block of residuals
MEMORY = 10.0  # seconds the tests of the model look back
BIAS = 0.02  # relative error of the stiffness below which no model is called wrong
MISSING = 8  # samples bridged by straight lines
TOP_SPEED = 100.0  # rad/s at the joint: faster than any joint, slower than a jump of an encoder


class Prepared(NamedTuple):
    """One joint ready to run.

    Args:
        joint: as described.
        settings: every choice.
        shape: what decides the code.
        stage: the estimator.
        params: ``(1,)`` record of ``stage.params``.
        columns: names of a transmission's regressors, fitted ones first, then the basis.
        powers: terms of the basis.
        scales: what each coefficient is divided by to be in SI at the joint.
        notes: setting to a sentence: its value and why.
    """

    joint: Joint
    settings: Settings
    shape: Shape
    stage: Stage
    params: Records
    columns: tuple[str, ...]
    powers: tuple[Power, ...]
    scales: tuple[float, ...]
    notes: dict[str, str]

    @property
    def parts(self) -> tuple[Any, ...]:
        """Parameter records of each transmission, without the guard and what they share."""
        inner = self.params["inner"][0]
        if self.joint.actuation == "antagonistic":
            return inner["first"], inner["second"]
        return (inner,)


def prepare(
    joint: Joint,
    settings: Settings,
    *,
    period: float,
    holds: Mapping[str, str],
    zeros: Sequence[float] | None = None,
) -> Prepared:
    """Fill a stage's parameters.

    Args:
        joint: constants, encoders, basis.
        settings: from ``settle``.
        period: sample period, s.
        holds: role to ``"sampled"`` or ``"held"``.
        zeros: deflection at rest of each transmission, rad, where the caller has measured it
            (``zero = "mean"``); ``None`` follows the device file.
    """
    powers = powers_of(joint)
    shape = _shape(joint, settings, powers)
    stage = joint_stage(shape)
    params = stage.params.zeros(1)
    notes = _setting_notes(settings)
    prepared = Prepared(
        joint,
        settings,
        shape,
        stage,
        params,
        settings.fit + tuple(power.name for power in powers),
        powers,
        fit_scales(joint, settings) + basis_scales(joint),
        notes,
    )
    _guard(params["guard"][0], joint, settings, period, notes)
    ends = ("1", "2") if joint.actuation == "antagonistic" else ("",)
    for i, (part, end) in enumerate(zip(prepared.parts, ends, strict=True)):
        _zero(part["rows"]["zero"], joint, i, period, None if zeros is None else zeros[i], notes)
        _basis(part["rows"]["basis"], joint, powers, notes)
        _rows(part["rows"], joint, i, settings, period, holds.get(f"tau{end}") == "held", notes)
        _solver(part, joint, i, settings, period, notes)
    inner = params["inner"][0]
    _sums(inner["sums"], settings, period)
    if joint.actuation == "antagonistic":
        _readout(inner["readout"], period)
    return prepared


def _shape(joint: Joint, settings: Settings, powers: tuple[Power, ...]) -> Shape:
    model = joint.transmission.law if settings.torque == "model" else None
    columns = len(powers) + len(settings.fit)
    return Shape(
        settings.method,
        settings.torque,
        len(powers),
        columns,
        max(max(power) for power in powers),
        settings.solver,
        joint.actuation,
        settings.shrinkage and first_shrunk(joint, len(settings.fit)) < columns,
        model or "",
        len(joint.transmission.constants) if model else 0,
    )


def _setting_notes(settings: Settings) -> dict[str, str]:
    fitted = ", ".join(settings.fit) or "nothing beside the stiffness"
    values = {
        "method": settings.method,
        "torque": settings.torque,
        "cutoff": f"{settings.cutoff:g} rad/s",
        "fit": fitted,
        "forgetting": f"{settings.forgetting:g}",
        "solver": settings.solver,
        "shrinkage": "of high orders" if settings.shrinkage else "none",
    }
    return {name: f"{value} ({settings.reasons[name]})" for name, value in values.items()}


def _guard(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> None:
    jump = max(0.05, TOP_SPEED * period)
    record["period"] = period
    record["missing"] = MISSING
    for i, role in enumerate(roles(joint.actuation, settings.torque)):
        if role == "q" or role.startswith("theta"):
            record["jump"][i] = jump
            wrap = joint.encoders.wrap_link if role == "q" else joint.encoders.wrap_motor
            record["wrap"][i] = wrap or 0.0
        motor = joint.motor_of(role) if role.startswith("tau") else None
        if motor is not None and motor.torque_limit is not None:
            record["limit"][i] = motor.torque_limit * abs(motor.gear_ratio)
    notes["guard"] = (
        f"up to {MISSING} missing samples are bridged; an angle moving by more than {jump:.3g} rad "
        "in a sample is a jump"
    )


def _zero(
    record: Any, joint: Joint, which: int, period: float, zero: float | None, notes: dict[str, str]
) -> None:
    filed = joint.transmissions[which].zero
    if zero is None and isinstance(filed, float | int):
        zero = float(filed)
    if zero is None:
        record["samples"] = max(1, round(ZERO_SECONDS / period))
        said = f"mean deflection of the first {record['samples']} samples"
    else:
        record["zero"] = zero
        source = "mean of the log" if filed == "mean" else "device file"
        said = f"{zero:.6g} rad ({source})"
    notes["zero"] = said if which == 0 or notes["zero"] == said else f"{notes['zero']}; {said}"


def _basis(record: Any, joint: Joint, powers: tuple[Power, ...], notes: dict[str, str]) -> None:
    scale = setpoint_scale(joint)
    record["scale"] = deflection_range(joint)
    record["middle"], record["half"] = scale.logged_middle, scale.logged_half
    record["setpoint_order"] = joint.basis.setpoint_orders
    record["power"][:] = [power.deflection for power in powers]
    record["setpoint_power"][:] = [power.setpoint for power in powers]
    own = ", ".join(str(i) for i in sorted({power.deflection for power in powers}))
    notes["basis"] = f"powers {own} of the deflection over {deflection_range(joint):g} rad"
    if joint.basis.setpoint_orders:
        notes["basis"] += (
            f", times powers 0 to {joint.basis.setpoint_orders} of s, the set-point less "
            f"{scale.middle:g} over {scale.half:g}"
        )


def _rows(
    record: Any,
    joint: Joint,
    motor: int,
    settings: Settings,
    period: float,
    held: bool,
    notes: dict[str, str],
) -> None:
    fitted = len(settings.fit)
    if settings.method == "weak":
        fill_weak(record["weak"], joint, motor, settings, period, held)
        fill_friction(record["weak"], joint, settings, period, notes)
        record["weak"]["scale"][:fitted] = fit_scales(joint, settings)
        record["weak"]["kind"][:fitted] = [KINDS[name] for name in settings.fit]
    else:
        width = fill_kinematic(record["kinematic"], joint, settings, period, notes)
        record["setpoint"] = record["kinematic"]
        fill_residual(record["residual"], joint, motor, settings, period, held)
        record["residual"]["width"] = width
    if settings.torque == "model":
        transmission, setpoint = joint.transmissions[motor], joint.setpoint
        record["model"]["constants"][:] = transmission.constants
        record["model"]["preload"] = transmission.preload
        record["model"]["offset"] = 0.0 if setpoint is None else setpoint.value(0.0)
        record["model"]["slope"] = 1.0 if setpoint is None else setpoint.slope


def _solver(
    part: Any,
    joint: Joint,
    motor: int,
    settings: Settings,
    period: float,
    notes: dict[str, str],
) -> None:
    solver, evidence = part["solver"], part["evidence"]
    fitted, scales = len(settings.fit), fit_scales(joint, settings)
    solver["forgetting"] = settings.forgetting
    solver["variance"] = 1.0
    solver["spread"][:] = PRIOR
    evidence["spread"][:] = PRIOR
    evidence["forgetting"] = settings.forgetting
    evidence["memory"] = math.exp(-BLOCK * period / MEMORY)
    evidence["lag"] = min(31, max(1, round(0.25 / (settings.cutoff * period))))
    evidence["accuracy"] = joint.encoders.accuracy or 0.0
    noise = column_noise(joint, settings, period)
    evidence["noise"][:] = noise.columns
    if joint.motors and settings.torque == "estimated":
        described = joint.motors[motor]
        inertia = described.reflected_inertia
        value = inertia.value if inertia is not None else 0.0
        if "inertia" not in settings.fit:
            evidence["common"] = value * noise.acceleration
        base = {"inertia": value, "damping": described.reflected_damping.value}
        evidence["given"][:fitted] = [
            base.get(name, 0.0) * scale for name, scale in zip(settings.fit, scales, strict=True)
        ]
    evidence["bias"] = BIAS
    evidence["mute"][PULL] = "inertia" in settings.fit
    evidence["mute"][DRAG] = "skew" in settings.fit or "damping" in settings.fit
    evidence["known"][:fitted] = [
        (known_std(joint, name, motor) * scale) ** 2
        for name, scale in zip(settings.fit, scales, strict=True)
    ]
    if "shrink" in part.dtype.names:
        part["shrink"]["first"] = first_shrunk(joint, fitted)
    _readout(part["readout"], period)
    notes["verdict"] = "starved above +-50 %, informative below +-10 % for 1 s"
    if joint.encoders.accuracy:
        notes["accuracy"] = f"deflection trusted to {joint.encoders.accuracy:g} rad (device file)"


def _sums(sums: Any, settings: Settings, period: float) -> None:
    sums["shortest"] = BLOCK
    lengths = [BLOCK * 2.0**k for k in range(LEVELS)]
    sums["fade"][:] = [settings.forgetting ** (2.0 * n) for n in lengths]
    sums["fade_single"][:] = [math.exp(-2.0 * n * period / MEMORY) for n in lengths]


def _readout(readout: Any, period: float) -> None:
    readout["period"] = period
    readout["starved"], readout["informative"], readout["hold"] = 0.5, 0.1, 1.0
    readout["shrink"] = 0.01
