"""The compiled plant: one stage text for each law, or pair of laws."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from rotatum.models.laws import LAWS
from rotatum.record import Field, Layout
from rotatum.runtime.compose import write_function, write_kernels
from rotatum.runtime.stage import Stage
from rotatum.simulation.plant import dynamics
from rotatum.simulation.plant.dynamics import PlantInput, PlantOutput, PlantParams, PlantState

_STEP = (
    "begin(params, state, u)",
    "elastic(params, state)",
    "balance(params, state, u)",
    "read(params, state, out)",
    "report(state, out)",
    "for i in range(params.substeps):",
    "    if state.diverged == 0:",
    "        for part in range(4):",
    "            approach(params, state, part)",
    "            elastic(params, state)",
    "            balance(params, state, u)",
    "            gather(state, part)",
    "        finish(params, state)",
)


@lru_cache(maxsize=64)
def plant_stage(springs: tuple[tuple[str, int], ...]) -> Stage:
    """Return the stage that moves a joint through one sample.

    Its output is the joint at the sample's instant; then the sample's torques act for one period:
    classical Runge-Kutta with fixed sub-steps (`rotatum.simulation.plant.dynamics`). The text is
    the same for series and serial joints: the set-point of the former stands still.

    Parameters
    ----------
    springs
        Name of the law (of `rotatum.models.laws.LAWS`) and number of packed constants of each
        transmission: one for a series or serial joint, two for an antagonistic one.
    """
    motors = len(springs)
    laws = tuple(law for law, _ in springs)
    name = "_".join(("plant", *laws))
    doc = f"A joint with {motors} transmission{'s' if motors > 1 else ''}: {', '.join(laws)}."
    kernels: dict[str, Any] = {
        k.__name__: k
        for k in (
            dynamics.begin,
            dynamics.balance,
            dynamics.report,
            dynamics.approach,
            dynamics.gather,
            dynamics.finish,
        )
    }
    kernels["elastic"] = _elastic(name, laws)
    kernels["read"] = _read(name, laws)
    kernels["stand"] = dynamics.init
    init, step = write_kernels(name, doc, ["stand(params, state)"], _STEP, kernels)
    sizes = {"M": motors, "J": motors + 2}
    return Stage(
        name=name,
        params=_params(name, doc, springs, sizes),
        state=PlantState.layout(**sizes),
        input=PlantInput.layout(M=motors),
        output=PlantOutput.layout(M=motors),
        init=init,
        step=step,
        cites=("flacco2012",),
    )


def _params(
    name: str, doc: str, springs: tuple[tuple[str, int], ...], sizes: dict[str, int]
) -> Layout:
    fields = dict(PlantParams.layout(**sizes).fields)
    for m, (law, constants) in enumerate(springs):
        fields[f"law{m}"] = Field("float", (constants,), f"packed constants of {law}")
    return Layout(f"{name}_params", doc, fields)


def _elastic(name: str, laws: tuple[str, ...]) -> Any:
    """Write the kernel that asks the laws for torques and the push on the set-point."""
    lines = ["state.push = 0.0"]
    kernels: dict[str, Any] = {}
    for m, law in enumerate(laws):
        at = f"(params.law{m}, state.stretch[{m}], state.setpoint)"
        lines.append(f"state.torque[{m}] = torque{m}{at}")
        kernels[f"torque{m}"] = LAWS[law].torque
        if LAWS[law].uses_setpoint:
            lines.append(f"state.push = state.push + push{m}{at}")
            kernels[f"push{m}"] = LAWS[law].energy_setpoint
    doc = "Torques of the springs where the equations are looked at."
    return write_function("elastic(params, state)", name, doc, lines, kernels)


def _read(name: str, laws: tuple[str, ...]) -> Any:
    """Write the kernel that reads the stiffnesses out."""
    lines = [
        f"out.stiffness[{m}] = stiffness{m}(params.law{m}, state.stretch[{m}], state.setpoint)"
        for m in range(len(laws))
    ]
    kernels = {f"stiffness{m}": LAWS[law].stiffness for m, law in enumerate(laws)}
    doc = "Stiffness of each transmission."
    return write_function("read(params, state, out)", name, doc, lines, kernels)
