"""Which method, side and settings suit a log and a device, and why, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from rotatum.estimators.shapes import ends_of
from rotatum.evaluation.advice import cautions, settings_for
from rotatum.evaluation.inputs import log_names, log_roles
from rotatum.evaluation.motion import Motion, motion_of
from rotatum.logs import Log, LogReader
from rotatum.models import Device, Joint

__all__ = ["Advice", "Recommendation", "recommend"]

LOUD, FAINT = 10.0, 3.0
"""Load over noise of its rows, from which a side is well founded and below which it is not."""


@dataclass(frozen=True)
class Advice:
    """What suits one joint.

    Args:
        joint: its name.
        method: to use; None: the log can be estimated by none.
        side, torque: of it.
        fit: columns to fit beside the stiffness; None: the method's own.
        window: s; None: the low-pass.
        reasons: sentences, the choice of the side first.
        cautions: sentences on what stands in the way of a good answer.
    """

    joint: str
    method: str | None
    side: str
    torque: str
    fit: tuple[str, ...] | None
    window: float | None
    reasons: tuple[str, ...]
    cautions: tuple[str, ...]

    def settings(self) -> dict[str, Any]:
        """Return the arguments of ``rotatum.estimate``; nothing where no method can."""
        if self.method is None:
            return {}
        told = {"method": self.method, "side": self.side, "fit": self.fit, "window": self.window}
        if self.side == "motor":
            told["torque"] = self.torque
        return {name: value for name, value in told.items() if value is not None}

    def options(self) -> str:
        """Return the options of ``rotatum estimate`` that say the same."""
        words = []
        for name, value in self.settings().items():
            if name == "torque" and value == "estimated":
                continue
            told = (",".join(value) or "none") if name == "fit" else f"{value}"
            words.append(f"--{name} {told}")
        return " ".join(words)

    def to_json(self) -> dict[str, Any]:
        """The joint's ``recommendation`` in ``rotatum compare --json``."""
        return {
            "method": self.method,
            "side": self.side,
            "torque": self.torque,
            "fit": None if self.fit is None else list(self.fit),
            "window": self.window,
            "options": self.options(),
            "reasons": list(self.reasons),
            "cautions": list(self.cautions),
        }

    def __str__(self) -> str:
        head = self.options() or "no method"
        return "\n".join([f"{self.joint}: {head}", *self.reasons, *self.cautions])


@dataclass(frozen=True)
class Recommendation:
    """Result of ``rotatum.recommend``; printed, it is its sentences.

    Args:
        source: the log.
        joints: name to advice.
        motions: name to what was measured of the joint's motion, None without its positions.
    """

    source: str
    joints: Mapping[str, Advice]
    motions: Mapping[str, Motion | None]

    def __str__(self) -> str:
        return "\n\n".join(str(advice) for advice in self.joints.values())


@dataclass
class _Case:
    """A joint and all that the rules look at."""

    joint: Joint
    device: Device
    logged: tuple[str, ...]
    motion: Motion | None
    reasons: list[str] = field(default_factory=list)

    @property
    def ends(self) -> tuple[str, ...]:
        return ends_of(self.joint.actuation)

    def has(self, role: str) -> bool:
        """Whether the log has a role, of each transmission."""
        return all(f"{role}{end}" in self.logged for end in self.ends)


def recommend(
    log: Log | LogReader, device: Device, *, joints: Sequence[str] | None = None
) -> Recommendation:
    """Say which method, side and settings suit a log, and why; nothing is estimated.

    The rules, in their order (docs, *Which method?*):

    1. A measured torque is used: no constant of motor or link is needed.
    2. Of motor and link side the one that the log and the device file allow.
    3. Where both can, the motor's, unless the link's is better founded: the motor's load drowns in
       noise and the link's does not, or the motor's friction is not described behind a gear while
       the link's load is loud.
    4. Unknown friction and inertia are fitted, but inertia and damping together only where the
       motion is more than one sine.
    5. Rows go through the low-pass; on the link side through a window where the load is faint.

    Args:
        log: from ``read_log`` or ``open_log``; its first piece is looked at.
        device: from ``load_device``.
        joints: names of the joints wanted; ``None``: all.

    Raises:
        MethodError: the log lacks a joint of the device.
    """
    names = log_names(log, device.only(joints))
    roles = log_roles(log)
    first = log if isinstance(log, Log) else next(iter(log))
    cases = {}
    for joint in device.joints:
        if joint.name in names:
            own = names[joint.name]
            motion = motion_of(first.joints[own], joint, device, log.period)
            cases[joint.name] = _Case(joint, device, roles[own], motion)
    found = {name: _advice(case) for name, case in cases.items()}
    if device.robot is not None:
        found = _one_side(found, cases)
    motions = {name: case.motion for name, case in cases.items()}
    return Recommendation(log.source, found, motions)


