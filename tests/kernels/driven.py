"""Rows of a method driven sample by sample, interpreted, from parameters set by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.operators import EXPONENTIAL, WINDOW, Operator
from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.shapes import Shape, ring_size
from rotatum.record import Records
from rotatum.runtime.stage import Stage
from tests.kernels.make import copy_out, plain

Array = NDArray[np.float64]
T = 1e-3


def problem(
    powers: list[int],
    kinds: tuple[int, ...] | list[int] = (),
    *,
    cutoff: float = 300.0,
    order: int = 2,
    window: Operator | None = None,
    scale: float = 0.01,
    period: float = T,
    settle: int = 0,
    torque: str = "estimated",
    side: str = "motor",
    actuation: str = "series",
    **settings: Any,
) -> tuple[Stage, Any]:
    """Rows stage and parameters: fitted columns ``kinds``, then powers of the deflection.

    Two poles at ``cutoff`` unless a ``window`` is given. ``settings`` are of the balance's terms.
    """
    pair = side == "link" and actuation == "antagonistic"
    b = len(powers) * (2 if pair else 1)
    shape = Shape(
        "weak",
        torque,
        b,
        b + len(kinds),
        max(powers),
        actuation=actuation,
        side=side,
        operator=EXPONENTIAL if window is None else WINDOW,
        size=0 if window is None else ring_size(window.length),
    )
    stage = rows_stage(shape)
    P = stage.params.zeros(1)[0]
    P["basis"]["scale"], P["basis"]["half"], P["basis"]["power"] = scale, 1.0, powers
    own = P["link" if side == "link" else "weak"]
    own["period"], own["kind"], own["scale"] = period, list(kinds) + [0] * b, 1.0
    for name, value in settings.items():
        own[name] = value
    if window is None:
        P["operator"]["pole"] = math.exp(-cutoff * period)
        P["operator"]["order"], P["operator"]["settle"] = order, settle
    else:
        P["operator"]["weight"][: window.length] = window.weights()[::-1]
        P["operator"]["length"], P["operator"]["stride"] = window.length, window.every
    return stage, P


def drive(stage: Stage, params: Any, **channels: ArrayLike) -> Records:
    """Outputs (N,) of a stage; a channel is ``(N, ...)``, or one value for all samples."""
    values = {name: np.asarray(v) for name, v in channels.items()}
    n = max(len(v) for v in values.values() if v.ndim)
    lists = {name: v.tolist() if v.ndim else [v.item()] * n for name, v in values.items()}
    out = stage.output.zeros(n)
    P, S = plain(params), plain(stage.state.zeros(1)[0])
    u, row = plain(stage.input.zeros(1)[0]), plain(out[0])
    stage.init(P, S)
    for k in range(n):
        for name, series in lists.items():
            setattr(u, name, series[k])
        stage.step(P, S, u, row)
        copy_out(row, out[k])
    return out


def starts(n: int, at: tuple[int, ...] = (0,)) -> NDArray[np.int64]:
    """``fresh`` of n samples: 1 where the filters must start."""
    fresh = np.zeros(n, np.int64)
    fresh[list(at)] = 1
    return fresh


def run(
    stage: Stage,
    params: Any,
    q: Array,
    theta: Array,
    tau: Array,
    *,
    setpoint: ArrayLike = 0.0,
    fresh: tuple[int, ...] = (0,),
    enable: int = 1,
) -> Records:
    """All rows of the motor side."""
    return drive(
        stage,
        params,
        q=q,
        theta=theta,
        torque=tau,
        setpoint=setpoint,
        enable=enable,
        fresh=starts(len(q), fresh),
    )
