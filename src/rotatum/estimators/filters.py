"""Parameters of what makes rows: operators, terms of both sides, residual, friction."""

from __future__ import annotations

import math
from typing import Any

from rotatum.errors import MethodError
from rotatum.estimators.gains import steady_gains, velocity_std
from rotatum.estimators.observers.stage import fill_observer
from rotatum.estimators.operators import WINDOW, Operator
from rotatum.estimators.settings import Settings
from rotatum.kernels.link import AHEAD
from rotatum.models import Joint

SLOW = 0.01  # rad/s at which the motor should move by a count in the span of the velocity
QUICK, SLUGGISH = 100.0, 5.0  # rad/s, bandwidth of the velocity that tells a standstill
STARTED = 1e-4  # of the start's error may be left in an observer's first row
SETTLE = 12.0  # time constants until what is not smooth at a start has left the rows
REST = 1e-3  # rad/s below which Coulomb friction has no sign, however good the encoder


def fill_operator(record: Any, operator: Operator, phase: int) -> None:
    """Fill ``CascadeParams`` or ``WindowParams``.

    Args:
        record: to fill.
        operator: which.
        phase: samples by which this joint's windows come later than the first joint's.
    """
    if operator.kind == WINDOW:
        record["length"] = operator.length
        record["weight"][: operator.length] = operator.weights()[::-1]
        record["stride"] = operator.every
        record["phase"] = phase
    else:
        record["pole"] = operator.pole
        record["order"] = operator.order
        # Of smooth signals nothing has to be waited for; but a log may begin with a step.
        record["settle"] = 1 + _samples(SETTLE / operator.cutoff, operator.period)


def fill_weak(record: Any, joint: Joint, motor: int, period: float, held: bool) -> None:
    """Fill ``WeakParams`` but for its columns.

    Args:
        record: to fill.
        joint: constants.
        motor: which of its motors.
        period: s.
        held: whether the torque is a command held until the next sample.
    """
    record["period"] = period
    record["held"] = int(held)
    _motor_constants(record, joint, motor)


def fill_link(record: Any, joint: Joint, arm: bool, period: float) -> None:
    """Fill ``LinkParams`` but for its columns.

    Args:
        record: to fill.
        joint: whose link.
        arm: whether inertia and gravity are the arm's.
        period: s.
    """
    record["period"] = period
    record["arm"] = int(arm)
    record["delay"] = AHEAD if arm else 0
    record["width"] = REST
    if joint.link is None:
        return
    record["damping"] = joint.link.damping.value
    record["coulomb"] = joint.link.coulomb.value
    if not arm:
        assert joint.link.inertia is not None  # settings were refused without it
        record["inertia"] = joint.link.inertia.value
        record["gravity"] = joint.link.gravity_torque


def fill_rotatum(
    record: Any, joint: Joint, operator: Operator, arm: bool, notes: dict[str, str]
) -> None:
    """Fill ``RotatumParams`` and ``UnknownInputParams``.

    Args:
        record: holds both, ``rotatum`` and ``observer``.
        joint: whose link.
        operator: the observer.
        arm: whether inertia and gravity are the arm's.
        notes: filled in.
    """
    fill_observer(record["observer"], operator.observer.recursion, "rotatum", STARTED)
    own = record["rotatum"]
    own["arm"] = int(arm)
    if joint.link is None:
        return
    own["damping"] = joint.link.damping.value
    if not arm:
        assert joint.link.inertia is not None  # settings were refused without it
        own["inertia"] = joint.link.inertia.value
        own["gravity"] = joint.link.gravity_torque
    if joint.link.coulomb.value != 0.0:
        notes["friction"] = (
            "the link's Coulomb friction is constant but where it changes sign: no part of a rate"
        )


def _samples(seconds: float, period: float) -> int:
    """Return how many periods it takes; a period read back from a file is off by its rounding."""
    return math.ceil(seconds / period - 1e-9)


