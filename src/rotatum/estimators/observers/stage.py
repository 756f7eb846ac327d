"""Observers as stages, and their parameters from a design."""

from __future__ import annotations

from typing import Any

import numpy as np

from rotatum.errors import MethodError
from rotatum.estimators.observers.figures import SETTLED, settle
from rotatum.estimators.observers.recursion import Recursion
from rotatum.kernels import unknown_input
from rotatum.record import Records
from rotatum.runtime.stage import Stage

CITES = ("sundaram2008", "trumic2022")


def unknown_input_stage(
    n: int, m: int, p: int, L: int, *, memory: int | None = None, window: int | None = None
) -> Stage:
    """Return the stage of an observer: outputs in, states and inputs of a delayed instant out.

    Args:
        n: states estimated.
        m: inputs estimated.
        p: outputs.
        L: delay; the window has L + 1 samples.
        memory: states of the recursion where they are not those estimated; n.
        window: samples in the window where it is longer than L + 1.
    """
    length = L + 1 if window is None else window
    inner = n if memory is None else memory
    c = length * p
    return Stage(
        f"unknown_input_{n}_{m}_{p}_{length}_{inner}",
        unknown_input.UnknownInputParams.layout(n=inner, c=c, o=n + m, p=p),
        unknown_input.UnknownInputState.layout(n=inner, c=c, o=n + m),
        unknown_input.OutputSample.layout(p=p),
        unknown_input.UnknownInputEstimate.layout(s=n, m=m),
        unknown_input.init,
        unknown_input.step,
        cites=CITES,
    )


def observer_stage(recursion: Recursion, inputs: int) -> Stage:
    """Return the stage a recursion runs in.

    Args:
        recursion: with ``out = (states, inputs)``.
        inputs: how many of ``out`` are inputs.
    """
    o = len(recursion.G)
    return unknown_input_stage(
        o - inputs, inputs, recursion.channels, recursion.lag,
        memory=len(recursion.E), window=recursion.window,
    )  # fmt: skip


def observer_params(
    stage: Stage, recursion: Recursion, joints: int = 1, share: float = SETTLED
) -> Records:
    """Return (joints,) params of a stage for a design.

    Args:
        stage: from `unknown_input_stage` or `observer_stage`.
        recursion: a design of its sizes.
        joints: how many records, all alike.
        share: of the start's error that may be left where ``settled`` is raised.

    Raises:
        MethodError: the design does not fit the stage.
    """
    params = stage.params.zeros(joints)
    for record in params:
        fill_observer(record, recursion, stage.name, share)
    return params


def fill_observer(record: Any, recursion: Recursion, name: str, share: float = SETTLED) -> None:
    """Fill ``UnknownInputParams``, which may have room for a longer window.

    Args:
        record: to fill.
        recursion: a design of its sizes.
        name: of the stage, for messages.
        share: of the start's error that may be left where ``settled`` is raised.

    Raises:
        MethodError: the design does not fit.
    """
    first = record["F"].shape[1] - recursion.F.shape[1]
    fields = {"E": record["E"], "F": record["F"], "G": record["G"], "K": record["K"].T}
    for which, field in fields.items():
        value, room = getattr(recursion, which), first if which in "FK" else 0
        if room < 0 or field.shape != (len(value), value.shape[1] + room):
            raise MethodError(f"the design does not fit the stage {name}", where=which,
                              value=value.shape, allowed=str(field.shape))  # fmt: skip
        field[:, room:] = value
    record["rest"] = recursion.rest()
    driven = np.flatnonzero(np.any(recursion.F != 0.0, axis=0))
    record["first"] = first
    record["driven"] = first + (driven[-1] + 1 if len(driven) else 0)
    record["settle"] = settle(recursion, share)
