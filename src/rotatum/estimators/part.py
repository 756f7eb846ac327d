"""One transmission: its records, and the kernels that learn, assess and tell from its rows."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rotatum.estimators.solvers import Solver
from rotatum.kernels import blocks, evidence, probes, readout, rows, shrink, udrls
from rotatum.kernels.status import PRIOR
from rotatum.record import Field
from rotatum.runtime.compose import write_function
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage

# What one transmission does; its scores lie in the sums from `at` on, its probes from `probes` on.

LEARN = """solver_update(params.solver, state.solver, state.row.R, state.row.y)
evidence_add(
    params.evidence, state.evidence, sums, state.row, state.solver, {terms}, at, probes
)
{apply}"""

ASSESS = """evidence_noise_level(state.evidence)
{weigh}readout_read(state.row, {alpha}, out)
{multiply}state.row.D, state.evidence.direction)
evidence_judge(params.evidence, state.evidence, sums, {alpha}, state.row.D, at, probes)
for i in range({columns}):
    state.evidence.unit[i] = 0.0
state.evidence.unit[state.evidence.turn] = 1.0
{renew}deviate(params, state, out)
half = 1.96 * out.stiffness_std
probes_verdict_bits(
    params.evidence, state.evidence, half / (math.fabs(out.stiffness) + 1e-300)
)"""

RENEW = """{multiply}state.evidence.unit, state.evidence.column)
evidence_coefficient(
    params.evidence, state.evidence, sums, {alpha}, state.evidence.turn, at, {bias2}
)
state.evidence.turn = state.evidence.turn + 1
if state.evidence.turn >= {columns}:
    state.evidence.turn = 0
level = evidence_anchoring(state.evidence)
if level > 0.0:
    for i in range({columns}):
        if params.evidence.known[i] > 0.0:
            solver_anchor(state.solver, i, 0.0, params.evidence.known[i] / level)
{anchored}"""

DEVIATE = """sigma_spread = {spread}state.row.D, {first})
sigma_bias2 = {bias2}
unshrunk = {unshrunk}
torque_spread = {spread}state.row.F, {first})
readout_deviations(
    params.readout, state.readout, state.evidence, sigma_spread, sigma_bias2, torque_spread,
    {bias2}, out
)
return readout_status_of(
    params.readout, state.evidence, params.evidence, state.row, unshrunk, out
)"""

TELL = """readout_read(state.row, {alpha}, out)
status = deviate(params, state, out)
wrong = state.evidence.wrong
if status & {PRIOR} == 0:
    wrong = wrong | evidence_negative(out.stiffness, out.stiffness_std)
