"""The solvers below the narrow waist: recursive least squares in two forms."""

from __future__ import annotations

from typing import Any, NamedTuple

from rotatum.kernels import rls, udrls
from rotatum.record import Record


class Solver(NamedTuple):
    """A recursive least-squares kernel: functions over a state with ``alpha``, ``innovation``,
    ``leverage`` and ``count``.

    Args:
        name: short name, as in settings.
        state: its memory.
        init, update, anchor, spread, multiply: see ``rotatum.kernels.udrls``.
        nested: whether its factor holds all lower orders, so that high ones can be shrunk.
        cites: what it comes from.
    """

    name: str
    state: type[Record]
    init: Any
    update: Any
    anchor: Any
    spread: Any
    multiply: Any
    nested: bool
    cites: tuple[str, ...]


def _solver(name: str, module: Any, state: type[Record], nested: bool, *cites: str) -> Solver:
    m = module
    return Solver(name, state, m.init, m.update, m.anchor, m.spread, m.multiply, nested, cites)


UD = _solver("ud", udrls, udrls.UdState, True, "bierman1977", "flacco2012")
COVARIANCE = _solver("covariance", rls, rls.RlsState, False, "flacco2012", "bittanti1990")

SOLVERS = {s.name: s for s in (UD, COVARIANCE)}
