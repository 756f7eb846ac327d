"""What is asked of an estimator: method, torque source, bandwidth, columns; checked once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from rotatum.errors import MethodError, nearest
from rotatum.estimators.measured import Measured
from rotatum.estimators.needs import (
    fits_together,
    needs_law,
    needs_link,
    needs_motor,
    needs_setpoint,
)
from rotatum.estimators.operators import Operator
from rotatum.estimators.quantities import columns_of, fitted_columns, narrowest, of_side
from rotatum.estimators.widths import choose_operator
from rotatum.models import Device, EstimatorSettings, Joint

METHODS = ("residual", "algebraic", "rotatum", "weak")
SIDES = ("motor", "link")
TORQUES = ("estimated", "sensor", "model")
SOLVERS = ("ud", "covariance", "continuous")
# A shorter memory holds too few blocks of rows to tell how coloured they are.
SHORTEST = 0.998


@dataclass(frozen=True)
class Settings:
    """How one joint is estimated, every choice made.

    Args:
        method: ``"weak"``, ``"algebraic"``, ``"rotatum"`` or ``"residual"``.
        side: of the torque balance, ``"motor"`` or ``"link"``.
        torque: ``"estimated"`` from the motor or from the link, a ``"sensor"``'s, or the device's
            own ``"model"``.
        operator: what rows go through.
        fit: columns fitted beside the stiffness, in the order of ``COLUMNS``.
        forgetting: weight of a row relative to the next one.
        solver: ``"ud"``, ``"covariance"`` or ``"continuous"``.
        shrinkage: whether high orders are shrunk as far as the data do not ask for them.
        selective: link speed below which nothing is learnt, rad/s; 0: all is.
        noise: standard deviation of link and motor positions, rad.
        reasons: setting name to where its value comes from.
    """

    method: str
    side: str
    torque: str
    operator: Operator
    fit: tuple[str, ...]
    forgetting: float
    solver: str
    shrinkage: bool
    selective: float
    noise: tuple[float, float]
    reasons: dict[str, str]

    @property
    def cutoff(self) -> float:
        """Bandwidth of the operator, rad/s."""
        return self.operator.cutoff


@dataclass(frozen=True)
class Request:
    """What the caller asks for; ``None`` leaves it to the device file, then to the default.

    ``measured``: what the log says of its own signals; the encoders' counts give the least noise
    there can be.
    """

    method: str | None = None
    side: str | None = None
    torque: str | None = None
    cutoff: float | None = None
    window: float | None = None
    order: int | None = None
    stride: int | None = None
    fit: tuple[str, ...] | None = None
    forgetting: float | None = None
    solver: str | None = None
    shrinkage: bool | None = None
    selective: float | None = None
    measured: Measured | None = None


def settle(joint: Joint, device: Device, period: float, request: Request) -> Settings:
    """Choose every setting of a joint: the caller's word, then the device file's, then defaults.

    Raises:
        MethodError: an unknown name, a value out of range, or something the joint lacks.
    """
    where = f"{device.source}, joint {joint.name}"
    reasons: dict[str, str] = {}
    filed = joint.estimator
    method, side, torque = _balance(filed, request, reasons, where)
    measured = request.measured or Measured()
    noise = _noise(joint, measured)
    fit = _columns(joint, device, (method, side, torque), request.fit, reasons, where)
    operator = choose_operator(
        joint,
        method,
        period,
        where,
        reasons,
        cutoff=request.cutoff,
        window=request.window,
        order=request.order,
        stride=request.stride,
        noise=noise,
        cutoffs=narrowest(method, side, fit, measured),
        side=side,
    )
    forgetting = _pick(reasons, "forgetting", request.forgetting, filed.forgetting, 1.0)
    solver = _pick(reasons, "solver", request.solver, None, "ud")
    solver = _choice("solver", solver, SOLVERS, where)
    shrinkage = _pick(
        reasons, "shrinkage", request.shrinkage, filed.shrinkage, solver != "covariance"
    )
    selective = _pick(reasons, "selective", request.selective, filed.selective, 0.0)
    _needs(joint, device, (method, side, torque), fit, where)
    return Settings(
        method,
        side,
        torque,
        operator,
        fit,
        _forgetting(forgetting, where),
        solver,
        _shrinkage(shrinkage, solver, where),
        _selective(selective, where),
        noise,
        reasons,
    )


def _pick(reasons: dict[str, str], name: str, asked: object, filed: object, default: object) -> Any:
    """The caller's word, then the device file's, then the default; note whose it is."""
    if asked is not None:
        reasons[name] = "asked for"
        return asked
    if filed is not None:
        reasons[name] = "device file"
        return filed
    reasons[name] = "default"
    return default


def _balance(
    filed: EstimatorSettings, request: Request, reasons: dict[str, str], where: str
) -> tuple[str, str, str]:
    """Method, side and source of the torque."""
    method = _pick(reasons, "method", request.method, filed.method, "weak")
    method = _choice("method", method, METHODS, where)
    # A side in the device file is that of the method in it.
    same = "rotatum" not in (method, filed.method) or method == filed.method
    usual_side = "link" if method == "rotatum" else "motor"
    side = _pick(reasons, "side", request.side, filed.side if same else None, usual_side)
    side = _choice("side", side, SIDES, where)
    # A torque's source in the device file is the motor side's; from the link none is read.
    source = filed.torque if side == "motor" else None
    torque = _pick(reasons, "torque", request.torque, source, "estimated")
    torque = _choice("torque", torque, TORQUES, where)
    fits_together(method, side, torque, where)
    return method, side, torque


def _columns(
    joint: Joint,
    device: Device,
    balance: tuple[str, str, str],
    asked: tuple[str, ...] | None,
    reasons: dict[str, str],
    where: str,
) -> tuple[str, ...]:
    """Quantities fitted beside the stiffness; ``balance`` is method, side, torque."""
    method, side, torque = balance
    filed = joint.estimator
    allowed = columns_of(method, side, torque, device)
    # A full basis has a constant of its own, and a slope of a window sees none.
    usual = ("offset",) if "offset" in allowed and not joint.basis.full else ()
    own = (side, method) == (filed.side or "motor", filed.method or "weak")
    listed = of_side(filed.fit, allowed, not own)
    chosen = _pick(reasons, "fit", asked, listed, usual)
    return fitted_columns(chosen, joint, method, side, torque, allowed, where)


def _needs(
    joint: Joint, device: Device, balance: tuple[str, str, str], fit: tuple[str, ...], where: str
) -> None:
    method, side, torque = balance
    if side == "link":
        needs_link(joint, device, where)
    elif torque == "estimated":
        needs_motor(joint, fit, method, where)
    if torque == "model":
        needs_law(joint, where)
    needs_setpoint(joint, where)


def _noise(joint: Joint, measured: Measured) -> tuple[float, float]:
    """Standard deviation of link and motor positions: as measured, at least the counts'."""
    counts = [joint.encoders.resolution(end) or 0.0 for end in ("link", "motor")]
    least = [resolution / math.sqrt(12.0) for resolution in counts]
    link, motor = (max(pair) for pair in zip(least, measured[:2], strict=True))
    return link, motor


