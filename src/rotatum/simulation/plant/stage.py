"""The compiled plant: one stage text for each law, or pair of laws."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from rotatum.models.laws import LAWS
from rotatum.record import Field, Layout
from rotatum.runtime.compose import write_function, write_kernels
from rotatum.runtime.stage import Stage
from rotatum.simulation.plant import dynamics, springs
from rotatum.simulation.plant.records import PlantInput, PlantOutput, PlantParams, PlantState

__all__ = ["plant_stage", "train_stage"]

_STEP = (
    "begin(params, state, u)",
    "elastic(params, state)",
    "balance(params, state, u)",
    "read(params, state, out)",
    "report(params, state, out)",
    "for i in range(params.substeps):",
    "    if state.diverged == 0:",
    "        for part in range(4):",
    "            if i + part > 0:",
    "                approach(params, state, u, i, part)",
    "                elastic(params, state)",
    "                balance(params, state, u)",
    "            gather(params, state, part)",
    "        finish(params, state)",
)


_TRAIN = (
    "drift(state, u, u.share)",
    "deform(params, state)",
    "elastic(params, state)",
    "balance(params, state, u)",
    "hysteresis_rate(params, state)",
    "read(params, state, out)",
    "report(params, state, out)",
)


@lru_cache(maxsize=64)
def plant_stage(laws: tuple[tuple[str, int], ...]) -> Stage:
    """Return the stage that moves a joint through one sample.

    Its output is the joint at the sample's instant; then the sample's torques act for one period:
    classical Runge-Kutta with fixed sub-steps (`rotatum.simulation.plant.dynamics`). The text is
    the same for series and serial joints: the set-point of the former stands still.

    Parameters
    ----------
    laws
        Name of the law (of `rotatum.models.laws.LAWS`) and number of packed constants of each
        transmission: one for a series or serial joint, two for an antagonistic one.
    """
    steps = (dynamics.begin, dynamics.approach, dynamics.gather, dynamics.finish)
    kernels: dict[str, Any] = {k.__name__: k for k in steps}
    return _stage("plant", "A joint", laws, _STEP, kernels)


@lru_cache(maxsize=64)
def train_stage(laws: tuple[tuple[str, int], ...]) -> Stage:
    """Return the stage that looks at a joint's equations once, for an integrator of its own.

    Set `trial_position`, `trial_velocity` (bodies: link, motors, set-point motor) and
    `trial_hysteresis` of its state, and `share`, the share of the period gone, of its input. A
    step leaves `acceleration` and `hysteresis_rate` in the state, and puts the `trial_velocity` of
    a set-point motor without inertia right; what the joint does there is its output. With a link
    inertia of 1 and without gravity ``acceleration[0]`` is the net torque on the link: external
    torque less springs and friction. A prescribed set-point is where `trial_position` says.

    Parameters
    ----------
    laws
        As for `plant_stage`.
    """
    kernels: dict[str, Any] = {
        k.__name__: k for k in (springs.drift, springs.deform, springs.hysteresis_rate)
    }
    return _stage("train", "A drive train", laws, _TRAIN, kernels)


def _stage(
    kind: str,
    doc: str,
    constants: tuple[tuple[str, int], ...],
    lines: tuple[str, ...],
    kernels: dict[str, Any],
) -> Stage:
    motors = len(constants)
    laws = tuple(law for law, _ in constants)
    name = "_".join((kind, *laws))
    doc = f"{doc} with {motors} transmission{'s' if motors > 1 else ''}: {', '.join(laws)}."
    kernels |= {
        "balance": dynamics.balance,
        "report": dynamics.report,
        "elastic": _elastic(name, laws),
        "read": _read(name, laws),
        "stand": dynamics.init,
    }
    init, step = write_kernels(name, doc, ["stand(params, state)"], lines, kernels)
    sizes = {"M": motors, "J": motors + 2}
    return Stage(
        name=name,
        params=_params(name, doc, constants, sizes),
        state=PlantState.layout(**sizes),
        input=PlantInput.layout(M=motors),
        output=PlantOutput.layout(M=motors),
        init=init,
        step=step,
        cites=("flacco2012",),
    )


def _params(
    name: str, doc: str, laws: tuple[tuple[str, int], ...], sizes: dict[str, int]
) -> Layout:
    fields = dict(PlantParams.layout(**sizes).fields)
    for m, (law, constants) in enumerate(laws):
        fields[f"law{m}"] = Field("float", (constants,), f"packed constants of {law}")
    return Layout(f"{name}_params", doc, fields)


def _elastic(name: str, laws: tuple[str, ...]) -> Any:
    """Write the kernel that asks the laws for torques and the push on the set-point."""
    lines = ["state.push = 0.0"]
    kernels: dict[str, Any] = {}
    for m, law in enumerate(laws):
        at = f"(params.law{m}, state.stretch[{m}], state.setpoint)"
        lines.append(f"state.torque[{m}] = state.scale * torque{m}{at}")
        kernels[f"torque{m}"] = LAWS[law].torque
        if LAWS[law].uses_setpoint:
            lines.append(f"state.push = state.push + state.scale * push{m}{at}")
            kernels[f"push{m}"] = LAWS[law].energy_setpoint
    doc = "Torques of the springs where the equations are looked at."
    return write_function("elastic(params, state)", name, doc, lines, kernels)


def _read(name: str, laws: tuple[str, ...]) -> Any:
    """Write the kernel that reads the stiffnesses out."""
    lines = []
    for m in range(len(laws)):
        at = f"(params.law{m}, state.stretch[{m}], state.setpoint)"
        lines.append(f"out.stiffness[{m}] = state.contact[{m}] * state.scale * stiffness{m}{at}")
    kernels = {f"stiffness{m}": LAWS[law].stiffness for m, law in enumerate(laws)}
    doc = "Stiffness of each transmission."
    return write_function("read(params, state, out)", name, doc, lines, kernels)
