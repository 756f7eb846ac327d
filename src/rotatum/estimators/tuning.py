"""Parameter records of a stage from a device's constants and the settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from rotatum.estimators.assemble import joint_stage
from rotatum.estimators.columns import (
    KINDS,
    Power,
    basis_scales,
    deflection_range,
    first_shrunk,
    fit_scales,
    powers_of,
    setpoint_scale,
)
from rotatum.estimators.filters import (
    fill_friction,
    fill_gate,
    fill_kinematic,
    fill_link,
    fill_operator,
    fill_residual,
    fill_rotatum,
    fill_weak,
)
from rotatum.estimators.judging import fill_readout, fill_solver, fill_sums
from rotatum.estimators.operators import EXPONENTIAL, OBSERVER, WINDOW, Operator
from rotatum.estimators.samples import fill_guard, fill_zero
from rotatum.estimators.settings import Settings
from rotatum.estimators.shapes import Shape, ends_of, ring_size
from rotatum.models import Joint
from rotatum.record import Records
from rotatum.runtime.stage import Stage

OBSERVED = 512  # samples an observer has room for at least: what it does not use costs nothing


class Prepared(NamedTuple):
    """One joint ready to run.

    Args:
        joint: as described.
        settings: every choice.
        shape: what decides the code.
        stage: the estimator.
        params: ``(1,)`` record of ``stage.params``.
        columns: names of a transmission's regressors, fitted ones first, then the basis; where two
            share a row the fitted ones are the row's.
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
        """Parameter records of each transmission with rows of its own, without what they share."""
        inner = self.params["inner"][0]
        return (inner["first"], inner["second"]) if self.apart else (inner,)

    @property
    def delay(self) -> float:
        """Seconds by which a row's centre lags behind its last sample, friction's wait included."""
        wait = 0
        if self.settings.method not in ("residual", "rotatum"):
            side = "link" if self.settings.side == "link" else "weak"
            wait = int(self.parts[0]["rows"][side]["delay"])
        return self.settings.operator.delay + wait * self.settings.operator.period

    @property
    def ends(self) -> tuple[str, ...]:
        """What the names of the parts' channels end in."""
        return ends_of(self.joint.actuation) if self.apart else ("",)

    @property
    def apart(self) -> bool:
        """Whether each of two transmissions has rows of its own."""
        return self.joint.actuation == "antagonistic" and not self.shape.together


def prepare(
    joint: Joint,
    settings: Settings,
    *,
    period: float,
    holds: Mapping[str, str],
    zeros: Sequence[float] | None = None,
    arm: bool = False,
    phase: int = 0,
) -> Prepared:
    """Fill a stage's parameters.

    Args:
        joint: constants, encoders, basis.
        settings: from ``settle``.
        period: sample period, s.
        holds: role to ``"sampled"`` or ``"held"``.
        zeros: deflection at rest of each transmission, rad, where the caller has measured it
            (``zero = "mean"``); ``None`` follows the device file.
        arm: whether the link is an arm's, whose momentum and forces come with the samples.
        phase: samples by which the rows of a window come later than those of the first joint.
    """
    together = settings.side == "link" and joint.actuation == "antagonistic"
    powers = powers_of(joint, settings.method, together)
    shape = _shape(joint, settings, powers, arm)
    stage = joint_stage(shape)
    params = stage.params.zeros(1)
    notes = _setting_notes(settings)
    own = powers[:: 2 if together else 1]
    prepared = Prepared(
        joint,
        settings,
        shape,
        stage,
        params,
        settings.fit + tuple(power.name for power in own),
        own,
        fit_scales(joint, settings) + basis_scales(joint, own),
        notes,
    )
    if not arm:
        fill_guard(params["guard"][0], joint, settings, notes)
    for i, (part, end) in enumerate(zip(prepared.parts, prepared.ends, strict=True)):
        record = part["rows"]
        for k, which in enumerate(("zero", "zero2") if together else ("zero",)):
            at = i + k
            fill_zero(record[which], joint, at, period, None if zeros is None else zeros[at], notes)
        _basis(record["basis"], joint, own, notes)
        _rows(record, joint, i, settings, shape, phase, holds.get(f"tau{end}") == "held", notes)
        fill_solver(part, joint, i, settings, powers, arm)
    inner = params["inner"][0]
    fill_sums(inner["sums"], settings)
    if shape.selective:
        fill_gate(inner["gate"], joint, settings, prepared.delay, notes)
    if prepared.apart:
        fill_readout(inner["readout"], settings)
    return prepared


