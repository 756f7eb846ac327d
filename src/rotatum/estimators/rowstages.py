"""The part of an estimator that is the method: samples of a transmission, or of a link, to rows."""

from __future__ import annotations

from typing import Any

from rotatum.estimators.operators import WINDOW
from rotatum.estimators.shapes import Shape
from rotatum.kernels import (
    basis,
    cascade,
    kinematic,
    link,
    rates,
    residual,
    rotatum,
    rows,
    unknown_input,
    weak,
    window,
)
from rotatum.models.laws import LAWS
from rotatum.record import Field, Layout
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.stage import Stage

WEAK = ("shinbrot1957", "gautier1997", "messenger2021")
RESIDUAL = ("flacco2012", "jeon2007")
ROTATUM = ("trumic2022", "sundaram2008")

MODEL_STEP = """reached = u.q - u.theta - rows_known_zero(params.zero, state.zero)
setpoint = params.model.offset + params.model.slope * u.setpoint
u.torque = law_torque(params.model.constants, reached + params.model.preload, setpoint)
"""

OPERATE = """terms_step(params, state, u, out)
if state.{own}.count <= 1:
    operator_restart(params.operator, state.operator)
if state.{own}.made != 0:
    operator_push(params.operator, state.operator, state.{own}.raw)
else:
    operator_idle(state.operator)
rows_emit(state.operator, state.{own}.count, u.enable, out)"""


def rows_stage(shape: Shape) -> Stage:
    """Make the rows of a shape: its terms, and the operator they go through."""
    if shape.method == "residual":
        return _residual(shape)
    if shape.method == "rotatum":
        return _rotatum(shape)
    return _weak(shape) if shape.side == "motor" else _link(shape)


def _weak(shape: Shape) -> Stage:
    p, b = shape.columns, shape.terms
    sensor = shape.torque in ("sensor", "model")
    terms = basis.BasisState.layout(b=b, m=shape.powers + 1, r=shape.powers + basis.ROOM)
    params = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
        "weak": weak.WeakParams.layout(p=p),
    }
    state = {
        "zero": rows.ZeroState.layout(),
        "terms": terms,
        "past": terms,
        "weak": weak.WeakState.layout(p=p, c=rows.FIRST + p),
    }
    init, step = (
        (weak.sensor_init, weak.sensor_step) if sensor else (weak.motor_init, weak.motor_step)
    )
    cites = ("menard2013", *WEAK) if shape.method == "algebraic" else WEAK
    return _operated(shape, "weak", rows.Sample.layout(), params, state, init, step, cites)


def _link(shape: Shape) -> Stage:
    pair = shape.actuation == "antagonistic"
    p, b = shape.columns, shape.terms // (2 if pair else 1)
    terms = basis.BasisState.layout(b=b, m=shape.powers + 1, r=shape.powers + basis.ROOM)
    moment = link.LinkMoment.layout(p=p)
    params = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
        "link": link.LinkParams.layout(p=p),
    }
    state = {
        "zero": rows.ZeroState.layout(),
        "terms": terms,
        "before": moment,
        "middle": moment,
        "now": moment,
        "link": link.LinkState.layout(c=rows.FIRST + p),
    }
    if pair:
        params["zero2"] = rows.ZeroParams.layout()
        state |= {"zero2": rows.ZeroState.layout(), "terms2": terms}
    step = link.pair_step if pair else link.one_step
    sample = rows.LinkSample.layout()
    return _operated(shape, "link", sample, params, state, link.init, step, WEAK)


