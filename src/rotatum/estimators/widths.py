"""Which operator rows go through: poles or a window, how wide, chosen where nothing is asked."""

from __future__ import annotations

import math

from rotatum.errors import MethodError
from rotatum.estimators.operators import EXPONENTIAL, OBSERVER, WINDOW, Operator
from rotatum.models import EstimatorSettings, Joint

DEFAULT_CUTOFF = 300.0
LOWEST_CUTOFF = 30.0  # of the default: slower, a hand-moved joint would pass no row
COARSE = 0.005  # encoder noise through the operator over the deflection's range
ALGEBRAIC_WINDOW = 1.0  # s, the paper's
POLES = (2, 3)
LINK_POLES = 3  # rows have the link's acceleration in them, whose noise two poles do not take away
POWERS = (2, 3, 4, 5)
ROWS_PER_WINDOW = 10
LONGEST = 8192  # samples under a window: what its ring may cost
BLIND_CUTOFF = 60.0  # rad/s of an observer's jerk where the log has not told its noise
# Lag of an observer in 1 / cutoff: four times what its noise asks for, because rates and jerk must
# be derivatives of one signal, also of what moves nearly as fast as the cutoff: half of it leaves
# an error of 7e-3 of the stiffness there, a third of it 2e-2, and no interval knows of it.
CONSISTENT = 20.0
DEADBEAT_LAG = 2  # samples: a stencil of five
FASTEST, SLOWEST = 2.0, 2e-3  # rad per sample: what an observer can be designed for, how long


def choose_operator(
    joint: Joint,
    method: str,
    period: float,
    where: str,
    reasons: dict[str, str],
    *,
    cutoff: float | None,
    window: float | None,
    order: int | None,
    stride: int | None,
    noise: tuple[float, float],
    cutoffs: tuple[tuple[str, float], ...] = (),
    side: str = "motor",
) -> Operator:
    """Choose the operator: the caller's word, then the device file's, then by noise and period.

    Args:
        joint: its encoders, basis and ``[estimator]``.
        method: ``"weak"``, ``"algebraic"``, ``"rotatum"`` or ``"residual"``.
        period: s.
        where: for messages.
        reasons: filled in with where ``cutoff`` or ``window`` comes from.
        cutoff, window, order, stride: asked for; None: not.
        noise: standard deviation of link and motor positions, rad.
        cutoffs: signals in the rows, and the highest cutoff, rad/s, their noise allows.
        side: of the balance.

    Raises:
        MethodError: a width or order that the method or the period does not allow.
    """
    if cutoff is not None and window is not None:
        raise MethodError(
            "give a cutoff (rad/s) or a window (s), not both", where=where, value=(cutoff, window)
        )
    filed = joint.estimator
    if cutoff is None and window is None:
        cutoff, window = filed_width(filed, method)
        told = "device file"
    else:
        told = "asked for"
    if method == "algebraic":
        if cutoff is not None:
            raise MethodError("algebraic has a window (s), not a cutoff", where=where, value=cutoff)
        reasons["window"] = "default, the paper's" if window is None else told
        seconds = ALGEBRAIC_WINDOW if window is None else window
        return _windowed(seconds, order, stride, period, where, derivative=1)
    if method != "weak" and (window is not None or stride is not None):
        what = f"{method} has a cutoff (rad/s), not a window"
        raise MethodError(what, where=where, value=window or stride)
    if window is not None:
        reasons["window"] = told
        return _windowed(window, order, stride, period, where)
    if stride is not None:
        raise MethodError("only a window has a stride", where=where, value=stride)
    if cutoff is None:
        if method == "rotatum":
            cutoff, told = _observer_cutoff(period, noise, cutoffs)
        else:
            cutoff, told = _default_cutoff(joint, method, period, noise, cutoffs)
    reasons["cutoff"] = told
    if method == "rotatum":
        return _observer(cutoff, order, period, where)
    width = _cutoff(cutoff, method, period, where)
    if method == "residual":
        return Operator(EXPONENTIAL, 1, width, period)
    usual = LINK_POLES if side == "link" else 2
    poles = _order(order, POLES, usual, "poles of the low-pass", where)
    return Operator(EXPONENTIAL, poles, width, period)


