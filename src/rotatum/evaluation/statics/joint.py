"""From a fit to what is told of a joint: constants with deviations, scores, points."""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.metrics import Z95
from rotatum.evaluation.statics.fitting import Fit
from rotatum.evaluation.statics.model import Cells, Model, Parameter, law_values
from rotatum.evaluation.statics.result import Fitted, JointCharacteristic, Points
from rotatum.evaluation.statics.samples import Samples
from rotatum.evaluation.statics.scores import presets_of, relative_rms_percent
from rotatum.evaluation.statics.spread import Spread, spread_of
from rotatum.models import Joint

__all__ = ["FLOOR", "Run", "joint_of", "residual_of"]

Array = NDArray[np.float64]

FLOOR = 3.0
"""Deviations of the sensor's noise below which a torque has no relative error."""
_TOGETHER = 0.5  # of a product that half its interval may be
_BETTER = 0.3  # of its constants' own deviation: else it says no more than they do


class Run(NamedTuple):
    """A fit and what it was made of.

    Parameters
    ----------
    joint, model, samples : what was fitted to what.
    cells : means of the samples.
    starts : (C,) first sample of each cell.
    found : the fit.
    """

    joint: Joint
    model: Model
    samples: Samples
    cells: Cells
    starts: NDArray[np.int64]
    found: Fit


def residual_of(run: Run) -> tuple[Array, Array, Array]:
    """Return sensor without offset, law, and their difference, (signals, N) each [N m].

    Parameters
    ----------
    run : the fit.
    """
    u, model = run.found.u, run.model
    offsets = [[model.offset(u, k)] for k in range(len(model.signals))]
    torque = run.samples.torque - np.array(offsets)
    fitted = model.elastic(u, run.samples.whole())
    return torque, fitted, torque - fitted


def joint_of(run: Run, floor: float | None) -> JointCharacteristic:
    """Return what is told of a joint.

    Parameters
    ----------
    run : the fit.
    floor : of the relative error [N m]; None: three deviations of each sensor's noise.
    """
    samples, model = run.samples, run.model
    torque, fitted, off = residual_of(run)
    spread = spread_of(model, run.cells, run.found, off, run.starts)
    noise = samples.noise if floor is None else ()
    floors = tuple(FLOOR * each for each in noise) or (float(floor or 0.0),) * len(torque)
    limits = np.array(floors)[:, None]
    below = np.abs(torque) <= limits
    presets, group = presets_of(samples, torque, fitted, _stiffness(run), limits)
    total = torque - torque.mean(axis=1, keepdims=True)
    told = bool(spread.told.all())
    nuisances = _nuisances(run, spread)
    return JointCharacteristic(
        name=run.joint.name,
        actuation=run.joint.actuation,
        constants=_constants(run, spread),
        fixed=model.fixed,
        springs=_springs(run) if told else None,
        together=() if told else _together(run, spread),
        nuisances=nuisances,
        zeros=_zeros(run, nuisances),
        relative_percent=relative_rms_percent(np.where(below, 0.0, torque), fitted),
        floors=floors,
        below_floor=int(np.count_nonzero(below)),
        rms=float(np.sqrt(np.mean(off**2))),
        explained_percent=100.0 * (1.0 - float(np.sum(off**2) / np.sum(total**2))),
        samples=torque.shape[1],
        left_out=samples.left_out,
        speed_limit=samples.limit,
        correlation=max(spread.times),
        presets=presets,
        points=Points(
            time=np.arange(torque.shape[1], dtype=np.float64),
            deflection=samples.phi.mean(axis=0),
            torque=torque,
            fit=fitted,
            preset=group,
        ),
    )


def _stiffness(run: Run) -> Array:
    """Stiffness of the joint at every sample: the sum over its transmissions, (N,) [N m/rad]."""
    u, model, phi = run.found.u, run.model, run.samples.phi
    parts = [
        law_values(
            model.law,
            "stiffness",
            model.values(u, k),
            each - model.zero(u, k, len(phi)),
            run.samples.setpoint,
        )
        for k, each in enumerate(phi)
    ]
    return np.asarray(np.sum(parts, axis=0))


def _springs(run: Run) -> tuple[dict[str, tuple[float, ...]], ...]:
    parts = range(len(run.samples.phi))
    return tuple(dict(run.model.values(run.found.u, part)) for part in parts)


def _constants(run: Run, spread: Spread) -> tuple[Fitted, ...]:
    deviations = np.sqrt(np.diag(spread.covariance))
    parameters, told = run.model.constants, spread.told
    rows = zip(parameters, run.found.u, deviations, told, strict=False)
    return tuple(_fitted(p, float(u), float(std), bool(ok)) for p, u, std, ok in rows)


def _nuisances(run: Run, spread: Spread) -> tuple[Fitted, ...]:
    """Offsets and zeros; one whose interval is half of the torque or the range is not told."""
    many = len(run.model.constants)
    rows = zip(run.model.nuisances, run.found.u[many:], spread.nuisance, strict=True)
    return tuple(_fitted(p, float(u), float(s), bool(Z95 * s <= 0.5)) for p, u, s in rows)


def _fitted(parameter: Parameter, u: float, std: float, told: bool) -> Fitted:
    if not told:
        return Fitted(parameter.label, math.nan, math.nan, parameter.unit)
    value = parameter.value(u)
    size = value if parameter.positive else parameter.scale
    return Fitted(parameter.label, value, abs(size) * std, parameter.unit)


def _zeros(run: Run, nuisances: tuple[Fitted, ...]) -> tuple[float, ...]:
    zeros = [each for each in nuisances if each.name.startswith("zero")]
    return tuple(each.value for each in zeros) if all(each.told for each in zeros) else ()


def _together(run: Run, spread: Spread) -> tuple[Fitted, ...]:
    """Products and quotients that are told where neither constant is.

    In logarithms a product is a sum: its variance is that of the sum of the entries.
    """
    found = []
    constants = run.model.constants
    for i, j in combinations(range(len(constants)), 2):
        one, other = constants[i], constants[j]
        own_part = one.end == other.end and one.positive and other.positive
        if spread.told[i] or spread.told[j] or not own_part:
            continue
        for power, sign in ((1.0, " "), (-1.0, "/")):
            direction = np.zeros(len(constants))
            direction[i], direction[j] = 1.0, power
            std = math.sqrt(max(0.0, float(direction @ spread.covariance @ direction)))
            own = math.sqrt(min(spread.covariance[i, i], spread.covariance[j, j]))
            if Z95 * std <= _TOGETHER and std < _BETTER * own:
                u = run.found.u
                value = one.value(float(u[i])) * other.value(float(u[j])) ** power
                unit = _unit(one.unit, other.unit, sign)
                found.append(Fitted(f"{one.label}{sign}{other.label}", value, value * std, unit))
    return tuple(found)


def _unit(one: str, other: str, sign: str) -> str:
    if sign == " " and (one, other) == ("N m", "1/rad"):
        return "N m/rad"
    if not other:
        return one
    return other if not one and sign == " " else f"({one}){sign}({other})"