def fill_friction(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> None:
    """Choose the span of the velocity whose sign Coulomb friction has; nothing without friction."""
    column, end = ("link_coulomb", "link") if settings.side == "link" else ("coulomb", "motor")
    if column not in settings.fit and record["coulomb"] == 0.0:
        return
    # A count is as wide as sqrt(12) standard deviations of its noise.
    resolution = math.sqrt(12.0) * settings.noise[0 if end == "link" else 1]
    longest = min(31, int(2.0 / (settings.cutoff * period)))
    delay = max(1, min(longest, math.ceil(resolution / (2.0 * period * SLOW))))
    delay = max(delay, int(record["delay"]))
    # Two quantised positions, 2 delay apart: std resolution sqrt(2 / 12) over that time.
    std = resolution / math.sqrt(6.0) / (2.0 * delay * period)
    record["delay"] = delay
    record["width"] = max(3.0 * std, REST)
    notes["friction"] = (
        f"sign of the velocity across +-{delay} samples, linear below {record['width']:.3g} rad/s; "
        f"rows lag by {1e3 * delay * period:.3g} ms"
    )


def fill_gate(
    record: Any, joint: Joint, settings: Settings, delay: float, notes: dict[str, str]
) -> None:
    """Fill ``GateParams``: a velocity as quick as the encoder's counts allow at that speed.

    Args:
        record: to fill.
        joint: for messages.
        settings: speed, noise, period.
        delay: by which a row's centre lags, s, friction's wait included.
        notes: filled in.

    Raises:
        MethodError: no velocity that the encoder gives is as sure as that.
    """
    period, low = settings.operator.period, settings.selective
    resolution = math.sqrt(12.0) * settings.noise[0]
    bandwidth = min(QUICK, 1.0 / period)
    while bandwidth > SLUGGISH and _at_rest(bandwidth, period, resolution) > 0.5 * low:
        bandwidth *= 0.8
    velocity = record["velocity"]
    velocity["period"] = period
    gains = steady_gains(bandwidth, period)
    velocity["position_gain"], velocity["velocity_gain"] = gains
    record["low"], record["high"] = low, 2.0 * low
    first, last = settings.operator.made_of
    # Friction's sign is taken across some samples more, of which half make the row late.
    waits = delay - settings.operator.delay
    record["span"] = _samples(first + 2.0 * waits, period)
    record["late"] = _samples(last, period)
    record["hold"] = _samples(1.0, period)
    notes["selective"] = (
        f"nothing is learnt from {1e3 * record['late'] * period:.3g} ms after the link is slower "
        f"than {low:g} rad/s until it has been faster than {2.0 * low:g} rad/s for "
        f"{1e3 * record['span'] * period:.3g} ms; velocity of bandwidth {bandwidth:.3g} rad/s"
    )
    least = _at_rest(bandwidth, period, resolution)
    if least > low:
        raise MethodError(
            "the encoder does not tell such a speed from a standstill",
            where=f"joint {joint.name}, selective",
            value=low,
            allowed=f"{least:.2g} rad/s or more",
        )


def _at_rest(bandwidth: float, period: float, resolution: float) -> float:
    """Speed a link at rest may seem to have: of noise, or of one count that comes or goes.

    The velocity of a Kalman filter's two poles (damping 0.707) reaches 0.456 of bandwidth times
    step; below a count in its memory counts are steps, not noise.
    """
    return max(3.0 * velocity_std(bandwidth, period, resolution), 0.456 * bandwidth * resolution)


def fill_residual(
    record: Any, joint: Joint, motor: int, settings: Settings, period: float, held: bool
) -> None:
    """Fill ``ResidualParams``; arguments as in ``fill_weak``."""
    record["period"] = period
    record["gain"] = settings.cutoff
    # The residual starts from 0: exp(-8) of the first torque is left after 8 time constants.
    record["settle"] = 1 + _samples(8.0 / settings.cutoff, period)
    record["held"] = int(held)
    record["offset"] = int("offset" in settings.fit)
    _motor_constants(record, joint, motor)


def fill_kinematic(
    record: Any, joint: Joint, settings: Settings, period: float, notes: dict[str, str]
) -> float:
    """Fill the kinematic filter; returns the speed below which friction has no clear sign."""
    bandwidth = min(10.0 * settings.cutoff, 1.0 / period)
    record["period"] = period
    alpha, beta = steady_gains(bandwidth, period)
    record["position_gain"], record["velocity_gain"] = alpha, beta
    resolution = joint.encoders.resolution("motor") or 0.0
    std = velocity_std(bandwidth, period, resolution)
    notes["velocity"] = (
        f"steady kinematic Kalman filter, bandwidth {bandwidth:g} rad/s, acceleration variance "
        f"{bandwidth**4 * resolution**2 / 12.0:.3g} rad^2/s^4, velocity noise {std:.3g} rad/s "
        f"from a resolution of {resolution:.3g} rad"
    )
    return max(3.0 * std, REST)


def _motor_constants(record: Any, joint: Joint, motor: int) -> None:
    if joint.motors:
        described = joint.motors[motor]
        inertia = described.reflected_inertia
        record["inertia"] = inertia.value if inertia is not None else 0.0
        record["damping"] = described.reflected_damping.value
        record["coulomb"] = described.reflected_coulomb.value
