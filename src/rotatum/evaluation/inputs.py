"""What an estimation takes from a log: joints, channels, zeros, the noise of its signals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from rotatum.errors import MethodError
from rotatum.estimators.measured import Measured
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.shapes import ends_of, roles
from rotatum.evaluation.noise import measure
from rotatum.logs import Log, LogReader
from rotatum.models import Device


def measured_signals(
    log: Log | LogReader, device: Device, names: Mapping[str, str]
) -> dict[str, Measured]:
    """Noise of the positions at the log's beginning: a long one is not read twice for it.

    Args:
        log: whose first piece is looked at.
        device: whose joints.
        names: device joint to log joint, from ``log_names``.
    """
    first = next(iter(pieces(log)))
    channels = {joint.name: first.joints[names[joint.name]] for joint in device.joints}
    return measure(channels, device, log.period)


def pieces(log: Log | LogReader) -> Iterable[Log]:
    """Return the pieces of a log: the whole of one, or as they are read."""
    return (log,) if isinstance(log, Log) else log


def batches(log: Log | LogReader, samples: int) -> Iterator[tuple[Log, slice]]:
    """Go through a log: its pieces, each with one after the other of its stretches.

    Args:
        log: whole, or to be read.
        samples: of a stretch, at most.
    """
    for piece in pieces(log):
        for first in range(0, piece.samples, samples):
            yield piece, slice(first, min(first + samples, piece.samples))


def log_roles(log: Log | LogReader) -> dict[str, tuple[str, ...]]:
    """Joint of the log to the roles it has."""
    if isinstance(log, Log):
        return {joint: tuple(roles) for joint, roles in log.joints.items()}
    return dict(log.roles)


def log_names(log: Log | LogReader, device: Device) -> dict[str, str]:
    """Device joint to log joint: by name, or the only one of each.

    Raises:
        MethodError: the log lacks a joint of the device.
    """
    found = log_roles(log)
    if len(device.joints) == 1 and len(found) == 1:
        return {device.joints[0].name: next(iter(found))}
    for joint in device.joints:
        if joint.name not in found:
            raise MethodError(
                "the log has no such joint",
                where=log.source,
                value=joint.name,
                allowed=tuple(found),
            )
    return {j.name: j.name for j in device.joints}


def mean_zeros(
    log: Log | LogReader, device: Device, names: Mapping[str, str]
) -> dict[str, list[float]]:
    """Deflections at rest of joints whose zeros are the mean of the log, rad.

    Args:
        log: read through once per such transmission.
        device: whose joints.
        names: device joint to log joint, from ``log_names``.

    Raises:
        MethodError: one transmission of a pair takes the mean, the other the log's start.
    """
    zeros: dict[str, list[float]] = {}
    for joint in device.joints:
        filed = [transmission.zero for transmission in joint.transmissions]
        if "mean" not in filed:
            continue
        if "first" in filed:
            raise MethodError(
                'one transmission with zero = "mean" needs the other\'s as well, or a number',
                where=f"{device.source}, joint {joint.name}",
                value=filed,
            )
        ends = ends_of(joint.actuation)
        zeros[joint.name] = [
            float(zero)
            if not isinstance(zero, str)
            else _mean_deflection(log, names[joint.name], f"theta{end}")
            for zero, end in zip(filed, ends, strict=True)
        ]
    return zeros


def _mean_deflection(log: Log | LogReader, joint: str, theta: str) -> float:
    total, count = 0.0, 0
    for piece in pieces(log):
        logged = piece.joints[joint]
        deflection = logged["q"] - logged[theta]
        good = np.isfinite(deflection)
        total += float(deflection[good].sum())
        count += int(good.sum())
    return total / max(1, count)


def check_channels(
    log: Log | LogReader, device: Device, request: Request, names: Mapping[str, str]
) -> None:
    """Refuse a log that lacks a channel some joint's method reads.

    Raises:
        MethodError: names the channels, the joint, and what there is.
    """
    found = log_roles(log)
    for joint in device.joints:
        settings = settle(joint, device, log.period, request)
        needed = roles(joint.actuation, settings.torque, settings.side)
        has = found[names[joint.name]]
        missing = [role for role in needed if role not in has]
        if missing:
            hint = None
            if settings.torque == "sensor" and "torque_measured" in has:
                hint = "The joint's total torque does not tell its two transmissions apart."
            what = f"method {settings.method} on the link side"
            if settings.side == "motor":
                what = f"method {settings.method} with {settings.torque} torque"
            raise MethodError(
                f"{what} lacks the channel {', '.join(missing)} of joint {joint.name}",
                where=log.source,
                allowed=f"needs {', '.join(needed)}; the log has {', '.join(has)}",
                hint=hint,
            )