def _choice(name: str, value: object, allowed: tuple[str, ...], where: str) -> str:
    if value not in allowed or not isinstance(value, str):
        close = nearest(str(value), allowed)
        hint = f'Did you mean "{close}"?' if close else None
        raise MethodError(f"unknown {name}", where=where, value=value, allowed=allowed, hint=hint)
    return value


def _forgetting(value: object, where: str) -> float:
    if not isinstance(value, int | float) or not SHORTEST <= value <= 1.0:
        raise MethodError(
            "forgetting is the weight of a row relative to the next one",
            where=where,
            value=value,
            allowed=f"{SHORTEST} <= forgetting <= 1",
        )
    return float(value)


def _selective(value: object, where: str) -> float:
    if not isinstance(value, int | float) or not 0.0 <= value < math.inf:
        raise MethodError(
            "selective is the link speed (rad/s) below which nothing is learnt",
            where=where,
            value=value,
            allowed="0 (all is) or more",
        )
    return float(value)


def _shrinkage(value: object, solver: str, where: str) -> bool:
    if not isinstance(value, bool) or (value and solver == "covariance"):
        raise MethodError(
            "shrinking high orders needs the lower ones nested in the solver's factor",
            where=where,
            value=value,
            allowed="true or false with solver ud or continuous, false with covariance",
        )
    return value
