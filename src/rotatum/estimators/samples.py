"""What a good sample of a joint is, and where its deflection is zero."""

from __future__ import annotations

from typing import Any

from rotatum.estimators.settings import Settings
from rotatum.estimators.shapes import roles
from rotatum.models import Joint

ZERO_SECONDS = 0.05  # of rest at the start from which the deflection's zero is read
MISSING = 8  # samples bridged by straight lines
TOP_SPEED = 100.0  # rad/s at the joint: faster than any joint, slower than a jump of an encoder
LEAST_JUMP = 0.05  # rad


def largest_jump(period: float) -> float:
    """Return how far a joint may turn from sample to sample [rad]: beyond, its encoder jumped."""
    return max(LEAST_JUMP, TOP_SPEED * period)


def fill_guard(
    record: Any, joint: Joint, settings: Settings, notes: dict[str, str], first: int = 0, n: int = 1
) -> None:
    """Fill ``GuardParams`` of a joint, or of joint ``first`` of n in an arm."""
    period = settings.operator.period
    jump = largest_jump(period)
    record["period"] = period
    record["missing"] = MISSING
    for place, role in enumerate(roles(joint.actuation, settings.torque, settings.side)):
        # An arm's sample has room for the antagonists' positions before the set-points.
        i = (3 if role == "setpoint" and n > 1 else place) * n + first
        if role == "q" or role.startswith("theta"):
            record["jump"][i] = jump
            wrap = joint.encoders.wrap_link if role == "q" else joint.encoders.wrap_motor
            record["wrap"][i] = wrap or 0.0
        motor = joint.motor_of(role) if role.startswith("tau") else None
        if motor is not None and motor.torque_limit is not None:
            record["limit"][i] = motor.reflected_torque_limit
    notes["guard"] = (
        f"up to {MISSING} missing samples are bridged; an angle moving by more than {jump:.3g} rad "
        "in a sample is a jump"
    )


def fill_zero(
    record: Any, joint: Joint, which: int, period: float, zero: float | None, notes: dict[str, str]
) -> None:
    """Fill ``ZeroParams`` of a transmission.

    Args:
        record: to fill.
        joint: whose transmission it is.
        which: of its transmissions.
        period: s.
        zero: deflection at rest where it is known otherwise [rad].
        notes: filled in.
    """
    filed = joint.transmissions[which].zero
    if zero is None and isinstance(filed, float | int):
        zero = float(filed)
    if zero is None:
        record["samples"] = max(1, round(ZERO_SECONDS / period))
        said = f"mean deflection of the first {record['samples']} samples"
    else:
        record["zero"] = zero
        source = "mean of the log" if filed == "mean" else "device file"
        said = f"{zero:.6g} rad ({source})"
    notes["zero"] = said if which == 0 or notes["zero"] == said else f"{notes['zero']}; {said}"
