"""Which kernels make which stage: everything about a joint that decides code and layouts."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

from rotatum.estimators.guarded import guarded
from rotatum.estimators.solvers import SOLVERS
from rotatum.estimators.stiffness import pair_stage, stiffness_stage
from rotatum.kernels import basis, kinematic, residual, rows, weak
from rotatum.models.laws import LAWS
from rotatum.record import Field, Layout, integer, number
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.stage import Stage


class Shape(NamedTuple):
    """All that decides a stage's code and layouts; joints that share it share a bank.

    Args:
        method: ``"weak"`` or ``"residual"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
        terms: terms of the basis.
        columns: all regressors of a transmission.
        powers: highest power of the deflection or of the set-point.
        solver: ``"ud"`` or ``"covariance"``.
        actuation: ``"series"``, ``"antagonistic"`` or ``"serial"``.
        shrunk: whether high orders are shrunk.
        law: of the device, where it stands in for a torque; else ``""``.
        constants: how many it has.
    """

    method: str
    torque: str
    terms: int
    columns: int
    powers: int
    solver: str = "ud"
    actuation: str = "series"
    shrunk: bool = False
    law: str = ""
    constants: int = 0


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

MODEL_STEP = """reached = u.q - u.theta - rows_known_zero(params.zero, state.zero)
setpoint = params.model.offset + params.model.slope * u.setpoint
u.torque = law_torque(params.model.constants, reached + params.model.preload, setpoint)
sensor_step(params, state, u, out)"""

_TORQUES = {"estimated": "tau", "sensor": "torque_measured"}
_DOCS = {
    "q": ("link position", "rad"),
    "theta": ("motor position, joint side", "rad"),
    "setpoint": ("set-point as logged", "unit of the set-point"),
    "tau": ("motor torque, joint side", "N m"),
    "torque_measured": ("measured elastic torque", "N m"),
}


def roles(actuation: str, torque: str) -> tuple[str, ...]:
    """Channels an estimator of this actuation reads, under the names of the log.

    Args:
        actuation: ``"series"``, ``"antagonistic"`` or ``"serial"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
    """
    ends = ("1", "2") if actuation == "antagonistic" else ("",)
    found = ["q", *(f"theta{end}" for end in ends)]
    if actuation == "serial":
        found.append("setpoint")
    if torque in _TORQUES:
        found += [f"{_TORQUES[torque]}{end}" for end in ends]
    return tuple(found)


@lru_cache(maxsize=64)
def joint_stage(shape: Shape) -> Stage:
    """The whole estimator of a joint: guard, rows, solver, evidence, read-out."""
    make = pair_stage if shape.actuation == "antagonistic" else stiffness_stage
    inner = make(
        rows_stage(shape),
        SOLVERS[shape.solver],
        terms=shape.terms,
        columns=shape.columns,
        shrunk=shape.shrunk,
    )
    channels = roles(shape.actuation, shape.torque)
    if shape.actuation == "antagonistic":
        wires = {"time": "time"}
        wires |= {f"first.{k}": v for k, v in _wires(shape.torque, "1").items()}
        wires |= {f"second.{k}": v for k, v in _wires(shape.torque, "2").items()}
    else:
        wires = _wires(shape.torque, "")
        if shape.actuation == "serial":
            wires |= {"setpoint": "setpoint"}
    return guarded(inner, sample_layout(shape.actuation, shape.torque), channels, wires)


def sample_layout(actuation: str, torque: str) -> Layout:
    """What an estimator reads: time, its channels, and whether to learn."""
    fields = {"time": number("of the sample", unit="s", symbol="t")}
    for role in roles(actuation, torque):
        doc, unit = _DOCS[role.rstrip("12")]
        which = {"1": ", agonist", "2": ", antagonist"}.get(role[-1], "")
        fields[role] = number(f"{doc}{which}", unit=unit, symbol=role)
    fields["enable"] = integer("0: do not learn from this sample")
    doc = f"One sample of a joint with {actuation} actuation."
    return Layout(f"{actuation}_{torque}_sample", doc, fields)


def _wires(torque: str, end: str) -> dict[str, str]:
    wires = {"time": "time", "q": "q", "theta": f"theta{end}"}
    if torque in _TORQUES:
        wires["torque"] = f"{_TORQUES[torque]}{end}"
    return {**wires, "enable": "enable"}


def rows_stage(shape: Shape) -> Stage:
    """The part of the estimator that is the method: samples of a transmission to rows."""
    p, b, m = shape.columns, shape.terms, shape.powers + 1
    source = "sensor" if shape.torque == "model" else shape.torque
    init, step, cites = KERNELS[shape.method, source]
    name = f"{shape.method}_{shape.torque}_{b}of{p}"
    parts_p: dict[str, Layout] = {
        "zero": rows.ZeroParams.layout(),
        "basis": basis.BasisParams.layout(b=b),
    }
    parts_s: dict[str, Field] = {
        "zero": Field(rows.ZeroState.layout()),
        "terms": Field(basis.BasisState.layout(b=b, m=m)),
    }
    if shape.method == "weak":
        parts_p["weak"] = weak.WeakParams.layout(p=p)
        parts_s["weak"] = Field(weak.WeakState.layout(p=p))
        parts_s["past"] = Field(basis.BasisState.layout(b=b, m=m))
    else:
        filters = Field(kinematic.KinematicState.layout())
        parts_p["kinematic"] = kinematic.KinematicParams.layout()
        parts_p["setpoint"] = kinematic.KinematicParams.layout()
        parts_p["residual"] = residual.ResidualParams.layout()
        parts_s |= {"residual": Field(residual.ResidualState.layout())}
        parts_s |= {"link": filters, "motor": filters, "setpoint": filters}
    doc = f"Rows of {shape.method} from {shape.torque} torque."
    if shape.torque == "model":
        parts_p["model"] = rows.ModelParams.layout(n=shape.constants)
        name = f"{name}_{shape.law}"
        kernels = {
            "rows_known_zero": rows.known_zero,
            "law_torque": LAWS[shape.law].torque,
            "sensor_init": init,
            "sensor_step": step,
        }
        lines = MODEL_STEP.splitlines()
        init, step = write_kernels(name, doc, ["sensor_init(params, state)"], lines, kernels)
    return Stage(
        name,
        Layout(f"{name}_params", doc, {k: Field(v) for k, v in parts_p.items()}),
        Layout(f"{name}_state", doc, parts_s),
        rows.Sample.layout(),
        rows.Row.layout(p=p),
        init,
        step,
        cites,
    )
