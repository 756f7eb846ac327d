"""The narrow waist: rows from any method, a solver, and one read-out make a stiffness estimator."""

from __future__ import annotations

from typing import Any, NamedTuple

from rotatum.kernels import blocks, evidence, guard, readout, rls, rows, udrls
from rotatum.record import Field, Layout, Record, integer
from rotatum.runtime.compose import write_function, write_kernels
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage

LEVELS = 20  # of block sums: the longest block is 2^19 times the shortest


class Solver(NamedTuple):
    """A recursive least-squares kernel: functions over a state with ``alpha``, ``innovation``,
    ``leverage`` and ``count``.

    Args:
        name: short name, as in settings.
        state: its memory.
        init, update, anchor, spread, multiply: see ``rotatum.kernels.udrls``.
        cites: what it comes from.
    """

    name: str
    state: type[Record]
    init: Any
    update: Any
    anchor: Any
    spread: Any
    multiply: Any
    cites: tuple[str, ...]


def _solver(name: str, module: Any, state: type[Record], *cites: str) -> Solver:
    m = module
    return Solver(name, state, m.init, m.update, m.anchor, m.spread, m.multiply, cites)


UD = _solver("ud", udrls, udrls.UdState, "bierman1977", "flacco2012")
COVARIANCE = _solver("covariance", rls, rls.RlsState, "flacco2012", "bittanti1990")

STEP = """rows_step(params.rows, state.rows, u, state.row)
if state.row.fresh != 0:
    blocks_clear(state.sums)
    evidence_cut(state.evidence)
if state.row.valid != 0:
    solver_update(params.solver, state.solver, state.row.R, state.row.y)
    evidence_add(params.evidence, state.evidence, state.sums, state.row, state.solver, {b})
    if evidence_due(params.evidence, state.evidence, state.sums, params.sums, {p}) != 0:
        evidence_noise_level(state.evidence)
        readout_read(state.row, state.solver.alpha, out)
        solver_multiply(state.solver, state.row.D, state.evidence.direction)
        evidence_judge(
            params.evidence, state.evidence, state.sums, state.solver.alpha, state.row.D
        )
        renew(params, state)
        readout_deviations(
            state.evidence, solver_spread(state.solver, state.row.D), 0.0, out
        )
        half = 1.96 * out.stiffness_std
        evidence_verdict_bits(
            params.evidence, state.evidence, half / (math.fabs(out.stiffness) + 1e-300)
        )
tell(params, state, u.time, 1, out)"""

TELL = """readout_read(state.row, state.solver.alpha, out)
sigma_spread = solver_spread(state.solver, state.row.D)
torque_spread = solver_spread(state.solver, state.row.F)
readout_deviations(state.evidence, sigma_spread, torque_spread, out)
readout_decide(
    params.readout, state.readout, state.evidence, params.evidence, state.row, sigma_spread,
    time, counted, out
)
out.time = time
out.rows = state.solver.count"""

RENEW = """for i in range({p}):
    state.evidence.unit[i] = 0.0
state.evidence.unit[state.evidence.turn] = 1.0
solver_multiply(state.solver, state.evidence.unit, state.evidence.direction)
evidence_coefficient(
    params.evidence, state.evidence, state.sums, state.solver.alpha, state.evidence.turn
)
state.evidence.turn = state.evidence.turn + 1
if state.evidence.turn >= {p}:
    state.evidence.turn = 0
level = evidence_anchoring(state.evidence)
if level > 0.0:
    for i in range({p}):
        if params.evidence.known[i] > 0.0:
            solver_anchor(state.solver, i, 0.0, params.evidence.known[i] / level)"""


