"""The narrow waist: rows from any method, a solver, and one read-out make a stiffness estimator."""

from __future__ import annotations

from rotatum.estimators.gating import gating
from rotatum.estimators.part import Part, part_of
from rotatum.estimators.solvers import Solver
from rotatum.kernels import blocks, readout
from rotatum.kernels.probes import PROBES
from rotatum.record import Field, Layout
from rotatum.runtime.compose import write_function
from rotatum.runtime.stage import Stage

LEVELS = 20  # of block sums: the longest block is 2^19 times the shortest

SERIES_STEP = """rows_step(params.rows, state.rows, u, state.row)
{gate}if state.row.fresh != 0:
    blocks_clear(state.sums)
    evidence_cut(state.evidence)
if state.row.valid != 0:
    learn(params, state, state.sums, 0, {columns})
    if blocks_count(params.sums, state.sums) != 0:
        probes_fold(params.evidence, state.evidence, state.sums, {columns})
        blocks_close(params.sums, state.sums)
        if evidence_due(state.evidence, state.sums) != 0:
            assess(params, state, state.sums, 0, {columns}, {reading})
{tell}(params, state, u.time, 1, out)"""


def stiffness_stage(
    rows_stage: Stage,
    solver: Solver,
    *,
    terms: int,
    columns: int,
    shrunk: bool = False,
    selective: bool = False,
) -> Stage:
    """Compose rows -> solver -> evidence -> read-out into one stage whose output is ``Reading``.

    A new method is one new rows stage: it turns samples into ``Row`` records and knows no solver.

    Args:
        rows_stage: writes ``Row`` records of ``columns`` regressors.
        solver: ``UD`` or ``COVARIANCE``.
        terms: number of regressors that are the basis, the last ones.
        columns: number of regressors.
        shrunk: whether high orders are shrunk as far as the data do not ask for them (``UD``).
        selective: whether nothing is learnt near a standstill of the link (``kernels.gate``).
    """
    part = part_of(rows_stage, solver, terms, columns, shrunk)
    chosen = gating(selective, part)
    name = f"{part.name}{chosen.ending}"
    params = {**part.params, "sums": sums_params(), **chosen.params}
    state = {**part.state, "sums": sums_state(columns, 1), **chosen.state}
    init = (*(line.replace("{0}", "") for line in part.init), *chosen.init)
    hold = "tell(params, state, 0.0, 0, out)"
    step = SERIES_STEP.format(columns=columns, reading="out", tell="tell", gate=chosen.step)
    output = readout.Reading.layout(p=columns)
    return assembled(
        part,
        name,
        Layout(f"{name}_params", doc_of(part), params),
        Layout(f"{name}_state", doc_of(part), state),
        rows_stage.input,
        output,
        init,
        step,
        hold,
    )


def doc_of(part: Part) -> str:
    """Return what a stage made of a part is."""
    return f"Stiffness by {part.name.replace('_', ' ')}."


def sums_params() -> Field:
    """Return the params of the residuals' block sums."""
    return Field(blocks.BlockParams.layout(L=LEVELS))


def sums_state(columns: int, parts: int) -> Field:
    """Return the block sums of scores and probes.

    Args:
        columns: regressors of a transmission.
        parts: transmissions with a solver of their own.
    """
    v, t = parts * columns, parts * PROBES
    return Field(blocks.BlockState.layout(L=LEVELS, v=v, t=v + t, s=v * (v + 1) // 2 + t))


def assembled(
    part: Part,
    name: str,
    params: Layout,
    state: Layout,
    input: Layout,
    output: Layout,
    init: tuple[str, ...],
    step: str,
    hold: str,
) -> Stage:
    """Return the stage whose functions are written from these lines and the part's kernels."""
    doc, kernels = doc_of(part), part.kernels
    return Stage(
        name,
        params,
        state,
        input,
        output,
        write_function("init(params, state)", name, doc, init, kernels),
        write_function("step(params, state, u, out)", name, doc, step.splitlines(), kernels),
        part.cites,
        write_function("hold(params, state, out)", name, doc, [hold], kernels),
    )