def _advice(case: _Case, side: str | None = None) -> Advice:
    """Apply the rules to a joint; ``side``: already chosen for the whole arm."""
    case.reasons = []
    if not case.has("theta") or "q" not in case.logged:
        why = "The log lacks a position: every method reads link and motor positions."
        return Advice(case.joint.name, None, "motor", "estimated", None, None, (why,), ())
    torque = "sensor" if side is None and case.has("torque_measured") else "estimated"
    if torque == "sensor":
        case.reasons.append(
            "The elastic torque is measured: no constant of motor or link is needed and friction "
            "does not matter. An error of the sensor's scale is one of the stiffness."
        )
        chosen: str | None = "motor"
    else:
        chosen = side or _side(case)
    if chosen is None:
        return Advice(case.joint.name, None, "motor", torque, None, None, tuple(case.reasons), ())
    fit, window, told = settings_for(case.joint, case.device, chosen, torque, case.motion)
    return Advice(
        joint=case.joint.name,
        method="weak",
        side=chosen,
        torque=torque,
        fit=fit,
        window=window,
        reasons=(*case.reasons, *told),
        cautions=cautions(case.joint, case.device, chosen, torque, case.motion),
    )


def _side(case: _Case) -> str | None:
    """Rules 2 and 3."""
    motor, link = _motor_lacks(case), _link_lacks(case)
    if motor and link:
        case.reasons.append(f"The motor side lacks {motor}; the link side lacks {link}.")
        return None
    if motor:
        case.reasons.append(f"The link side: the motor side lacks {motor}.")
        return "link"
    if link:
        case.reasons.append(f"The motor side: the link side lacks {link}.")
        return "motor"
    why = _link_better(case)
    if why is not None:
        case.reasons.append(f"The link side: {why}")
        return "link"
    case.reasons.append(
        "The motor side: its inertia and torque are known, and what touches the link, or hangs on "
        "it, does not count."
    )
    return "motor"


def _motor_lacks(case: _Case) -> str | None:
    if not case.joint.motors:
        return "a [motor] table with its inertia"
    if not case.has("tau"):
        return f"the channel {' and '.join(f'tau{end}' for end in case.ends)}"
    return None


def _link_lacks(case: _Case) -> str | None:
    link = case.joint.link
    if case.device.robot is None and (link is None or link.inertia is None):
        return "the link's inertia ([link] inertia, or a [robot])"
    return None


def _link_better(case: _Case) -> str | None:
    """Say why the link's balance is better founded than the motor's; None: it is not."""
    motion, joint = case.motion, case.joint
    motor = motion.motor if motion is not None else None
    link = motion.link if motion is not None else None
    # An arm's load is not weighed here: what is known of a pendulum's stands in for nothing.
    loud = link is not None and link.ratio >= LOUD
    if motor is not None and motor.ratio < FAINT and loud and link is not None:
        return f"its load is {link.ratio:.3g} times its noise, the motor's {motor.ratio:.3g} times."
    bare = [m for m in joint.motors if not m.damping.value and not m.coulomb.value]
    if bare and abs(bare[0].gear_ratio) > 1.0 and loud and link is not None:
        return (
            "the device file says nothing of the friction of motor and gear, and the link's load "
            f"is {link.ratio:.3g} times its noise."
        )
    return None


def _one_side(found: dict[str, Advice], cases: Mapping[str, _Case]) -> dict[str, Advice]:
    """Joints of an arm are estimated from one side: the motors', if every joint has them."""
    sides = {advice.side for advice in found.values() if advice.torque == "estimated"}
    if len(sides) < 2:
        return found
    side = "link" if any(_motor_lacks(case) for case in cases.values()) else "motor"
    told = "The joints of an arm are estimated from one side, because its momentum needs all."
    again = {name: _advice(case, side) for name, case in cases.items()}
    return {name: replace(a, reasons=(*a.reasons, told)) for name, a in again.items()}
