"""The one object with mutable state: n joints of one stage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rotatum.record import Layout, Records
from rotatum.runtime import jit
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage


class Bank:
    """n joints of one stage, in step.

    ``update`` takes one sample of every joint, ``run`` a batch; both are the same compiled step
    in a loop. ``state`` is an ``(n,)`` array of records: ``bank.state.copy()`` is a snapshot,
    ``bank.state[:] = snapshot`` restores it.

    Args:
        stage: what runs.
        params: ``(n,)`` records of ``stage.params``; copied.
        compile: ``None`` follows ``ROTATUM_JIT``; ``False`` runs the kernels interpreted.

    Raises:
        StageError: the params are not a one-dimensional array of the stage's params record.
    """

    def __init__(self, stage: Stage, params: Records, *, compile: bool | None = None) -> None:
        if params.ndim != 1 or len(params) < 1:
            raise StageError(f"params of {stage.name} must be an (n,) array of records, n >= 1")
        if params.dtype != stage.params.dtype:
            raise StageError(
                f"params of {stage.name} are not its params record",
                value=params.dtype.names,
                allowed=list(stage.params.fields),
            )
        self.stage = stage
        self.params = np.ascontiguousarray(params).copy()
        self.state = stage.state.zeros(len(params))
        use = jit.enabled() if compile is None else compile
        self._loops = jit.compiled(stage) if use else jit.interpreted(stage)
        self.reset()

    def __len__(self) -> int:
        """Return the number of joints."""
        return len(self.state)

    def __repr__(self) -> str:
        """Name, number of joints, size."""
        return f"Bank({self.stage.name}, {len(self)} joints, {self.state.nbytes} bytes of state)"

    def reset(self, joints: Sequence[int] | None = None) -> None:
        """Put all joints, or those given, into their initial state.

        Args:
            joints: indices (negative ones count from the end) or a mask; ``None``: all.

        Raises:
            IndexError: there is no such joint; none is touched then.
        """
        every = np.arange(len(self))
        # Looked up before anything is touched: an index that is not there changes nothing.
        index = every if joints is None else every[list(joints)]
        for j in index:
            fresh = self.stage.state.zeros(1)
            self._loops.start(self.params[j : j + 1], fresh)
            self.state[j] = fresh[0]

    def update(self, u: Records, out: Records | None = None) -> Records:
        """One sample of each joint: ``u`` is ``(n,)`` input records; returns ``(n,)`` outputs.

        With ``out`` given nothing is allocated.
        """
        if out is None:
            out = self.stage.output.zeros(len(self))
        if u.shape != self.state.shape or out.shape != self.state.shape:
            raise self._misfit("update", u, out, (len(self),))
        try:
            self._loops.run(self.params, self.state, u, out)
        except (TypeError, AttributeError) as error:
            raise self._misfit("update", u, out, (len(self),)) from error
        return out

    def run(self, u: Records, out: Records | None = None) -> Records:
        """A batch: ``u`` is ``(N, n)`` input records, C-contiguous; returns ``(N, n)`` outputs."""
        if out is None:
            out = self.stage.output.zeros(*u.shape)
        contiguous = u.flags.c_contiguous and out.flags.c_contiguous
        if u.ndim != 2 or u.shape[1:] != self.state.shape or out.shape != u.shape or not contiguous:
            raise self._misfit("run", u, out, ("N", len(self)))
        try:
            self._loops.run(self.params, self.state, u.reshape(-1), out.reshape(-1))
        except (TypeError, AttributeError) as error:
            raise self._misfit("run", u, out, ("N", len(self))) from error
        return out

    def _misfit(
        self, verb: str, u: Records, out: Records, shape: tuple[int | str, ...]
    ) -> StageError:
        def wrong(array: Records, layout: Layout) -> str:
            if array.dtype != layout.dtype:
                return f"is not an array of {layout.name} records"
            return f"has shape {array.shape}"

        return StageError(
            f"{self.stage.name}.{verb}: input {wrong(u, self.stage.input)}, output "
            f"{wrong(out, self.stage.output)}; both must be C-contiguous of shape {shape}"
        )
