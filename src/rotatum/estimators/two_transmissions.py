"""Stiffness of two transmissions to one link: each from its own rows, or both from shared ones."""

from __future__ import annotations

from typing import Any

from rotatum.estimators.gating import Gating, gating
from rotatum.estimators.part import PLAIN, SHRUNK, Part, part_of
from rotatum.estimators.solvers import Solver
from rotatum.estimators.stiffness import SERIES_STEP, assembled, doc_of, sums_params, sums_state
from rotatum.kernels import both, pair, readout
from rotatum.kernels.probes import PROBES
from rotatum.record import Field, Layout, number, vector
from rotatum.runtime.compose import write_function
from rotatum.runtime.stage import Stage

PAIR_STEP = """rows_step(params.first.rows, state.first.rows, u.first, state.first.row)
rows_step(params.second.rows, state.second.rows, u.second, state.second.row)
{gate}pair_together(state.first.row, state.second.row)
if state.first.row.fresh != 0:
    blocks_clear(state.sums)
    evidence_cut(state.first.evidence)
    evidence_cut(state.second.evidence)
if state.first.row.valid != 0:
    learn(params.first, state.first, state.sums, 0, {v})
    learn(params.second, state.second, state.sums, {columns}, {v} + {probes})
    if blocks_count(params.sums, state.sums) != 0:
        probes_fold(params.first.evidence, state.first.evidence, state.sums, {v})
        probes_fold(
            params.second.evidence, state.second.evidence, state.sums, {v} + {probes}
        )
        blocks_close(params.sums, state.sums)
        if evidence_due(state.first.evidence, state.sums) != 0:
            state.second.evidence.evaluated = state.first.evidence.evaluated
            assess(params.first, state.first, state.sums, 0, {v}, state.first.reading)
            assess(
                params.second, state.second, state.sums, {columns}, {v} + {probes},
                state.second.reading
            )
            pair_relate(state.pair, state.sums, state.first.evidence, state.second.evidence)
tell_pair(params, state, u.time, 1, out)"""
TELL_PAIR = """tell(params.first, state.first, time, counted, state.first.reading)
tell(params.second, state.second, time, counted, state.second.reading)
pair_read(state.pair, state.first, state.second, out)
pair_tell(
    params.readout, state.readout, state.pair, state.first, state.second, time, counted, out
)
out.time = time"""

TELL_BOTH = """tell(params, state, time, counted, state.reading)
both_read(state.reading, state.row, out)
for i in range(2):
    both_mask(state.row, {terms}, i, state.mask)
    part_spread = {spread}state.mask, {first})
    both_part(
        params.readout, state.evidence, state.reading, state.row, part_spread, {bias2}, {terms},
        i, out
    )
both_relate(params.readout, out)
out.time = time"""


def pair_stage(
    rows_stage: Stage,
    solver: Solver,
    *,
    terms: int,
    columns: int,
    shrunk: bool = False,
    selective: bool = False,
) -> Stage:
    """Compose two transmissions of one link into one stage whose output is ``PairReading``.

    Each transmission has its own rows and solver (flacco2012 section 3.2); residuals' blocks are
    shared, because what the two errors have in common decides the deviation of their sum.

    Args:
        rows_stage, solver, terms, columns, shrunk: as in ``stiffness_stage``, of each transmission.
        selective: as there, of both.
    """
    part = part_of(rows_stage, solver, terms, columns, shrunk)
    chosen = gating(selective, part, ".first")
    name, v = f"pair_{part.name}{chosen.ending}", 2 * columns
    params, state = _pair_records(part, name, columns, chosen)
    sample = Layout(
        "pair_sample",
        "One sample of both transmissions.",
        {
            "time": number("of the sample", unit="s", symbol="t"),
            "first": Field(rows_stage.input),
            "second": Field(rows_stage.input),
        },
    )
    init = tuple(
        line.replace("{0}", which) for which in (".first", ".second") for line in part.init
    )
    init += ("readout_init(params.readout, state.readout)", *chosen.init)
    step = PAIR_STEP.format(columns=columns, v=v, probes=PROBES, gate=chosen.step)
    output = pair.PairReading.layout(v=v)
    kernels = part.kernels
    for kernel in ("together", "relate", "read", "tell"):
        kernels[f"pair_{kernel}"] = getattr(pair, kernel)
    kernels["tell_pair"] = write_function(
        "tell_pair(params, state, time, counted, out)",
        name,
        doc_of(part),
        TELL_PAIR.splitlines(),
        kernels,
    )
    hold = "tell_pair(params, state, 0.0, 0, out)"
    return assembled(part, name, params, state, sample, output, init, step, hold)


def together_stage(
    rows_stage: Stage,
    solver: Solver,
    *,
    terms: int,
    columns: int,
    shrunk: bool = False,
    selective: bool = False,
) -> Stage:
    """Compose two transmissions that share their rows into a stage whose output is ``PairReading``.

    Seen from the link only the sum of both torques shows; each is told apart by its deflection.

    Args:
        rows_stage, solver, columns, shrunk, selective: as in ``stiffness_stage``.
        terms: of both bases, in turns, agonist first.
    """
    part = part_of(rows_stage, solver, terms, columns, shrunk)
    chosen = gating(selective, part)
    name = f"both_{part.name}{chosen.ending}"
    words: dict[str, Any] = {"terms": terms, "first": columns - terms}
    words |= SHRUNK if shrunk else PLAIN
    own = {**part.params, "sums": sums_params(), **chosen.params}
    params = Layout(f"{name}_params", doc_of(part), own)
    state = Layout(
        f"{name}_state",
        doc_of(part),
        {
            **part.state,
            "sums": sums_state(columns, 1),
            "reading": Field(readout.Reading.layout(p=columns)),
            "mask": vector(columns, "scratch: the read-out of one transmission"),
            **chosen.state,
        },
    )
    init = (*(line.replace("{0}", "") for line in part.init), *chosen.init)
    for kernel in ("read", "mask", "part", "relate"):
        part.kernels[f"both_{kernel}"] = getattr(both, kernel)
    part.kernels["tell_both"] = write_function(
        "tell_both(params, state, time, counted, out)",
        name,
        doc_of(part),
        TELL_BOTH.format(**words).splitlines(),
        part.kernels,
    )
    output = pair.PairReading.layout(v=2 * columns - terms)
    hold = "tell_both(params, state, 0.0, 0, out)"
    step = SERIES_STEP.format(
        columns=columns, reading="state.reading", tell="tell_both", gate=chosen.step
    )
    return assembled(part, name, params, state, rows_stage.input, output, init, step, hold)


def _pair_records(part: Part, name: str, columns: int, chosen: Gating) -> tuple[Layout, Layout]:
    """Parameters and state of a pair: both transmissions, and what they share."""
    one = Layout(f"{part.name}_part_params", doc_of(part), part.params)
    reading = Field(readout.Reading.layout(p=columns))
    memory = {**part.state, "reading": reading}
    mine = Layout(f"{part.name}_part_state", doc_of(part), memory)
    params = Layout(
        f"{name}_params",
        doc_of(part),
        {
            "first": Field(one),
            "second": Field(one),
            "sums": sums_params(),
            "readout": Field(readout.ReadoutParams.layout()),
            **chosen.params,
        },
    )
    state = Layout(
        f"{name}_state",
        doc_of(part),
        {
            "first": Field(mine),
            "second": Field(mine),
            "sums": sums_state(columns, 2),
            "pair": Field(pair.PairState.layout()),
            "readout": Field(readout.ReadoutState.layout()),
            **chosen.state,
        },
    )
    return params, state