def _windowed(
    window: float,
    order: int | None,
    stride: int | None,
    period: float,
    where: str,
    derivative: int = 0,
) -> Operator:
    """Return a window of that length, or its slope."""
    power = _order(order, POWERS, 3, "power of the window", where)
    seconds = _window(window, power, period, where)
    samples = round(seconds / period)
    every = max(1, samples // ROWS_PER_WINDOW) if stride is None else stride
    if not 1 <= every < samples:
        raise MethodError(
            "stride is the number of samples from one row to the next",
            where=where,
            value=stride,
            allowed=f"1 <= stride < {samples}",
        )
    return Operator(WINDOW, power, samples * period, period, derivative, every)


def filed_width(filed: EstimatorSettings, method: str) -> tuple[float | None, float | None]:
    """Return the cutoff and the window that a device file has for a method.

    A width of the other kind was filed for another method; so was the cutoff of a low-pass where
    an observer's is wanted, which has to be as low as the noise of the jerk asks for.
    """
    observed = method == "rotatum"
    same = observed == (filed.method == "rotatum")
    return (
        filed.cutoff if same and method != "algebraic" else None,
        filed.window if not observed and method != "residual" else None,
    )


def _observer_cutoff(
    period: float, noise: tuple[float, float], cutoffs: tuple[tuple[str, float], ...]
) -> tuple[float, str]:
    """As fast as the noise of the link's jerk allows."""
    cutoff = min(DEFAULT_CUTOFF, 0.5 / period)
    why = f"default: {DEFAULT_CUTOFF:g} rad/s, at most half the sample rate"
    for signal, highest in cutoffs:
        if highest < cutoff:
            cutoff = highest
            why = f"default: lowered for the noise of the {signal} in this log"
    if not cutoffs and noise[0] > 0.0 and cutoff > BLIND_CUTOFF:
        cutoff, why = BLIND_CUTOFF, "default: no log has told the noise of the link's jerk"
    if cutoff < SLOWEST / period:
        return SLOWEST / period, "default: as slow as an observer can be at this period"
    return cutoff, why


def _observer(cutoff: float, order: int | None, period: float, where: str) -> Operator:
    """Return the observer of that bandwidth; infinite is deadbeat."""
    deadbeat = math.isinf(cutoff) and cutoff > 0.0
    if not deadbeat and not SLOWEST / period <= cutoff <= FASTEST / period:
        raise MethodError(
            "cutoff (rad/s) does not fit the sample period",
            where=where,
            value=cutoff,
            allowed=f"{SLOWEST / period:.6g} to {FASTEST / period:.6g} rad/s at a period of "
            f"{period:.6g} s, or inf: deadbeat, as printed",
        )
    usual = DEADBEAT_LAG
    if not deadbeat:
        usual = min(math.ceil(CONSISTENT / (cutoff * period)), LONGEST - 1)
    lag, least = usual if order is None else order, DEADBEAT_LAG if deadbeat else 1
    if not least <= lag < LONGEST:
        raise MethodError(
            "order is the number of samples by which the observer comes late",
            where=where,
            value=order,
            allowed=f"{least} <= order < {LONGEST}",
        )
    return Operator(OBSERVER, lag, float(cutoff), period)


def _order(value: int | None, allowed: tuple[int, ...], default: int, what: str, where: str) -> int:
    if value is None:
        return default
    if value not in allowed:
        raise MethodError(
            f"no such {what}", where=where, value=value, allowed=tuple(map(str, allowed))
        )
    return value


def _default_cutoff(
    joint: Joint,
    method: str,
    period: float,
    noise: tuple[float, float],
    cutoffs: tuple[tuple[str, float], ...],
) -> tuple[float, str]:
    """300 rad/s, at most half the sample rate; for ``weak`` lower where positions are noisy.

    Rows of ``weak`` have no lag bias, so that a lower cutoff costs nothing but speed of reaction.
    It is lowered until the noise of the deflection, through the low-pass, is half a per cent of its
    range, and as far as the signals in the rows ask for; but not below 30 rad/s.
    """
    cutoff = min(DEFAULT_CUTOFF, 0.5 / period)
    why = f"default: {DEFAULT_CUTOFF:g} rad/s, at most half the sample rate"
    spread = math.hypot(*noise)
    reach = joint.basis.deflection_range
    if method != "weak":
        return cutoff, why
    for signal, highest in cutoffs:
        if max(highest, LOWEST_CUTOFF) < cutoff:
            cutoff = max(highest, LOWEST_CUTOFF)
            why = f"default: lowered for the noise of the {signal} in this log"
    if reach is None or spread == 0.0:
        return cutoff, why
    highest = cutoff
    while cutoff > LOWEST_CUTOFF:
        gain = Operator(EXPONENTIAL, 2, cutoff, period).noise_gain(0)
        if spread * math.sqrt(gain) <= COARSE * reach:
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


def _window(value: object, power: int, period: float, where: str) -> float:
    shortest, longest = 2 * power + 2, LONGEST
    seconds = float(value) if isinstance(value, int | float) else math.nan
    if not math.isfinite(seconds) or not shortest <= round(seconds / period) <= longest:
        raise MethodError(
            "window (s) does not fit the sample period",
            where=where,
            value=value,
            allowed=f"{shortest * period:.6g} to {longest * period:.6g} s at a period of "
            f"{period:.6g} s",
        )
    return seconds