def stiffness_stage(rows_stage: Stage, solver: Solver, *, terms: int, columns: int) -> Stage:
    """Compose rows -> solver -> evidence -> read-out into one stage whose output is ``Reading``.

    A new method is one new rows stage: it turns samples into ``Row`` records and knows no solver.

    Args:
        rows_stage: writes ``Row`` records of ``columns`` regressors.
        solver: ``UD`` or ``COVARIANCE``.
        terms: number of regressors that are the basis, the first ones.
        columns: number of regressors.
    """
    p = columns
    probes = evidence.PROBES
    block = {"L": LEVELS, "t": p + probes, "s": p * (p + 1) // 2 + probes}
    name = f"{rows_stage.name}_{solver.name}"
    parts: dict[str, tuple[Layout | None, Layout | None]] = {
        "rows": (rows_stage.params, rows_stage.state),
        "row": (None, rows.Row.layout(p=p)),
        "solver": (udrls.SolverParams.layout(p=p), solver.state.layout(p=p)),
        "sums": (blocks.BlockParams.layout(L=LEVELS), blocks.BlockState.layout(**block)),
        "evidence": (evidence.EvidenceParams.layout(p=p), evidence.EvidenceState.layout(p=p)),
        "readout": (readout.ReadoutParams.layout(), readout.ReadoutState.layout()),
    }
    doc = f"Stiffness from {rows_stage.name} rows by {solver.name} recursive least squares."
    params = Layout(f"{name}_params", doc, {k: Field(v[0]) for k, v in parts.items() if v[0]})
    state = Layout(f"{name}_state", doc, {k: Field(v[1]) for k, v in parts.items() if v[1]})
    kernels = _kernels(rows_stage, solver)
    init_lines = [
        "rows_init(params.rows, state.rows)",
        "solver_init(params.solver, state.solver)",
        "evidence_init(params.evidence, state.evidence)",
        "readout_init(params.readout, state.readout)",
    ]

    def write(signature: str, lines: str) -> Any:
        return write_function(
            signature, name, doc, lines.format(p=p, b=terms).splitlines(), kernels
        )

    kernels["renew"] = write("renew(params, state)", RENEW)
    kernels["tell"] = write("tell(params, state, time, counted, out)", TELL)
    hold = write("hold(params, state, out)", "tell(params, state, 0.0, 0, out)")
    init, step = write_kernels(
        name, doc, init_lines, STEP.format(p=p, b=terms).splitlines(), kernels
    )
    cites = tuple(dict.fromkeys((*rows_stage.cites, *solver.cites)))
    output = readout.Reading.layout(p=p)
    return Stage(name, params, state, rows_stage.input, output, init, step, cites, hold)


def _kernels(rows_stage: Stage, solver: Solver) -> dict[str, Any]:
    import math

    found: dict[str, Any] = {"math": math, "blocks_clear": blocks.clear}
    found |= {"rows_init": rows_stage.init, "rows_step": rows_stage.step}
    for name in ("init", "update", "anchor", "spread", "multiply"):
        found[f"solver_{name}"] = getattr(solver, name)
    judging = ("noise_level", "judge", "coefficient", "anchoring", "verdict_bits")
    for name in ("init", "add", "cut", "due", *judging):
        found[f"evidence_{name}"] = getattr(evidence, name)
    for name in ("init", "read", "deviations", "decide"):
        found[f"readout_{name}"] = getattr(readout, name)
    return found


def guarded(inner: Stage, channels: tuple[str, ...]) -> Stage:
    """Put the guard before a stage: samples are judged, bridged or refused before it sees them.

    The result reads ``inner``'s input without ``fresh``, which the guard supplies; a refused
    sample leaves ``inner`` as it was and repeats its last output with the reason in ``status``.

    Args:
        inner: its input has ``time``, ``fresh`` and the channels; its output ``time``, ``status``.
        channels: the float fields the guard watches and interpolates.
    """
    if inner.hold is None:
        raise StageError(f"{inner.name} cannot hold its output, so it cannot be guarded")
    name = f"{inner.name}_guarded"
    c = len(channels)
    fields = {k: f for k, f in inner.input.fields.items() if k != "fresh"}
    outer = Layout(inner.input.name.removesuffix("_inner"), inner.input.doc, fields)
    doc = f"{inner.name} behind a guard against bad samples."
    params = Layout(
        f"{name}_params",
        doc,
        {"guard": Field(guard.GuardParams.layout(c=c)), "inner": Field(inner.params)},
    )
    state = Layout(
        f"{name}_state",
        doc,
        {
            "guard": Field(guard.GuardState.layout(c=c)),
            "inner": Field(inner.state),
            "sample": Field(inner.input),
        },
    )
    others = [k for k in fields if k not in (*channels, "time")]
    lines = [f"state.guard.now[{i}] = u.{k}" for i, k in enumerate(channels)]
    lines += ["steps = guard_plan(params.guard, state.guard, u.time)", "for k in range(steps):"]
    inside = ["guard_fill(params.guard, state.guard, u.time, k, steps)"]
    inside += [f"state.sample.{k} = state.guard.mix[{i}]" for i, k in enumerate(channels)]
    inside += [f"state.sample.{k} = u.{k}" for k in others]
    inside += [
        "state.sample.time = state.guard.mix_time",
        "state.sample.fresh = 0",
        "if k == 0:",
        "    state.sample.fresh = state.guard.fresh",
        "inner_step(params.inner, state.inner, state.sample, out)",
    ]
    lines += [f"    {line}" for line in inside]
    lines += [
        "if steps > 0:",
        "    guard_finish(params.guard, state.guard, u.time)",
        "else:",
        "    inner_hold(params.inner, state.inner, out)",
        "out.time = u.time",
        "out.status = out.status | state.guard.status",
    ]
    init_lines = [
        "guard_init(params.guard, state.guard)",
        "inner_init(params.inner, state.inner)",
    ]
    kernels = {
        "guard_init": guard.init,
        "guard_plan": guard.plan,
        "guard_fill": guard.fill,
        "guard_finish": guard.finish,
        "inner_init": inner.init,
        "inner_step": inner.step,
        "inner_hold": inner.hold,
    }
    init, step = write_kernels(name, doc, init_lines, lines, kernels)
    return Stage(name, params, state, outer, inner.output, init, step, inner.cites)


def inner_input(sample: type[Record]) -> Layout:
    """A sample as a guarded stage sees it: with ``fresh``."""
    layout = sample.layout()
    fresh = integer("1: the filters must start at this sample")
    return Layout(f"{layout.name}_inner", layout.doc, {**layout.fields, "fresh": fresh})
