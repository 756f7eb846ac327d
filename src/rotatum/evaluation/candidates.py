"""The methods a comparison tries, and what keeps one from a joint: a sentence, not an error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from rotatum.errors import RotatumError
from rotatum.estimators.quantities import columns_of
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.shapes import roles
from rotatum.estimators.widths import filed_width
from rotatum.evaluation.motion import LONG
from rotatum.models import Device, Joint

__all__ = ["CANDIDATES", "Candidate", "Widths", "obstacle", "variant"]


class Candidate(NamedTuple):
    """One line of a comparison.

    Args:
        name: of the method in the table.
        method, side, torque: as ``estimate`` takes them.
        windowed: whether rows go through a window and not through a low-pass or an observer.
    """

    name: str
    method: str
    side: str
    torque: str = "estimated"
    windowed: bool = False

    @property
    def label(self) -> str:
        """Name and side, as curves are named."""
        return f"{self.name}, {self.side} side"


CANDIDATES = (
    Candidate("weak", "weak", "motor"),
    Candidate("weak, window", "weak", "motor", windowed=True),
    Candidate("algebraic", "algebraic", "motor", windowed=True),
    Candidate("residual", "residual", "motor"),
    Candidate("weak, torque sensor", "weak", "motor", "sensor"),
    Candidate("weak", "weak", "link"),
    Candidate("weak, window", "weak", "link", windowed=True),
    Candidate("rotatum", "rotatum", "link"),
)


class Widths(NamedTuple):
    """What is asked of all candidates alike; None: the device file's, then the default.

    Args:
        cutoff: of those with a low-pass or an observer, rad/s.
        window: of those with a window, s.
        fit: columns fitted beside the stiffness; each candidate takes those it can.
        suited: joint to the window that suits its motion, s: the default of ``weak``.
    """

    cutoff: float | None = None
    window: float | None = None
    fit: tuple[str, ...] | None = None
    suited: Mapping[str, float] = MappingProxyType({})


def variant(device: Device, candidate: Candidate, widths: Widths) -> Device:
    """Return the device with ``[estimator]`` as this candidate can have it.

    A width of the other kind is left out, and so are fitted quantities that this side or method
    has not.

    Args:
        device: as described.
        candidate: what is to run.
        widths: asked for.
    """
    allowed = columns_of(candidate.method, candidate.side, candidate.torque, device)
    joints = []
    for joint in device.joints:
        filed = joint.estimator
        told = {
            "method": candidate.method,
            "side": candidate.side,
            "torque": candidate.torque,
            "cutoff": _cutoff(candidate, widths, joint),
            "window": _window(candidate, widths, joint),
            "fit": _fit(filed.fit if widths.fit is None else widths.fit, allowed),
        }
        joints.append(joint.model_copy(update={"estimator": filed.model_copy(update=told)}))
    return replace(device, joints=tuple(joints))


def obstacle(
    joint: Joint, device: Device, candidate: Candidate, period: float, logged: Sequence[str]
) -> str | None:
    """Say why a candidate cannot estimate a joint; None: it can.

    Args:
        joint: of ``device``, a ``variant``.
        device: whose arm the link side needs.
        candidate: to be run.
        period: of the log, s.
        logged: roles the log has of the joint.
    """
    needed = roles(joint.actuation, candidate.torque, candidate.side)
    missing = [role for role in needed if role not in logged]
    if missing:
        return f"the log has no {' and no '.join(missing)}"
    try:
        settle(joint, device, period, Request())
    except RotatumError as error:
        return f"{error.what}. {error.hint}" if error.hint else error.what
    return None


def able(
    device: Device,
    candidate: Candidate,
    period: float,
    logged: Mapping[str, Sequence[str]],
    wanted: Sequence[str],
) -> tuple[list[str], dict[str, str]]:
    """Return the joints to run, and the sentence that keeps a wanted one from it.

    Args:
        device: a ``variant``.
        candidate: to be run.
        period: of the log, s.
        logged: joint of the device to the roles the log has of it.
        wanted: names of the joints asked for; an arm on its link side needs all the others too.
    """
    arm = candidate.side == "link" and device.robot is not None
    names = [joint.name for joint in device.joints if arm or joint.name in wanted]
    kept_out = {}
    for joint in device.joints:
        if joint.name in names:
            why = obstacle(joint, device, candidate, period, logged[joint.name])
            if why is not None:
                kept_out[joint.name] = why
    if arm and kept_out:
        first, why = next(iter(kept_out.items()))
        told = {name: f"the arm's momentum needs all its joints, and of {first} {why}"
                for name in wanted}  # fmt: skip
        return [], told
    return [name for name in names if name not in kept_out], kept_out


def _cutoff(candidate: Candidate, widths: Widths, joint: Joint) -> float | None:
    if candidate.windowed:
        return None
    return widths.cutoff or filed_width(joint.estimator, candidate.method)[0]


def _window(candidate: Candidate, widths: Widths, joint: Joint) -> float | None:
    if not candidate.windowed:
        return None
    asked = widths.window or joint.estimator.window
    if candidate.method == "algebraic":
        return asked
    return widths.suited.get(joint.name, LONG) if asked is None else asked


def _fit(told: tuple[str, ...] | None, allowed: tuple[str, ...]) -> tuple[str, ...] | None:
    """Of what is fitted, what can be here; where nothing of it can, the method's own default."""
    if not told:
        return told
    return tuple(name for name in told if name in allowed) or None
