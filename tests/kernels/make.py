"""Records, small stages and smooth signals for the tests of kernels."""

from __future__ import annotations

from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.kernels import rls, rows, udrls
from rotatum.record import Field, Layout, Record, integer, number, vector
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.stage import Stage

Array = NDArray[np.float64]


def record(kind: type[Record], sizes: dict[str, int] | None = None, **values: Any) -> Any:
    """One zeroed record with some fields set."""
    one = kind.layout(**(sizes or {})).zeros(1)[0]
    for name, value in values.items():
        one[name] = value
    return one


def plain(one: Any) -> Any:
    """The same values in plain objects of Python numbers: twenty times as fast to step through.

    Matrices stay arrays: kernels read them as ``m[i, j]``.
    """

    def value(v: Any) -> Any:
        if v.dtype.names:
            return plain(v)
        return v.copy() if v.ndim == 2 else v.tolist()

    return SimpleNamespace(**{name: value(one[name]) for name in one.dtype.names})


def copy_out(source: Any, target: Any) -> None:
    """Write a plain object's values into a record without nested ones."""
    for name, value in vars(source).items():
        target[name] = value


def nested(**parts: Layout) -> Any:
    """One zeroed record of records."""
    fields = {name: Field(layout) for name, layout in parts.items()}
    return Layout("nested", "Records side by side.", fields).zeros(1)[0]


class RowIn(Record):
    """A row with a time, as an input."""

    time = number("of the row", unit="s")
    valid = integer("1: learn from this row")
    fresh = integer("1: the filters started here")
    y = number("left side", unit="N m")
    phi = number("deflection", unit="rad")
    suspect = number("acceleration", unit="rad/s^2")
    R = vector("p", "regressors")
    F = vector("p", "basis")
    D = vector("p", "its derivative", unit="1/rad")
    H = vector("p", "its second derivative", unit="1/rad^2")


class Nothing(Record):
    """A field for a stage that needs no memory."""

    unused = number("nothing")


class Estimate(Record):
    """What a solver has."""

    alpha = vector("p", "coefficients")
    largest = number("largest variance of a coefficient")
    smallest = number("smallest diagonal factor, or smallest variance")


SOLVERS: dict[str, tuple[Any, type[Record], str]] = {
    "ud": (udrls, udrls.UdState, "state.d[i]"),
    "covariance": (rls, rls.RlsState, "state.P[i, i]"),
}


@lru_cache
def solver_stage(name: str, p: int) -> Stage:
    """A solver alone: rows in, coefficients out."""
    module, state, factor = SOLVERS[name]
    lines = f"""solver_update(params, state, u.R, u.y)
out.largest = 0.0
out.smallest = 1e300
for i in range({p}):
    out.alpha[i] = state.alpha[i]
    if {factor} < out.smallest:
        out.smallest = {factor}
for i in range({p}):
    for j in range({p}):
        state.g[j] = 0.0
    state.g[i] = 1.0
    variance = solver_spread(state, state.g, 0)
    if variance > out.largest:
        out.largest = variance"""
    kernels = {
        "solver_init": module.init,
        "solver_update": module.update,
        "solver_spread": module.spread,
    }
    init, step = write_kernels(
        f"{name}_{p}", "A solver.", ["solver_init(params, state)"], lines.splitlines(), kernels
    )
    return Stage(
        f"solver_{name}_{p}",
        udrls.SolverParams.layout(p=p),
        state.layout(p=p),
        RowIn.layout(p=p),
        Estimate.layout(p=p),
        init,
        step,
    )


def pass_init(params: Any, state: Any) -> None:
    """Nothing to remember."""
    state.unused = 0.0


def pass_step(params: Any, state: Any, u: Any, out: Any) -> None:
    """Hand the row on."""
    out.valid = u.valid
    out.status = 0
    out.fresh = u.fresh
    out.y = u.y
    out.phi = u.phi
    out.suspect = u.suspect
    for i in range(len(out.R)):
        out.R[i] = u.R[i]
        out.F[i] = u.F[i]
        out.D[i] = u.D[i]
        out.H[i] = u.H[i]


@lru_cache
def given_rows(p: int) -> Stage:
    """The simplest rows stage: rows are its input."""
    nothing = Nothing.layout()
    return Stage(
        f"given_{p}",
        nothing,
        nothing,
        RowIn.layout(p=p),
        rows.Row.layout(p=p),
        pass_init,
        pass_step,
    )


class Sines:
    """A random sum of sines with its derivatives: a smooth signal whose truth is known."""

    def __init__(
        self, rng: np.random.Generator, size: float, low: float, high: float, tones: int = 5
    ) -> None:
        self.w = np.exp(rng.uniform(np.log(low), np.log(high), tones))
        self.phase = rng.uniform(0.0, 2.0 * np.pi, tones)
        self.size = size * rng.uniform(0.3, 1.0, tones) / tones

    def __call__(self, t: Array, order: int = 0) -> Array:
        """The derivative of some order."""
        waves = np.sin(np.outer(t, self.w) + self.phase + 0.5 * np.pi * order)
        return np.asarray(waves @ (self.size * self.w**order))

    def bound(self, order: int) -> float:
        """The largest a derivative can get."""
        return float(self.size @ self.w**order)
