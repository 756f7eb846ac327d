"""The whole estimator of a joint: guard, rows, solver, evidence, read-out."""

from __future__ import annotations

from functools import lru_cache

from rotatum.estimators.guarded import guarded, linked
from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.shapes import Shape, roles, sample_layout, wires_of
from rotatum.estimators.solvers import SOLVERS
from rotatum.estimators.stiffness import stiffness_stage
from rotatum.estimators.two_transmissions import pair_stage, together_stage
from rotatum.runtime.stage import Stage


@lru_cache(maxsize=64)
def joint_stage(shape: Shape) -> Stage:
    """Make the stage of a shape; of an arm's joint without a guard, which the arm has."""
    make = stiffness_stage
    if shape.actuation == "antagonistic":
        make = together_stage if shape.together else pair_stage
    inner = make(
        rows_stage(shape),
        SOLVERS[shape.solver],
        terms=shape.terms,
        columns=shape.columns,
        shrunk=shape.shrunk,
        selective=shape.selective,
    )
    if shape.arm:
        return linked(inner)
    outer = sample_layout(shape.actuation, shape.torque, shape.side)
    channels = roles(shape.actuation, shape.torque, shape.side)
    return guarded(inner, outer, channels, wires_of(shape.actuation, shape.torque, shape.side))