def _operated(
    shape: Shape,
    own: str,
    sample: Layout,
    params: dict[str, Layout],
    state: dict[str, Layout],
    init: Any,
    step: Any,
    cites: tuple[str, ...],
) -> Stage:
    """Put the operator behind the terms of a balance, a model's torque before them."""
    kind: Any = window if shape.operator == WINDOW else cascade
    c = rows.FIRST + shape.columns
    if shape.operator == WINDOW:
        operator = window.WindowParams.layout(w=shape.size), window.WindowState.layout
        params["operator"], state["operator"] = operator[0], operator[1](w=shape.size, c=c)
    else:
        params["operator"] = cascade.CascadeParams.layout()
        state["operator"] = cascade.CascadeState.layout(c=c)
    kernels = {
        "terms_init": init,
        "terms_step": step,
        "operator_init": kind.init,
        "operator_restart": kind.restart,
        "operator_push": kind.push,
        "operator_idle": kind.idle,
        "rows_emit": rows.emit,
    }
    text = OPERATE.format(own=own)
    if shape.torque == "model":
        params["model"] = rows.ModelParams.layout(n=shape.constants)
        kernels |= {"rows_known_zero": rows.known_zero, "law_torque": LAWS[shape.law].torque}
        text = MODEL_STEP + text
    starts = ["terms_init(params, state)", "operator_init(params.operator, state.operator)"]
    return _stage(shape, sample, params, state, starts, text, kernels, cites)


def _residual(shape: Shape) -> Stage:
    b = shape.terms
    sensor = shape.torque in ("sensor", "model")
    filters = kinematic.KinematicState.layout()
    params = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
        "kinematic": kinematic.KinematicParams.layout(),
        "setpoint": kinematic.KinematicParams.layout(),
        "residual": residual.ResidualParams.layout(),
    }
    state = {
        "zero": rows.ZeroState.layout(),
        "terms": basis.BasisState.layout(b=b, m=shape.powers + 1, r=shape.powers + basis.ROOM),
        "residual": residual.ResidualState.layout(),
        "link": filters,
        "motor": filters,
        "setpoint": filters,
    }
    kernels: dict[str, Any] = {
        "terms_init": residual.sensor_init if sensor else residual.motor_init,
        "terms_step": residual.sensor_step if sensor else residual.motor_step,
    }
    text = "terms_step(params, state, u, out)"
    if shape.torque == "model":
        params["model"] = rows.ModelParams.layout(n=shape.constants)
        kernels |= {"rows_known_zero": rows.known_zero, "law_torque": LAWS[shape.law].torque}
        text = MODEL_STEP + text
    starts = ["terms_init(params, state)"]
    return _stage(shape, rows.Sample.layout(), params, state, starts, text, kernels, RESIDUAL)


def _rotatum(shape: Shape) -> Stage:
    pair = shape.actuation == "antagonistic"
    b = shape.terms // (2 if pair else 1)
    terms = basis.BasisState.layout(b=b, m=shape.powers + 1, r=shape.powers + basis.ROOM)
    signals = shape.terms + rotatum.FIRST
    params = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
        "rotatum": rotatum.RotatumParams.layout(),
        "observer": unknown_input.UnknownInputParams.layout(n=4, c=shape.size, o=4, p=1),
    }
    state = {
        "zero": rows.ZeroState.layout(),
        "terms": terms,
        "rotatum": rotatum.RotatumState.layout(c=signals),
        "link": unknown_input.UnknownInputState.layout(n=4, c=shape.size, o=4),
        "rates": rates.RatesState.layout(n=4, c=signals, w=shape.size),
    }
    if pair:
        params["zero2"] = rows.ZeroParams.layout()
        state |= {"zero2": rows.ZeroState.layout(), "terms2": terms}
    kernels: dict[str, Any] = {
        "terms_init": rotatum.init,
        "terms_step": rotatum.pair_step if pair else rotatum.one_step,
    }
    text = "terms_step(params, state, u, out)"
    starts = ["terms_init(params, state)"]
    sample = rotatum.RotatumSample.layout()
    return _stage(shape, sample, params, state, starts, text, kernels, ROTATUM)


def _stage(
    shape: Shape,
    sample: Layout,
    params: dict[str, Layout],
    state: dict[str, Layout],
    starts: list[str],
    text: str,
    kernels: dict[str, Any],
    cites: tuple[str, ...],
) -> Stage:
    name, doc = (
        shape.rows_name,
        f"Rows of {shape.method}, {shape.side} side, {shape.torque} torque.",
    )
    init, step = write_kernels(name, doc, starts, text.splitlines(), kernels)
    return Stage(
        name,
        Layout(f"{name}_params", doc, {k: Field(v) for k, v in params.items()}),
        Layout(f"{name}_state", doc, {k: Field(v) for k, v in state.items()}),
        sample,
        rows.Row.layout(p=shape.columns),
        init,
        step,
        cites,
    )
