"""What selective updates add to a stage: a gate between its rows and its solver."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from rotatum.estimators.part import Part
from rotatum.kernels import gate
from rotatum.record import Field

GATE = "gate_step(params.gate, state.gate, {q}, {fresh}, {row})\n"


class Gating(NamedTuple):
    """What selective updates add to a stage; all empty without them."""

    ending: str = ""
    params: Mapping[str, Field] = MappingProxyType({})
    state: Mapping[str, Field] = MappingProxyType({})
    init: tuple[str, ...] = ()
    step: str = ""


def gating(selective: bool, part: Part, where: str = "") -> Gating:
    """Make what a gate before the solver adds; ``where`` the row it holds back is."""
    if not selective:
        return Gating()
    part.kernels["gate_init"], part.kernels["gate_step"] = gate.init, gate.step
    u = f"u{where}"
    return Gating(
        "_selective",
        {"gate": Field(gate.GateParams.layout())},
        {"gate": Field(gate.GateState.layout())},
        ("gate_init(params.gate, state.gate)",),
        GATE.format(q=f"{u}.q", fresh=f"{u}.fresh", row=f"state{where}.row"),
    )
