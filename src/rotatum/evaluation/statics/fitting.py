"""Trust-region reflective least squares from several starts (trumic2022 section V-A)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.statics.model import Cells, Model

__all__ = ["Fit", "fit"]

Array = NDArray[np.float64]

_DRAWN = 120  # starts drawn; the cheapest go on
_TRIED = 4
_FEW = 120  # cells while starts are compared
_DECADES = 1.5  # to either side of a constant's size that starts are drawn from
_SEED = 20220930
_KEPT = 2  # places starts led to that go on with two transmissions
_STEPS = 60  # of a fit that is only compared


class Fit(NamedTuple):
    """Where the fit ended.

    Parameters
    ----------
    u : (p,) fitted vector.
    jacobian : (signals C, p) of the weighted residuals, in shares of the torque's rms.
    converged : whether the steps ended by themselves.
    """

    u: Array
    jacobian: Array
    converged: bool


def fit(model: Model, cells: Cells, known: Sequence[Mapping[str, float]]) -> Fit:
    """Return the least-squares fit.

    Two transmissions with constants of their own start from the fit that ties them: of their sum
    alone the exchange of the two would be as good.

    Parameters
    ----------
    model : what is fitted.
    cells : the data.
    known : constants to start from beside those drawn, by label.
    """
    few = cells.some(_FEW)
    first = _tied(model)
    ends = [_solve(first, few, start, _STEPS) for start in _starts(first, few, known)]
    tried = [_widened(first, model, u) for u in _distinct(ends)]
    _, best = min((_solve(model, few, u, 2 * _STEPS) for u in tried), key=lambda end: end[0])
    return _whole(model, cells, best)


def _distinct(ends: Sequence[tuple[float, Array]]) -> list[Array]:
    """Return the best ends that are not the same: most starts lead to one place."""
    found: list[Array] = []
    for _, u in sorted(ends, key=lambda end: end[0]):
        if not any(np.allclose(u, other, atol=1e-3) for other in found):
            found.append(u)
    return found[:_KEPT]


def _solve(model: Model, cells: Cells, start: Array, steps: int) -> tuple[float, Array]:
    from scipy.optimize import least_squares

    found = least_squares(
        model.residual,
        start,
        bounds=_bounds(model, cells),
        method="trf",
        x_scale="jac",
        max_nfev=steps,
        args=(cells,),
    )
    return float(found.cost), found.x


def _whole(model: Model, cells: Cells, start: Array) -> Fit:
    from scipy.optimize import least_squares

    bounds = _bounds(model, cells)
    found = least_squares(
        model.residual,
        start,
        bounds=bounds,
        method="trf",
        x_scale="jac",
        xtol=1e-9,
        ftol=1e-10,
        gtol=1e-10,
        max_nfev=_STEPS,
        args=(cells,),
    )
    # Central differences once, at the end: what tells constants apart is in its last digits.
    end = least_squares(
        model.residual, found.x, jac="3-point", bounds=bounds, max_nfev=1, args=(cells,)
    )
    return Fit(found.x, np.asarray(end.jac), bool(found.status > 0))


def _bounds(model: Model, cells: Cells) -> tuple[Array, Array]:
    # Beyond by a hair, so that a start on the edge is inside.
    far = np.array([each.bound for each in model.parameters]) * (1.0 + 1e-9)
    middle = np.concatenate([np.zeros(len(model.constants)), _nuisances(model, cells)])
    return middle - far, middle + far


def _nuisances(model: Model, cells: Cells) -> Array:
    """Where nuisances start: zeros in the middle of deflections that do not reach 0, else at 0."""
    start = np.zeros(len(model.nuisances))
    for k, each in enumerate(model.nuisances):
        if each.name == "zero":
            phi = cells.phi[int(each.end or 1) - 1]
            away = phi.min() > 0.0 or phi.max() < 0.0
            start[k] = 0.5 * float(phi.min() + phi.max()) / each.scale if away else 0.0
    return start


def _tied(model: Model) -> Model:
    """Return the model whose transmissions share the agonist's constants."""
    own = tuple(each._replace(end="") for each in model.constants if each.end in ("", "1"))
    return replace(model, constants=own)


def _widened(first: Model, model: Model, u: Array) -> Array:
    """Return a vector of the tied model as one of the model."""
    at = {(each.name, each.place): k for k, each in enumerate(first.constants)}
    constants = [u[at[each.name, each.place]] for each in model.constants]
    return np.concatenate([constants, u[len(first.constants) :]])


def _starts(model: Model, cells: Cells, known: Sequence[Mapping[str, float]]) -> list[Array]:
    """Return the cheapest of the vectors drawn, after those of constants that are known."""
    draw = np.random.default_rng(_SEED)
    told = [_of(model, cells, constants) for constants in known]
    drawn = [_drawn(model, cells, draw) for _ in range(_DRAWN)]
    some = cells.some(_FEW // 4)
    cost = [float(np.sum(model.residual(u, some) ** 2)) for u in drawn]
    order = np.argsort(cost, kind="stable")
    return told + [drawn[k] for k in order[:_TRIED]]


def _of(model: Model, cells: Cells, constants: Mapping[str, float]) -> Array:
    entries = [each.entry(constants[each.label]) for each in model.constants]
    bounds = [each.bound for each in model.constants]
    own = np.clip(entries, -np.array(bounds), bounds)
    return np.concatenate([own, _nuisances(model, cells)])


def _drawn(model: Model, cells: Cells, draw: np.random.Generator) -> Array:
    u = np.concatenate([np.zeros(len(model.constants)), _nuisances(model, cells)])
    for k, each in enumerate(model.constants):
        if each.positive:
            u[k] = np.log(10.0) * draw.uniform(-_DECADES, _DECADES)
        elif not each.place:
            u[k] = draw.uniform(0.0, 1.0) if each.place == 0 else 0.0
    return u
