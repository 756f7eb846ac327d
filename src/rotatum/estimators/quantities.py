"""Quantities that can be fitted beside the stiffness: which, where, and in which order."""

from __future__ import annotations

from rotatum.errors import MethodError, nearest
from rotatum.estimators.measured import ACCELERATION, JERK, VELOCITY, Measured
from rotatum.models import Device, Joint

COLUMNS = (
    "inertia",
    "damping",
    "coulomb",
    "link_damping",
    "link_coulomb",
    "gravity_torque",
    "payload",
    "skew",
    "transmission_damping",
    "offset",
)
"""Everything that can be fitted, in the order of the columns."""
MOTOR_COLUMNS = ("inertia", "damping", "coulomb", "skew", "transmission_damping", "offset")
LINK_COLUMNS = (
    "link_damping",
    "link_coulomb",
    "gravity_torque",
    "skew",
    "transmission_damping",
    "offset",
)
ARM_COLUMNS = (
    "link_damping",
    "link_coulomb",
    "payload",
    "skew",
    "transmission_damping",
    "offset",
)
SENSOR_COLUMNS = ("skew", "transmission_damping", "offset")
PAYLOAD_SHARE = 0.25
_SIGNALS = {
    "inertia": ("motor", ACCELERATION),
    "damping": ("motor", VELOCITY),
    "link_damping": ("link", VELOCITY),
    "skew": ("link", VELOCITY),
}


def columns_of(method: str, side: str, torque: str, device: Device) -> tuple[str, ...]:
    """Quantities that can be fitted beside the stiffness.

    Args:
        method, side, torque: as settled.
        device: whose links are an arm's or pendulums.
    """
    if method == "residual":
        return ("offset",)
    if method == "rotatum":
        return ()
    if side == "link":
        return LINK_COLUMNS if device.robot is None else ARM_COLUMNS
    found = MOTOR_COLUMNS if torque == "estimated" else SENSOR_COLUMNS
    return tuple(name for name in found if method != "algebraic" or name != "offset")


def fitted_columns(
    value: object,
    joint: Joint,
    method: str,
    side: str,
    torque: str,
    allowed: tuple[str, ...],
    where: str,
) -> tuple[str, ...]:
    """Return the quantities asked for in the order of ``COLUMNS``.

    Args:
        value: as asked for.
        joint: whose basis may have a constant already.
        method, side, torque: as settled.
        allowed: by these.
        where: for messages.

    Raises:
        MethodError: one that is not allowed, or two that are the same column.
    """
    asked = tuple(value) if isinstance(value, tuple | list) else (value,)
    for name in asked:
        if name not in allowed:
            close = nearest(str(name), allowed)
            what = f"no such quantity to fit on the {side} side"
            hint = f'Did you mean "{close}"?' if close else None
            if name in COLUMNS:
                what = f"method {method} on the {side} side with {torque} torque cannot fit this"
                hint = "Method weak can." if method == "residual" else None
            if name == "offset" and method == "algebraic":
                hint = "The slope of a window takes a constant to zero: there is none to fit."
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
    return tuple(name for name in COLUMNS if name in asked)


def of_side(
    filed: tuple[str, ...] | None, allowed: tuple[str, ...], other: bool
) -> tuple[str, ...] | None:
    """What a device file fits; with another side or method than its own, what of it there is."""
    if filed is None or not other:
        return filed
    return tuple(name for name in filed if name in allowed) or None


def narrowest(
    method: str, side: str, fit: tuple[str, ...], measured: Measured
) -> tuple[tuple[str, float], ...]:
    """Signals that rows are made of, and the highest cutoff each allows."""
    if method == "rotatum":
        found = measured.cutoffs.get(("link", JERK))
        return () if found is None else (("jerk of the link", found),)
    wanted = {f"fitted {name}": _SIGNALS[name] for name in fit if name in _SIGNALS}
    if side == "link":
        wanted["acceleration of the link"] = ("link", ACCELERATION)
    if "payload" in fit and ("link", ACCELERATION) in measured.cutoffs:
        # Its column is acceleration too, and nearly that of the load: noise of a hundredth, which
        # the stiffness alone bears, is told apart by it as if it were motion.
        highest = PAYLOAD_SHARE * measured.cutoffs["link", ACCELERATION]
        return (("fitted payload", highest),)
    return tuple(
        (why, measured.cutoffs[signal])
        for why, signal in wanted.items()
        if signal in measured.cutoffs
    )
