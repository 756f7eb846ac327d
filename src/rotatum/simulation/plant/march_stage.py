"""The drive train of an arm's joint, with its part of each integration step."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from rotatum.record import Field, Layout
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.stage import Stage
from rotatum.simulation.plant import explicit
from rotatum.simulation.plant.explicit import BACK, END, TAKE, MarchInput, MarchParams, MarchState
from rotatum.simulation.plant.stage import train_stage

__all__ = ["march_stage"]

_INIT = (
    "train_init(params.train, state.train)",
    "start(params.march, state.march, state.train)",
)
_STEP = (
    "if u.march.part > 0:",
    f"    if u.march.part <= {TAKE}:",
    "        remember(state.march, state.train, u.march)",
    f"if u.march.part <= {END}:",
    "    place(params.march, state.march, state.train, u.march)",
    "    train_step(params.train, state.train, u.train, out)",
    f"if u.march.part == {TAKE}:",
    "    take(params.march, state.march, state.train, u.march)",
    f"if u.march.part == {BACK}:",
    "    back(state.march)",
)


@lru_cache(maxsize=64)
def march_stage(laws: tuple[tuple[str, int], ...]) -> Stage:
    """Return the stage of `rotatum.simulation.plant.explicit`'s parts around a drive train.

    Parameters
    ----------
    laws
        As for `train_stage`.
    """
    train = train_stage(laws)
    motors = len(laws)
    size = 2 * (motors + 2) + motors
    name = f"march_{train.name}"
    doc = f"{train.params.doc} With its part of each integration step."

    def layout(kind: str, of_train: Layout, of_march: Layout) -> Layout:
        fields = {"train": Field(of_train), "march": Field(of_march)}
        return Layout(f"{name}_{kind}", doc, fields)

    kernels: dict[str, Any] = {
        k.__name__: k
        for k in (explicit.start, explicit.remember, explicit.place, explicit.take, explicit.back)
    }
    kernels |= {"train_init": train.init, "train_step": train.step}
    init, step = write_kernels(name, doc, _INIT, _STEP, kernels)
    return Stage(
        name=name,
        params=layout("params", train.params, MarchParams.layout()),
        state=layout("state", train.state, MarchState.layout(N=size)),
        input=layout("input", train.input, MarchInput.layout()),
        output=train.output,
        init=init,
        step=step,
        cites=train.cites,
    )
