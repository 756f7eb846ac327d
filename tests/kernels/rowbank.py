"""Estimators fed with rows that are given, so that noise and truth of every row are known."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.solvers import UD
from rotatum.estimators.stiffness import LEVELS, stiffness_stage
from rotatum.estimators.two_transmissions import pair_stage
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from tests.kernels.make import given_rows

Array = NDArray[np.float64]
PERIOD = 1e-3
SHORTEST = 16


class RowBank:
    """n estimators, the spring's columns last; rows are ``(N, n, columns)`` and ``(N, n)``.

    ``first`` is the first column that is shrunk, None: none is.
    """

    def __init__(
        self,
        joints: int = 1,
        *,
        columns: int = 2,
        terms: int = 1,
        first: int | None = None,
        lag: int = 3,
        **evidence: float | list[float],
    ) -> None:
        self.stage = stiffness_stage(
            given_rows(columns), UD, terms=terms, columns=columns, shrunk=first is not None
        )
        params = self.stage.params.zeros(joints)
        _part(params, lag, evidence)
        if first is not None:
            params["shrink"]["first"] = first
        _sums(params["sums"])
        self.bank = Bank(self.stage, params)
        assert params["sums"]["fade"].shape == (joints, LEVELS)

    def run(
        self,
        R: Array,
        y: Array,
        *,
        D: ArrayLike = (0.0, 1.0),
        suspect: Array | float = 0.0,
        fresh: tuple[int, ...] = (),
    ) -> Records:
        """Readings of every row; ``fresh`` rows start the filters and are not learnt from."""
        u = self.stage.input.zeros(*y.shape)
        u["time"] = np.arange(len(y))[:, None] * PERIOD
        u["valid"], u["y"], u["R"], u["F"] = 1, y, R, R
        u["D"], u["suspect"] = D, suspect
        for k in fresh:
            u["valid"][k], u["fresh"][k] = 0, 1
        return self.bank.run(u)


class PairBank:
    """n pairs of two columns, the spring's last; rows are ``(N, n, 2, 2)`` and ``(N, n, 2)``."""

    def __init__(self, joints: int = 1, **evidence: float | list[float]) -> None:
        self.stage = pair_stage(given_rows(2), UD, terms=1, columns=2)
        params = self.stage.params.zeros(joints)
        for which in ("first", "second"):
            _part(params[which], 3, evidence)
        _sums(params["sums"])
        _readout(params["readout"])
        self.bank = Bank(self.stage, params)

    def input(self, R: Array, y: Array, *, D: ArrayLike = (0.0, 1.0)) -> Records:
        """Input of every row, valid on both sides."""
        u = self.stage.input.zeros(*y.shape[:2])
        u["time"] = np.arange(len(y))[:, None] * PERIOD
        for i, which in enumerate(("first", "second")):
            one = u[which]
            one["time"], one["valid"] = u["time"], 1
            one["y"], one["R"], one["F"], one["D"] = y[:, :, i], R[:, :, i], R[:, :, i], D
        return u

    def run(self, R: Array, y: Array, *, D: ArrayLike = (0.0, 1.0)) -> Records:
        """Readings of every row."""
        return self.bank.run(self.input(R, y, D=D))


def _part(params: Any, lag: int, evidence: dict[str, float | list[float]]) -> None:
    params["solver"]["forgetting"] = params["solver"]["variance"] = 1.0
    params["solver"]["spread"] = params["evidence"]["spread"] = 1e8
    settings = {"forgetting": 1.0, "memory": 1.0, "bias": 0.02, **evidence}
    for name, value in settings.items():
        params["evidence"][name] = value
    params["evidence"]["lag"] = lag
    _readout(params["readout"])


def _sums(sums: Any) -> None:
    sums["shortest"] = SHORTEST
    sums["fade"] = sums["fade_single"] = 1.0


def _readout(readout: Any) -> None:
    readout["period"], readout["hold"], readout["shrink"] = PERIOD, 1.0, 0.01
    readout["starved"], readout["informative"] = 0.5, 0.1
