"""Stages for series-elastic joints: which kernels make which method's rows."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

from rotatum.estimators.stiffness import COVARIANCE, UD, guarded, inner_input, stiffness_stage
from rotatum.kernels import basis, kinematic, residual, rows, weak
from rotatum.record import Field, Layout
from rotatum.runtime.stage import Stage

SOLVERS = {s.name: s for s in (UD, COVARIANCE)}


class Shape(NamedTuple):
    """All that decides a stage's code and layouts; joints that share it share a bank.

    Args:
        method: ``"weak"`` or ``"residual"``.
        torque: ``"estimated"`` or ``"sensor"``.
        terms: terms of the basis.
        columns: all regressors.
        powers: highest power of the deflection.
        solver: ``"ud"`` or ``"covariance"``.
    """

    method: str
    torque: str
    terms: int
    columns: int
    powers: int
    solver: str = "ud"


KERNELS: dict[tuple[str, str], tuple[Any, Any, tuple[str, ...]]] = {
    ("weak", "estimated"): (
        weak.motor_init,
        weak.motor_step,
        ("shinbrot1957", "gautier1997", "messenger2021"),
    ),
    ("weak", "sensor"): (
        weak.sensor_init,
        weak.sensor_step,
        ("shinbrot1957", "gautier1997", "messenger2021"),
    ),
    ("residual", "estimated"): (
        residual.motor_init,
        residual.motor_step,
        ("flacco2012", "jeon2007"),
    ),
    ("residual", "sensor"): (
        residual.sensor_init,
        residual.sensor_step,
        ("flacco2012", "jeon2007"),
    ),
}
"""(method, torque) to init, step and citations. A new method on the motor side adds a row here."""


@lru_cache(maxsize=64)
def series_stage(shape: Shape) -> Stage:
    """The whole estimator of a series joint: guard, rows, solver, evidence, read-out."""
    inner = stiffness_stage(
        rows_stage(shape), SOLVERS[shape.solver], terms=shape.terms, columns=shape.columns
    )
    torque = "torque" if shape.torque == "sensor" else "tau"
    return guarded(inner, ("q", "theta", torque))


def rows_stage(shape: Shape) -> Stage:
    """The part of the estimator that is the method: samples to rows."""
    p, b = shape.columns, shape.terms
    init, step, cites = KERNELS[shape.method, shape.torque]
    name = f"{shape.method}_{shape.torque}_{b}of{p}"
    parts_p: dict[str, Layout] = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
    }
    parts_s: dict[str, Field] = {
        "zero": Field(rows.ZeroState.layout()),
        "terms": Field(basis.BasisState.layout(b=b, m=shape.powers + 1)),
    }
    if shape.method == "weak":
        parts_p["weak"] = weak.WeakParams.layout(p=p)
        parts_s["weak"] = Field(weak.WeakState.layout(p=p))
        parts_s["past"] = Field(basis.BasisState.layout(b=b, m=shape.powers + 1))
    else:
        filters = Field(kinematic.KinematicState.layout())
        parts_p["kinematic"] = kinematic.KinematicParams.layout()
        parts_p["residual"] = residual.ResidualParams.layout()
        parts_s |= {"residual": Field(residual.ResidualState.layout())}
        parts_s |= {"link": filters, "motor": filters}
    doc = f"Rows of {shape.method} from {shape.torque} torque."
    sample = rows.SensorSample if shape.torque == "sensor" else rows.MotorSample
    return Stage(
        name,
        Layout(f"{name}_params", doc, {k: Field(v) for k, v in parts_p.items()}),
        Layout(f"{name}_state", doc, parts_s),
        inner_input(sample),
        rows.Row.layout(p=p),
        init,
        step,
        cites,
    )