def _shape(joint: Joint, settings: Settings, powers: tuple[Power, ...], arm: bool) -> Shape:
    model = joint.transmission.law if settings.torque == "model" else None
    columns = len(powers) + len(settings.fit)
    return Shape(
        settings.method,
        settings.torque,
        len(powers),
        columns,
        max(max(power) for power in powers),
        "covariance" if settings.solver == "covariance" else "ud",
        joint.actuation,
        settings.shrinkage and first_shrunk(powers, len(settings.fit)) < columns,
        model or "",
        len(joint.transmission.constants) if model else 0,
        settings.side,
        arm,
        settings.operator.kind,
        _room(settings.operator),
        settings.selective > 0.0,
    )


def _room(operator: Operator) -> int:
    if operator.kind == OBSERVER:
        return ring_size(operator.observer.recursion.window, OBSERVED)
    return ring_size(operator.length) if operator.kind == WINDOW else 0


_WIDTH = {EXPONENTIAL: "cutoff", WINDOW: "window", OBSERVER: "cutoff"}


def _setting_notes(settings: Settings) -> dict[str, str]:
    fitted = ", ".join(settings.fit) or "nothing beside the stiffness"
    values = {
        "method": settings.method,
        "torque": settings.torque,
        "side": settings.side,
        _WIDTH[settings.operator.kind]: str(settings.operator),
        "fit": fitted,
        "forgetting": f"{settings.forgetting:g}",
        "solver": settings.solver,
        "shrinkage": "of high orders" if settings.shrinkage else "none",
    }
    notes = {name: f"{value} ({settings.reasons[name]})" for name, value in values.items()}
    return {**notes, "bandwidth": _bandwidth_note(settings)}


def _bandwidth_note(settings: Settings) -> str:
    """Remark 3 of trumic2022 for any method: what is quick enough to be lost, and where."""
    operator = settings.operator
    law = "the law is taken for constant"
    if settings.forgetting < 1.0:
        memory = operator.row_period / (1.0 - settings.forgetting)
        law = f"a law that changes is followed over {memory:.3g} s"
    return f"{operator.passband:.3g} Hz: faster motion does not reach the rows; {law}"


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
    shape: Shape,
    phase: int,
    held: bool,
    notes: dict[str, str],
) -> None:
    period, fitted = settings.operator.period, len(settings.fit)
    if settings.method == "residual":
        width = fill_kinematic(record["kinematic"], joint, settings, period, notes)
        record["setpoint"] = record["kinematic"]
        fill_residual(record["residual"], joint, motor, settings, period, held)
        record["residual"]["width"] = width
    elif settings.method == "rotatum":
        fill_rotatum(record, joint, settings.operator, shape.arm, notes)
    else:
        terms = record["link" if settings.side == "link" else "weak"]
        if settings.side == "link":
            fill_link(terms, joint, shape.arm, period)
        else:
            fill_weak(terms, joint, motor, period, held)
        fill_friction(terms, joint, settings, period, notes)
        fill_operator(record["operator"], settings.operator, phase)
        terms["scale"][:fitted] = fit_scales(joint, settings)
        terms["kind"][:fitted] = [KINDS[name] for name in settings.fit]
    if settings.torque == "model":
        transmission, setpoint = joint.transmissions[motor], joint.setpoint
        record["model"]["constants"][:] = transmission.constants
        record["model"]["preload"] = transmission.preload
        record["model"]["offset"] = 0.0 if setpoint is None else setpoint.value(0.0)
        record["model"]["slope"] = 1.0 if setpoint is None else setpoint.slope
