"""Every joint of a device made ready: settings, parameters, strides that do not coincide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rotatum.errors import MethodError
from rotatum.estimators.measured import Measured
from rotatum.estimators.settings import Request, Settings, settle
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.models import Device


def prepare_all(
    device: Device,
    period: float,
    request: Request,
    measured: Mapping[str, Measured],
    holds: Mapping[str, Mapping[str, str]] | None,
    zeros: Mapping[str, Sequence[float]],
) -> tuple[Prepared, ...]:
    """Make every joint of a device ready to run.

    Args:
        device: its joints, and the arm they may belong to.
        period: s.
        request: what is asked of all of them.
        measured: joint to what is known of its signals' noise.
        holds: joint to role to ``"held"`` or ``"sampled"``; None: the device's channels.
        zeros: joint to deflection at rest of each transmission, rad.

    Raises:
        MethodError: a setting, or joints of an arm that are asked for from different sides.
    """
    chosen = [
        settle(joint, device, period, replace(request, measured=measured.get(joint.name)))
        for joint in device.joints
    ]
    chosen = _one_observer(chosen, device)
    sides = {settings.side for settings in chosen}
    if device.robot is not None and len(sides) > 1:
        raise MethodError(
            "the joints of an arm are estimated from one side, because its momentum needs all",
            where=device.source,
            value=sorted(sides),
        )
    found = []
    for i, (joint, settings) in enumerate(zip(device.joints, chosen, strict=True)):
        found.append(
            prepare(
                joint,
                settings,
                period=period,
                holds=_holds(joint.name, joint.channels, holds),
                zeros=zeros.get(joint.name),
                arm=settings.side == "link" and device.robot is not None,
                # Rows of windows are dear: those of several joints come one after the other.
                phase=i * settings.operator.every // len(chosen),
            )
        )
    return tuple(found)


def _one_observer(chosen: list[Settings], device: Device) -> list[Settings]:
    """Give an arm whose rotatum is observed the slowest observer of its joints, to all of them."""
    if device.robot is None or {settings.method for settings in chosen} != {"rotatum"}:
        return chosen
    slowest = min((s.operator for s in chosen), key=lambda operator: operator.width)
    return [
        s
        if s.operator == slowest
        else replace(
            s,
            operator=slowest,
            reasons={**s.reasons, "cutoff": "the slowest of the arm's, differentiated together"},
        )
        for s in chosen
    ]


def _holds(
    name: str, channels: Mapping[str, Any], given: Mapping[str, Mapping[str, str]] | None
) -> Mapping[str, str]:
    if given is not None and name in given:
        return given[name]
    return {role: channel.hold for role, channel in channels.items()}
