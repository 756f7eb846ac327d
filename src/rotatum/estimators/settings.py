"""What is asked of an estimator: method, torque source, bandwidth, columns; checked once."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rotatum.errors import MethodError, nearest
from rotatum.estimators.gains import noise_gain
from rotatum.models import Device, Joint

METHODS = ("residual", "weak")
TORQUES = ("estimated", "sensor", "model")
SOLVERS = ("ud", "covariance")
MOTOR_COLUMNS = ("inertia", "damping", "coulomb", "skew", "transmission_damping", "offset")
SENSOR_COLUMNS = ("skew", "transmission_damping", "offset")
DEFAULT_CUTOFF = 300.0
LOWEST_CUTOFF = 30.0  # of the default: slower, a hand-moved joint would pass no row
COARSE = 0.005  # counts through the low-pass over the deflection's range
# A shorter memory holds too few blocks of rows to tell how coloured they are.
SHORTEST = 0.998


@dataclass(frozen=True)
class Settings:
    """How one joint is estimated, every choice made.

    Args:
        method: ``"weak"`` or ``"residual"``.
        torque: ``"estimated"`` from the motor, a ``"sensor"``'s, or the device's own ``"model"``.
        cutoff: bandwidth of the operator, rad/s.
        fit: columns fitted beside the stiffness, in the order of ``MOTOR_COLUMNS``.
        forgetting: weight of a row relative to the next one.
        solver: ``"ud"`` or ``"covariance"``.
        shrinkage: whether high orders are shrunk as far as the data do not ask for them.
        reasons: setting name to where its value comes from.
    """

    method: str
    torque: str
    cutoff: float
    fit: tuple[str, ...]
    forgetting: float
    solver: str
    shrinkage: bool
    reasons: dict[str, str]


@dataclass(frozen=True)
class Request:
    """What the caller asks for; ``None`` leaves it to the device file, then to the default."""

    method: str | None = None
    side: str | None = None
    torque: str | None = None
    cutoff: float | None = None
    fit: tuple[str, ...] | None = None
    forgetting: float | None = None
    solver: str | None = None
    shrinkage: bool | None = None


def settle(joint: Joint, device: Device, period: float, request: Request) -> Settings:
    """Choose every setting of a joint: the caller's word, then the device file's, then defaults.

    Raises:
        MethodError: an unknown name, a value out of range, or something the joint lacks.
    """
    where = f"{device.source}, joint {joint.name}"
    reasons: dict[str, str] = {}

    def pick(name: str, asked: object, filed: object, default: object) -> object:
        if asked is not None:
            reasons[name] = "asked for"
            return asked
        if filed is not None:
            reasons[name] = "device file"
            return filed
        reasons[name] = "default"
        return default

    filed = joint.estimator
    method = _choice("method", pick("method", request.method, filed.method, "weak"), METHODS, where)
    side = _choice("side", request.side or filed.side or "motor", ("motor",), where)
    reasons["side"] = side
    torque = pick("torque", request.torque, filed.torque, "estimated")
    torque = _choice("torque", torque, TORQUES, where)
    if filed.window is not None and request.cutoff is None:
        raise MethodError(
            "this method has a cutoff (rad/s), not a window",
            where=where,
            value=filed.window,
            allowed="[estimator] cutoff",
        )
    default, why = _default_cutoff(joint, method, period)
    cutoff = _cutoff(pick("cutoff", request.cutoff, filed.cutoff, default), method, period, where)
    if reasons["cutoff"] == "default":
        reasons["cutoff"] = why
    # A full basis has a constant of its own.
    usual = () if joint.basis.full else ("offset",)
    fit = _fit(pick("fit", request.fit, filed.fit, usual), joint, method, torque, where)
    forgetting = _forgetting(pick("forgetting", request.forgetting, filed.forgetting, 1.0), where)
    solver = _choice("solver", pick("solver", request.solver, None, "ud"), SOLVERS, where)
    asked = pick("shrinkage", request.shrinkage, filed.shrinkage, solver == "ud")
    shrinkage = _shrinkage(asked, solver, where)
    if torque == "estimated":
        _needs_motor(joint, fit, method, where)
    if torque == "model":
        _needs_law(joint, where)
    _needs_setpoint(joint, where)
    return Settings(method, torque, cutoff, fit, forgetting, solver, shrinkage, reasons)


def _choice(name: str, value: object, allowed: tuple[str, ...], where: str) -> str:
    if value not in allowed or not isinstance(value, str):
        close = nearest(str(value), allowed)
        hint = f'Did you mean "{close}"?' if close else None
        raise MethodError(f"unknown {name}", where=where, value=value, allowed=allowed, hint=hint)
    return value


def _default_cutoff(joint: Joint, method: str, period: float) -> tuple[float, str]:
    """300 rad/s, at most half the sample rate; for ``weak`` lower where the encoders are coarse.

    Rows of ``weak`` have no lag bias, so that a lower cutoff costs nothing but speed of reaction.
    It is lowered until the encoders' counts, through the low-pass, are half a per cent of the
    deflection's range, or to 30 rad/s.
    """
    cutoff = min(DEFAULT_CUTOFF, 0.5 / period)
    why = f"default: {DEFAULT_CUTOFF:g} rad/s, at most half the sample rate"
    counts = [joint.encoders.resolution(end) or 0.0 for end in ("link", "motor")]
    noise = math.hypot(*counts) / math.sqrt(12.0)
    reach = joint.basis.deflection_range
    if method != "weak" or reach is None:
        return cutoff, why
    highest = cutoff
    while noise * math.sqrt(noise_gain(math.exp(-cutoff * period), 0, period)) > COARSE * reach:
        if cutoff <= LOWEST_CUTOFF:
            break
        cutoff = max(LOWEST_CUTOFF, 0.9 * cutoff)
    if cutoff < highest:
        why += f", lowered because the encoders' counts are coarse for a range of {reach:g} rad"
    return cutoff, why


def _cutoff(value: object, method: str, period: float, where: str) -> float:
    # Above these a pole is faster than a sample: nothing is filtered, the setting says nothing.
    highest = (5.0 if method == "residual" else math.pi) / period
    if not isinstance(value, int | float) or not 0.0 < value <= highest:
        raise MethodError(
            "cutoff (rad/s) does not fit the sample period",
            where=where,
            value=value,
            allowed=f"0 < cutoff <= {highest:.6g} rad/s at a period of {period:.6g} s",
        )
    return float(value)


def _forgetting(value: object, where: str) -> float:
    if not isinstance(value, int | float) or not SHORTEST <= value <= 1.0:
        raise MethodError(
            "forgetting is the weight of a row relative to the next one",
            where=where,
            value=value,
            allowed=f"{SHORTEST} <= forgetting <= 1",
        )
    return float(value)


def _fit(value: object, joint: Joint, method: str, torque: str, where: str) -> tuple[str, ...]:
    asked = tuple(value) if isinstance(value, tuple | list) else (value,)
    allowed = _columns(method, torque)
    for name in asked:
        if name not in allowed:
            close = nearest(str(name), allowed)
            known = name in MOTOR_COLUMNS
            what = (
                f"method {method} with {torque} torque cannot fit this"
                if known
                else ("no such quantity to fit on the motor side")
            )
            hint = "Method weak can." if known and method == "residual" else None
            hint = hint or (f'Did you mean "{close}"?' if close else None)
            raise MethodError(what, where=where, value=name, allowed=allowed, hint=hint)
    if "offset" in asked and joint.basis.full:
        raise MethodError(
            "a full basis has a constant already",
            where=where,
            value=list(asked),
            hint="Leave offset out; the coefficient of power 0 is it.",
        )
    if {"skew", "damping"} <= set(asked):
        raise MethodError(
            "skew and damping are the same column seen from the motor side",
            where=where,
            value=list(asked),
            allowed="one of the two",
            hint="Fit one; the result names its equivalent in the other.",
        )
    return tuple(name for name in MOTOR_COLUMNS if name in asked)


def _columns(method: str, torque: str) -> tuple[str, ...]:
    if method == "residual":
        return ("offset",)
    return MOTOR_COLUMNS if torque == "estimated" else SENSOR_COLUMNS


def _shrinkage(value: object, solver: str, where: str) -> bool:
    if not isinstance(value, bool) or (value and solver != "ud"):
        raise MethodError(
            "shrinking high orders needs the lower ones nested in the solver's factor",
            where=where,
            value=value,
            allowed="true or false with solver ud, false with covariance",
        )
    return value


def _needs_motor(joint: Joint, fit: tuple[str, ...], method: str, where: str) -> None:
    if not joint.motors:
        raise MethodError(
            "the elastic torque can be estimated only with a [motor] table",
            where=where,
            hint="Give its inertia, or use --torque sensor.",
        )
    if "inertia" not in fit and any(motor.inertia is None for motor in joint.motors):
        raise MethodError(
            "the elastic torque cannot be estimated without the motor's inertia",
            where=where,
            hint="Give [motor] inertia, fit it (method weak), or use --torque sensor.",
        )


def _needs_law(joint: Joint, where: str) -> None:
    laws = {transmission.law for transmission in joint.transmissions}
    if None in laws or len(laws) > 1:
        raise MethodError(
            "torque from the model needs the device's own law, the same for both transmissions",
            where=where,
            value=[transmission.law for transmission in joint.transmissions],
            hint="Give [transmission] law and its constants.",
        )


def _needs_setpoint(joint: Joint, where: str) -> None:
    if joint.basis.setpoint_orders > 0 and joint.actuation != "serial":
        raise MethodError(
            f"actuation {joint.actuation} has no set-point",
            where=where,
            value=joint.basis.setpoint_orders,
            allowed="[basis] setpoint_orders = 0",
        )
