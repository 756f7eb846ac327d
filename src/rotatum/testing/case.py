"""A stage with everything needed to try it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rotatum.export.checker import in_stage
from rotatum.export.compiler import CompilerError, compiler
from rotatum.export.shared import CompiledC, build_shared
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage


@dataclass(frozen=True)
class Case:
    """What the clauses of the contract work on.

    Args:
        stage: under test.
        params: ``(n,)`` records, n >= 2.
        inputs: ``(N, n)`` records, good samples.
        seed: of everything random.
        settle: good samples after which a stage must have recovered.
        endurance: samples after which everything must still be finite.
        scale: exponents of a change of unit by dotted field name, or None.
        references: known citation keys, or None.
    """

    stage: Stage
    params: Records
    inputs: Records
    seed: int
    settle: int
    endurance: int
    scale: Mapping[str, float] | None
    references: frozenset[str] | None

    @cached_property
    def c(self) -> CompiledC:
        """The stage's exported C, compiled once."""
        return build_shared(self.stage)

    @cached_property
    def no_c(self) -> str:
        """Why there is no C to compare with; empty if there is."""
        try:
            compiler()
        except CompilerError as error:
            return str(error)
        return "the stage is outside the subset" if in_stage(self.stage) else ""

    @property
    def rng(self) -> np.random.Generator:
        """A fresh generator: what one clause draws does not depend on another."""
        return np.random.default_rng(self.seed)

    def bank(self, *, compile: bool = True) -> Bank:
        """Return a fresh bank of all joints."""
        return Bank(self.stage, self.params, compile=compile)

    def run(self, inputs: Records, *, compile: bool = True) -> tuple[Records, Records]:
        """Return outputs and final state of a fresh bank."""
        bank = self.bank(compile=compile)
        return bank.run(inputs), bank.state

    def run_c(self, inputs: Records) -> tuple[Records, Records]:
        """Return outputs and final state of the exported C."""
        state = self.stage.state.zeros(len(self.params))
        out = self.stage.output.zeros(*inputs.shape)
        self.c.start(self.params, state)
        self.c.run(self.params, state, inputs, out)
        return out, state


def several(params: Records, inputs: Records, joints: int = 3) -> tuple[Records, Records]:
    """Make several joints of one: alike, but each sees another stretch of the input."""
    if inputs.ndim == 1:
        inputs = inputs[:, np.newaxis]
    if len(params) > 1:
        return params, np.ascontiguousarray(inputs)
    shift = len(inputs) // 10
    length = len(inputs) - (joints - 1) * shift
    stretches = [inputs[j * shift : j * shift + length, 0] for j in range(joints)]
    return np.repeat(params, joints), np.ascontiguousarray(np.stack(stretches, axis=1))
