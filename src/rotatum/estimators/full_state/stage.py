"""The observer of one joint as a stage, and its parameters from a design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError, check_names
from rotatum.estimators.full_state.design import Design, forgotten
from rotatum.estimators.full_state.drivetrain import drivetrain_of
from rotatum.estimators.full_state.friction import friction_width
from rotatum.estimators.full_state.poles import (
    DEFAULT,
    FREQUENCY,
    Pair,
    Pairs,
    discretise,
    injection,
)
from rotatum.estimators.guarded import guarded
from rotatum.estimators.samples import MISSING, largest_jump
from rotatum.kernels import luenberger
from rotatum.models.joint import Joint
from rotatum.record import Layout, Records
from rotatum.runtime.stage import Stage

CITES = ("deluca2007",)
CHANNELS = ("theta", "torque", "acceleration", "rate", "coupling")
"""What the guard watches and interpolates, in its order."""

_FASTEST = 0.3  # of pi / period: where a robot's clock is too slow for the default poles
_SCALES = 1000.0  # softest and stiffest are that far from the design's stiffness


def luenberger_stage(*, guard: bool = True) -> Stage:
    """Return the stage of the observer: samples of a joint in, its full state out.

    Args:
        guard: True: a stage of its own, which bridges, refuses and restarts
            (`rotatum.kernels.guard`). False: behind a front that does so for a whole arm, with
            ``fresh``, ``hold`` and ``status`` of the samples as it tells.
    """
    sample = luenberger.LuenbergerSample.layout()
    inner = Stage(
        "luenberger",
        luenberger.LuenbergerParams.layout(),
        luenberger.LuenbergerState.layout(),
        sample,
        luenberger.LuenbergerEstimate.layout(),
        luenberger.init,
        luenberger.step,
        CITES,
        luenberger.hold,
    )
    if not guard:
        return inner
    told = {k: f for k, f in sample.fields.items() if k not in ("fresh", "hold", "status")}
    outer = Layout("JointSample", "One sample of a joint with the acceleration of its link.", told)
    return guarded(inner, outer, CHANNELS, {name: name for name in told})


def design_of(
    joint: Joint,
    period: float,
    pairs: Sequence[Pair] = DEFAULT,
    *,
    stiffness: float | None = None,
    gyro: float = 0.0,
    held: bool | None = None,
) -> Design:
    """Return the design for a joint.

    Args:
        joint: a series or serial joint whose motor's inertia is known.
        period: T [s].
        pairs: poles of the error.
        stiffness: [N m/rad]; None: that of the transmission's law at rest.
        gyro: gain of a gyroscope on the link [1/s], 0: none.
        held: whether the torque is constant until the next sample; None: as the joint's channel
            ``tau`` says, "sampled" without one.

    Raises:
        MethodError: a joint without the constants, or poles that do not fit the period.
    """
    if held is None:
        channel = joint.channels.get("tau")
        held = channel is not None and channel.hold == "held"
    drivetrain = drivetrain_of(joint, stiffness)
    discretise(pairs, period, gyro)
    return Design(drivetrain, period, (pairs[0], pairs[1]), gyro, held)


def pole_pairs(
    joints: Sequence[Joint],
    period: float,
    frequency: float | None,
    damping: float,
    given: Mapping[str, Pairs],
) -> list[Pairs]:
    """Return the poles of each joint.

    Args:
        joints: n joints.
        period: T [s].
        frequency: of joints without their own [rad/s]; None: that of `DEFAULT`, or 0.3 pi / period
            where that is lower.
        damping: of theirs.
        given: joint to its own.

    Raises:
        MethodError: poles of a joint there is not; suggests the nearest.
    """
    names = [joint.name for joint in joints]
    check_names(given, names, what="poles of a joint the device does not have", where="poles")
    common = min(FREQUENCY, _FASTEST * math.pi / period) if frequency is None else frequency
    pair = Pair(float(common), float(damping))
    return [given.get(name, (pair, pair)) for name in names]


def designs_of(
    joints: Sequence[Joint],
    period: float,
    poles: Sequence[Pairs],
    *,
    gyro: float | None,
    turning: Sequence[bool] | NDArray[np.bool_],
    holds: Mapping[str, bool],
) -> tuple[Design, ...]:
    """Return the design of each joint.

    Args:
        joints: n joints.
        period: T [s].
        poles: of each.
        gyro: gain of gyroscopes [1/s]; None: half of the first pair's frequency.
        turning: (n,) whether gyroscopes determine the rate of a joint's link.
        holds: joint to whether its torque is held; else as its channel says.

    Raises:
        MethodError: as `design_of`.
    """
    return tuple(
        design_of(
            joint, period, pairs, held=holds.get(joint.name),
            gyro=(0.5 * pairs[0].frequency if gyro is None else gyro) if told else 0.0,
        )
        for joint, pairs, told in zip(joints, poles, turning, strict=True)
    )  # fmt: skip


def luenberger_params(
    stage: Stage, joints: Sequence[Joint], designs: Sequence[Design], *, change: float = 0.0
) -> Records:
    """Return (n,) params of either stage.

    Args:
        stage: from `luenberger_stage`.
        joints: n joints; of each, the guard reads where its encoder wraps. It has no limit of the
            torque: a motor at its limit gives the torque it is told to.
        designs: one for each.
        change: largest relative change of a stiffness per sample, 0: no limit
            (`largest_relative_rate`); for estimates, not for a law's tangent.

    Raises:
        MethodError: numbers of joints and designs differ, or a design that cannot be.
    """
    if len(joints) != len(designs):
        raise MethodError("every joint needs a design", where="designs", value=len(designs),
                          allowed=str(len(joints)))  # fmt: skip
    if not (math.isfinite(change) and change >= 0.0):
        raise MethodError("must be 0 or more", where="change", value=change)
    params = stage.params.zeros(len(joints))
    for record, joint, design in zip(params, joints, designs, strict=True):
        if "guard" not in (record.dtype.names or ()):
            fill_luenberger(record, design, change)
            continue
        fill_luenberger(record["inner"], design, change)
        _fill_guard(record["guard"], joint, design.period)
    return params


def fill_luenberger(record: Any, design: Design, change: float = 0.0) -> None:
    """Fill ``LuenbergerParams``.

    Args:
        record: to fill.
        design: an observer.
        change: largest relative change of the stiffness per sample, 0: no limit.

    Raises:
        MethodError: a design that cannot be.
    """
    constants = design.drivetrain.checked()
    a = injection(design.pairs, design.gyro)
    record["transition"], record["before"], record["after"] = discretise(
        design.pairs, design.period, design.gyro
    )
    record["gains"] = a
    record["gyro"] = design.gyro
    record["inverse_inertia"] = 1.0 / constants.inertia
    for name in ("damping", "motor_damping", "coulomb", "stiffness"):
        record[name] = getattr(constants, name)
    record["width"] = friction_width(design)
    record["softest"] = constants.stiffness / _SCALES
    record["stiffest"] = constants.stiffness * _SCALES
    record["change"] = change
    record["held"] = int(design.held)
    record["settle"] = forgotten(design)


def _fill_guard(record: Any, joint: Joint, period: float) -> None:
    theta = CHANNELS.index("theta")
    record["period"] = period
    record["missing"] = MISSING
    record["jump"][theta] = largest_jump(period)
    record["wrap"][theta] = joint.encoders.wrap_motor or 0.0