readout_decide(params.readout, state.readout, status, wrong, time, counted, out)
out.time = time
out.rows = state.solver.count"""


# Whose coefficients are read out, and with which deviations.

PLAIN = {
    "alpha": "state.solver.alpha",
    "multiply": "solver_multiply(state.solver, ",
    "spread": "solver_spread(state.solver, ",
    "bias2": "0.0",
    "unshrunk": "sigma_spread",
    "apply": "",
    "anchored": "",
    "weigh": "",
}
SHRUNK = {
    "alpha": "state.shrink.alpha",
    "multiply": "shrink_multiply(state.shrink, state.solver, ",
    "spread": "shrink_spread(state.shrink, state.solver, ",
    "bias2": "state.shrink.bias2",
    "unshrunk": "state.shrink.unshrunk",
    "apply": "shrink_apply(state.shrink, state.solver)",
    "anchored": "    shrink_apply(state.shrink, state.solver)\n",
    "weigh": "shrink_weigh(\n    params.shrink, state.shrink, state.solver, "
    "state.evidence.variance, sums, at\n)\n",
}


class Part(NamedTuple):
    """One transmission: its records, and the kernels that work on them.

    Args:
        name: short name of what it is made of.
        params, state: its records' fields.
        kernels: name to function, ``learn``, ``assess`` and ``tell`` among them.
        init: lines that initialise it; ``{0}`` stands for where its records are.
        columns: regressors.
        terms: of the basis.
        cites: what it comes from.
    """

    name: str
    params: dict[str, Field]
    state: dict[str, Field]
    kernels: dict[str, Any]
    init: tuple[str, ...]
    columns: int
    terms: int
    cites: tuple[str, ...]


def part_of(rows_stage: Stage, solver: Solver, terms: int, columns: int, shrunk: bool) -> Part:
    """Make the part of a method's rows and a solver.

    Raises:
        StageError: the solver's factor cannot be shrunk.
    """
    if shrunk and not solver.nested:
        raise StageError(f"solver {solver.name} does not hold its lower orders, as shrinking needs")
    name = f"{rows_stage.name}_{solver.name}{'_shrunk' if shrunk else ''}"
    p = columns
    params = {
        "rows": Field(rows_stage.params),
        "solver": Field(udrls.SolverParams.layout(p=p)),
        "evidence": Field(evidence.EvidenceParams.layout(p=p)),
        "readout": Field(readout.ReadoutParams.layout()),
    }
    state = {
        "rows": Field(rows_stage.state),
        "row": Field(rows.Row.layout(p=p)),
        "solver": Field(solver.state.layout(p=p)),
        "evidence": Field(evidence.EvidenceState.layout(p=p)),
        "readout": Field(readout.ReadoutState.layout()),
    }
    init = [f"{k}_init(params{{0}}.{k}, state{{0}}.{k})" for k in params]
    if shrunk:
        params["shrink"] = Field(shrink.ShrinkParams.layout())
        state["shrink"] = Field(shrink.ShrinkState.layout(p=p))
        init.append("shrink_init(params{0}.shrink, state{0}.shrink)")
        init.append("shrink_apply(state{0}.shrink, state{0}.solver)")
    cites = tuple(dict.fromkeys((*rows_stage.cites, *solver.cites)))
    kernels = _kernels(rows_stage, solver)
    _write(kernels, name, terms, columns, shrunk)
    return Part(name, params, state, kernels, tuple(init), columns, terms, cites)


def _write(kernels: dict[str, Any], name: str, terms: int, columns: int, shrunk: bool) -> None:
    """Write the composed kernels of a part into ``kernels``; later ones call earlier ones."""
    words: dict[str, Any] = {"terms": terms, "columns": columns, "PRIOR": PRIOR}
    words["first"] = columns - terms
    words |= SHRUNK if shrunk else PLAIN
    words["renew"] = RENEW.format(**words)
    for signature, text in (
        ("learn(params, state, sums, at, probes)", LEARN),
        ("deviate(params, state, out)", DEVIATE),
        ("assess(params, state, sums, at, probes, out)", ASSESS),
        ("tell(params, state, time, counted, out)", TELL),
    ):
        lines = text.format(**words).splitlines()
        doc = f"Kernels of {name}."
        kernels[signature.partition("(")[0]] = write_function(signature, name, doc, lines, kernels)


def _kernels(rows_stage: Stage, solver: Solver) -> dict[str, Any]:
    found: dict[str, Any] = {"math": math}
    found |= {"rows_init": rows_stage.init, "rows_step": rows_stage.step}
    for name in ("init", "update", "anchor", "spread", "multiply"):
        found[f"solver_{name}"] = getattr(solver, name)
    for name in ("clear", "count", "close"):
        found[f"blocks_{name}"] = getattr(blocks, name)
    judging = ("noise_level", "judge", "coefficient", "anchoring", "negative")
    for name in ("init", "add", "cut", "due", *judging):
        found[f"evidence_{name}"] = getattr(evidence, name)
    for name in ("fold", "verdict_bits"):
        found[f"probes_{name}"] = getattr(probes, name)
    for name in ("init", "read", "deviations", "status_of", "decide"):
        found[f"readout_{name}"] = getattr(readout, name)
    for name in ("init", "apply", "weigh", "spread", "multiply"):
        found[f"shrink_{name}"] = getattr(shrink, name)
    return found
