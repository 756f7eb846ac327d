"""The rules of a recommendation after its side: what to fit, which width, what to be wary of."""

from __future__ import annotations

import math

from rotatum.estimators.quantities import columns_of
from rotatum.evaluation.motion import Balance, Motion
from rotatum.models import Device, Joint

__all__ = ["cautions", "settings_for"]

ONE_SINE = 0.95
"""Share of the power in one line above which inertia and damping are not fitted together."""
FEW = 20.0
"""Deflection over its noise below which the encoders are called coarse."""
QUIET = 3.0
"""Load over noise below which a side is said not to be loaded."""
SHORT = 0.5
"""Share of the declared range below which a law of more than one order is extrapolated."""
HEAVY = 0.02
"""Share of the answer that hangs on an inertia's uncertainty before it is fitted."""
FAINT = 10.0
"""Load over noise behind the low-pass below which the link side is given a window."""

Fit = tuple[str, ...] | None


def settings_for(
    joint: Joint, device: Device, side: str, torque: str, motion: Motion | None
) -> tuple[Fit, float | None, list[str]]:
    """Return what to fit, the window to use, and why.

    Args:
        joint, device: as described.
        side, torque: chosen already.
        motion: measured; None: the log is not known.
    """
    told: list[str] = []
    window = _window(joint, side, motion, told)
    filed = joint.estimator.fit
    can = columns_of("weak", side, torque, device)
    own = (joint.estimator.side or "motor") == side
    if filed is not None and own and all(name in can for name in filed):
        told.append("What is fitted is what the device file says.")
        return filed, window, told
    if torque == "sensor":
        return None, window, told
    names = _of_link(joint, told) if side == "link" else _of_motor(joint, motion, told)
    if not names:
        return None, window, told
    usual = () if joint.basis.full else ("offset",)
    return (*names, *usual), window, told


def _window(joint: Joint, side: str, motion: Motion | None, told: list[str]) -> float | None:
    """The link's balance has q'' in it, whose noise a window takes far better than two poles."""
    balance = motion.link if motion is not None and side == "link" else None
    if balance is None or balance.ratio >= FAINT or joint.estimator.window is not None:
        return None
    assert motion is not None  # it has the balance
    seconds = motion.window
    told.append(
        f"A window of {seconds:g} s: behind the low-pass the link's load is only "
        f"{balance.ratio:.2g} times the noise of its acceleration. Rows are {0.5 * seconds:g} s "
        "late."
    )
    return seconds


def _of_link(joint: Joint, told: list[str]) -> tuple[str, ...]:
    link = joint.link
    if link is not None and link.damping.value and link.damping.std is None:
        return ()
    what = "does not say" if link is None or not link.damping.value else "knows only roughly"
    told.append(f"The link's damping is fitted: the device file {what} it.")
    return ("link_damping",)


def _of_motor(joint: Joint, motion: Motion | None, told: list[str]) -> tuple[str, ...]:
    """Rule 4: what is unknown, but not inertia and damping together under one sine."""
    motors = joint.motors
    geared = any(abs(motor.gear_ratio) > 1.0 for motor in motors)
    bare = all(not motor.damping.value and not motor.coulomb.value for motor in motors)
    unknown = any(motor.inertia is None for motor in motors)
    inertia, friction = unknown, geared and bare
    if unknown:
        told.append("The motor's inertia is fitted: the device file does not say it.")
    elif (doubt := _doubt(joint, motion)) > HEAVY:
        inertia = True
        told.append(
            f"The motor's inertia is fitted from its value and std: {100.0 * doubt:.2g} % of the "
            "answer hang on it."
        )
    damping = friction
    if inertia and friction and motion is not None and motion.line > ONE_SINE:
        damping = False
        told.append(
            f"Damping is not fitted beside inertia: {100.0 * motion.line:.3g} % of the motion's "
            "power is one sine, under which stiffness, inertia and damping are one. Move at more "
            "than one frequency to tell them apart."
        )
    if friction:
        told.append("Friction is fitted: the device file says none, and there is a gear.")
    wanted = {"inertia": inertia, "damping": damping, "coulomb": friction}
    return tuple(name for name, yes in wanted.items() if yes)


def _doubt(joint: Joint, motion: Motion | None) -> float:
    """Relative error of the elastic torque from the motors' inertia, one standard deviation."""
    if motion is None or motion.motor is None:
        return 0.0
    known = [motor.inertia for motor in joint.motors if motor.inertia is not None]
    return max((motion.motor.share * (i.std or 0.0) / i.value for i in known), default=0.0)


def cautions(
    joint: Joint, device: Device, side: str, torque: str, motion: Motion | None
) -> tuple[str, ...]:
    """Return sentences on what stands in the way of a good answer.

    Args:
        joint, device: as described.
        side, torque: chosen.
        motion: measured, or None.
    """
    if motion is None:
        return ()
    told: list[str] = []
    if motion.deflection <= 0.0:
        return ("The deflection does not change: no method can tell a stiffness.",)
    if torque == "estimated":
        balance = motion.link if side == "link" else motion.motor
        told += _on_balance(joint, side, balance)
    told += _on_encoders(motion)
    told += _on_range(joint, motion)
    if torque == "estimated" and side == "motor":
        told += _on_hold(joint)
    return tuple(told)


def _on_balance(joint: Joint, side: str, balance: Balance | None) -> list[str]:
    if balance is None:
        return []
    told = []
    if balance.ratio < QUIET:
        told.append(
            f"The {side} hardly loads the joint: its torque is {balance.ratio:.2g} times its "
            "noise. Move more, or faster."
        )
    if side == "link" and joint.link is not None and joint.link.inertia is not None:
        std = joint.link.inertia.std
        if std is not None:
            percent = 100.0 * balance.share * std / joint.link.inertia.value
            told.append(
                f"The link's inertia is known to {100.0 * std / joint.link.inertia.value:.2g} %, "
                f"which alone is {percent:.2g} % of the stiffness (one std)."
            )
    return told


def _on_encoders(motion: Motion) -> list[str]:
    spread = math.hypot(*motion.noise)
    if spread <= 0.0 or motion.deflection >= FEW * spread:
        return []
    return [
        f"The deflection is only {motion.deflection / spread:.2g} times the noise of the "
        "positions: load the joint more, or use finer encoders."
    ]


def _on_range(joint: Joint, motion: Motion) -> list[str]:
    reach = joint.basis.deflection_range
    if reach is None:
        return []
    share = motion.reach / reach
    if share > 1.0:
        return [
            f"The deflection goes {100.0 * (share - 1.0):.2g} % beyond [basis] deflection_range: "
            "make it larger."
        ]
    if share < SHORT and (joint.basis.orders > 1 or joint.basis.full):
        return [
            f"The motion reaches {100.0 * share:.2g} % of [basis] deflection_range: beyond that "
            "the stiffness is extrapolated."
        ]
    return []


def _on_hold(joint: Joint) -> list[str]:
    channels = [c for role, c in joint.channels.items() if role.startswith("tau")]
    if any(channel.hold == "held" or "hold" in channel.model_fields_set for channel in channels):
        return []
    return [
        "The torque is taken as measured at the samples; if it is a command that is kept until "
        'the next one, say so: [channels] tau = { hold = "held" }.'
    ]
