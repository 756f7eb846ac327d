"""A stage: a pair of in-place kernels with the layouts of what they read and write."""

from __future__ import annotations

from typing import NamedTuple

from rotatum.record import Hold, Init, Layout, Step


class Stage(NamedTuple):
    """One causal recursion: a filter, an observer, a solver, or a whole estimator.

    ``init(params, state)`` turns a zeroed state into the initial one;
    ``step(params, state, u, out)`` takes one sample of one joint. Both work in place on single
    records, in the exportable subset, allocate nothing and never raise.

    Args:
        name: a Python identifier; names the C functions too.
        params: constants of one joint.
        state: all memory of one joint. A copy of it is a checkpoint.
        input: one sample of one joint.
        output: what a step writes.
        init, step: the kernels.
        cites: keys of ``rotatum.report.references``.
        hold: writes the last output again, without a sample; a stage behind a guard needs it.
    """

    name: str
    params: Layout
    state: Layout
    input: Layout
    output: Layout
    init: Init
    step: Step
    cites: tuple[str, ...] = ()
    hold: Hold | None = None
