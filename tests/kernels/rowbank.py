"""Estimators fed with rows that are given, so that noise and truth of every row are known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.stiffness import LEVELS, UD, stiffness_stage
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from tests.kernels.make import given_rows

Array = NDArray[np.float64]
PERIOD = 1e-3
SHORTEST = 16


class RowBank:
    """n estimators of two columns; rows are ``(N, n, 2)`` and ``(N, n)``."""

    def __init__(
        self, joints: int = 1, *, terms: int = 1, lag: int = 3, **evidence: float | list[float]
    ) -> None:
        self.stage = stiffness_stage(given_rows(2), UD, terms=terms, columns=2)
        params = self.stage.params.zeros(joints)
        params["solver"]["forgetting"] = params["solver"]["variance"] = 1.0
        params["solver"]["spread"] = params["evidence"]["spread"] = 1e8
        settings = {"forgetting": 1.0, "memory": 1.0, "bias": 0.02, **evidence}
        for name, value in settings.items():
            params["evidence"][name] = value
        params["evidence"]["lag"] = lag
        params["sums"]["shortest"] = SHORTEST
        params["sums"]["fade"] = params["sums"]["fade_single"] = 1.0
        readout = params["readout"]
        readout["period"], readout["hold"], readout["shrink"] = PERIOD, 1.0, 0.01
        readout["starved"], readout["informative"] = 0.5, 0.1
        self.bank = Bank(self.stage, params)
        assert params["sums"]["fade"].shape == (joints, LEVELS)

    def run(
        self,
        R: Array,
        y: Array,
        *,
        D: tuple[float, float] = (1.0, 0.0),
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
