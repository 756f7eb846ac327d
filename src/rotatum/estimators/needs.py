"""What a method needs of a joint and its device: refused before anything runs."""

from __future__ import annotations

from rotatum.errors import MethodError
from rotatum.models import Device, Joint


def fits_together(method: str, side: str, torque: str, where: str) -> None:
    """Check that method, side and source of the torque go together.

    Raises:
        MethodError: it is not so; names the joint and what is missing.
    """
    if side == "link" and method not in ("weak", "rotatum"):
        raise MethodError(
            f"method {method} works on the motor's side", where=where, value=side, hint="weak can."
        )
    if method == "rotatum" and side != "link":
        raise MethodError("rotatum works on the link's side", where=where, value=side)
    if side == "link" and torque != "estimated":
        raise MethodError(
            "from the link side no torque is read: the link's own motion gives it",
            where=where,
            value=torque,
            allowed="estimated",
        )
    if method == "algebraic" and torque != "estimated":
        raise MethodError(
            "algebraic is built on the motor's balance",
            where=where,
            value=torque,
            allowed="estimated",
            hint="Method weak with a window takes a sensor's torque.",
        )


def needs_motor(joint: Joint, fit: tuple[str, ...], method: str, where: str) -> None:
    """Check that the motor side has its motor, with the inertia or fitting it.

    Raises:
        MethodError: it is not so; names the joint and what is missing.
    """
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


def needs_link(joint: Joint, device: Device, where: str) -> None:
    """Check that the link side has its link: an inertia, or an arm.

    Raises:
        MethodError: it is not so; names the joint and what is missing.
    """
    if device.robot is None and (joint.link is None or joint.link.inertia is None):
        raise MethodError(
            "the link side needs the link's inertia, or the arm the joint belongs to",
            where=where,
            hint="Give [link] inertia, or a [robot] table.",
        )


def needs_law(joint: Joint, where: str) -> None:
    """Check that a model's torque has a law.

    Raises:
        MethodError: it is not so; names the joint and what is missing.
    """
    laws = {transmission.law for transmission in joint.transmissions}
    if None in laws or len(laws) > 1:
        raise MethodError(
            "torque from the model needs the device's own law, the same for both transmissions",
            where=where,
            value=[transmission.law for transmission in joint.transmissions],
            hint="Give [transmission] law and its constants.",
        )


def needs_setpoint(joint: Joint, where: str) -> None:
    """Check that only serial joints have powers of a set-point.

    Raises:
        MethodError: it is not so; names the joint and what is missing.
    """
    if joint.basis.setpoint_orders > 0 and joint.actuation != "serial":
        raise MethodError(
            f"actuation {joint.actuation} has no set-point",
            where=where,
            value=joint.basis.setpoint_orders,
            allowed="[basis] setpoint_orders = 0",
        )
