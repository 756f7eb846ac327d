"""Inputs for the test vector of an export: a log's, or made-up ones that try everything."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.columns import setpoint_scale
from rotatum.estimators.estimator import Estimator
from rotatum.estimators.groups import Group, batch_records
from rotatum.evaluation.inputs import log_names, mean_zeros
from rotatum.logs import Log, LogReader
from rotatum.models import Device, Joint
from rotatum.record import Records

__all__ = ["SAMPLES", "check_side", "group_of", "holds_of", "period_of", "records", "zeros_of"]

SAMPLES = 100_000  # long enough for every window to fill and every verdict to be given
_GAPS = ((7_000, 3), (9_000, 60))  # first missing sample and how many: bridged, and too long
_NOT_FINITE, _REPEATED = 11_000, 12_000
_STIFFNESS, _RANGE = 100.0, 0.01  # N m/rad and rad, where the device does not say

Array = NDArray[np.float64]


def period_of(device: Device, asked: float | None, log: LogReader | None) -> float:
    """Return the sample period: asked for, the log's, or the device file's.

    Parameters
    ----------
    device : to be exported.
    asked : s, or None.
    log : for the test vector, or None.

    Raises
    ------
    MethodError if nobody says.
    """
    found = asked or (log.period if log is not None else device.period)
    if found is None:
        hint = "Give --period SECONDS, --log LOG, or [estimator] period in the device file."
        raise MethodError("the sample period is not known", where=device.source, hint=hint)
    return found


def zeros_of(device: Device, log: LogReader | None) -> dict[str, list[float]]:
    """Return the deflections at rest of joints that take the log's mean.

    Parameters
    ----------
    device : to be exported.
    log : for the test vector, or None.
    """
    return {} if log is None else mean_zeros(log, device, log_names(log, device))


def holds_of(device: Device, log: LogReader | None) -> dict[str, Mapping[str, str]] | None:
    """Return which channels of the log are held; None leaves it to the device file.

    Parameters
    ----------
    device : to be exported.
    log : for the test vector, or None.
    """
    if log is None:
        return None
    return {j.name: log.holds.get(log_names(log, device)[j.name], {}) for j in device.joints}


def check_side(device: Device, side: str | None) -> None:
    """Refuse the link side of an arm.

    Parameters
    ----------
    device : to be exported.
    side : asked for, or None.

    Raises
    ------
    MethodError saying what can be exported instead.
    """
    sides = {side or joint.estimator.side for joint in device.joints}
    if device.robot is not None and "link" in sides:
        raise MethodError(
            "the link side of an arm needs the arm's momentum and forces at every sample, which "
            "a robot model computes: there is no C of it",
            where=device.source,
            hint="--side motor can be exported; so can one --joint whose [link] has an inertia, "
            "as a pendulum of its own.",
        )


def group_of(loop: Estimator) -> Group:
    """Return the joints of an estimator, which must all run the same code.

    Parameters
    ----------
    loop : the estimator.

    Raises
    ------
    MethodError if joints differ in method or columns.
    """
    if len(loop.groups) > 1:
        names = ["+".join(p.joint.name for p in group.prepared) for group in loop.groups]
        raise MethodError(
            "these joints differ in method or columns, so each kind is an export of its own",
            where=loop.device.source,
            allowed=names,
            hint="Choose with --joint NAME.",
        )
    return loop.groups[0]


def records(loop: Estimator, group: Group, log: LogReader | None) -> Records:
    """Return ``SAMPLES`` input records; a shorter log comes again and again.

    Parameters
    ----------
    loop : the estimator.
    group : of its joints.
    log : to take them from; None: made up.

    Raises
    ------
    MethodError if the log lacks a channel.
    """
    u = batch_records(group, SAMPLES)
    if log is None:
        made = [_made_up(p.joint, loop.period, p.settings.side) for p in group.prepared]
        time = made[0]["time"]
    else:
        pieces = list(log)
        made = [
            _logged(pieces, log_names(log, loop.device)[prepared.joint.name], group, log.source)
            for prepared in group.prepared
        ]
        time = _again(np.concatenate([piece.time for piece in pieces]), loop.period)
    u["time"] = time[:, np.newaxis]
    for place, channels in enumerate(made):
        for role in group.roles:
            u[role][:, place] = channels[role]
    return u


def _logged(pieces: list[Log], joint: str, group: Group, source: str) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for role in group.roles:
        if role not in pieces[0].joints.get(joint, {}):
            raise MethodError(f"the log lacks the channel {role} of joint {joint}", where=source)
        found[role] = np.resize(np.concatenate([p.joints[joint][role] for p in pieces]), SAMPLES)
    return found


def _again(time: Array, period: float) -> Array:
    """Continue a clock by repeating its steps."""
    steps = np.diff(time, append=time[-1] + period)
    shifts = np.concatenate([[0.0], np.cumsum(np.resize(steps, SAMPLES - 1))])
    return np.asarray(time[0] + shifts)


def _made_up(joint: Joint, period: float, side: str) -> dict[str, Array]:
    """Return a motion that obeys the balances of that side, with gaps and bad samples in it."""
    missing = np.concatenate([np.arange(first, first + many) for first, many in _GAPS])
    kept = np.setdiff1d(np.arange(SAMPLES + missing.size), missing)
    t = period * kept
    slow = min(1.0, 0.02 / period)  # no faster than the sampling can follow
    q = _sines(t, ((0.3, 0.2 * slow, 0.0), (0.05, 1.3 * slow, 0.5)))
    found = {"time": t, "q": _counted(q[0], joint.encoders.resolution("link"))}
    setpoint = np.zeros_like(t)
    if joint.actuation == "serial":
        scale = setpoint_scale(joint)
        wave = _sines(t, ((0.9, 0.07 * slow, 0.3),))[0]
        found["setpoint"] = scale.logged_middle + scale.logged_half * wave
        setpoint = scale.middle + scale.half * wave
    reach = 0.8 * (joint.basis.deflection_range or _RANGE)
    for i, transmission in enumerate(joint.transmissions):
        end = str(i + 1) if joint.actuation == "antagonistic" else ""
        parts = ((0.6 * reach, 0.9 * slow, 0.2), (0.4 * reach, 2.7 * slow, 1.0 + i))
        phi = _sines(t, parts)
        if side == "link":
            phi = (_loaded(joint, q, reach) + 0.2 * (-1.0) ** i * phi[0], *phi[1:])
        elastic = _STIFFNESS * phi[0]
        if transmission.law is not None:
            elastic = transmission.torque(phi[0], setpoint)
        theta, dtheta, ddtheta = (a - b for a, b in zip(q, phi, strict=True))
        tau = -elastic
        for motor in joint.motors[i : i + 1]:
            inertia = motor.reflected_inertia
            tau = tau + motor.reflected_damping.value * dtheta
            tau = tau + motor.reflected_coulomb.value * np.sign(dtheta)
            tau = tau + (inertia.value if inertia is not None else 0.0) * ddtheta
        (theta if side == "link" else tau)[_NOT_FINITE] = np.nan
        found[f"theta{end}"] = _counted(theta, joint.encoders.resolution("motor"))
        found[f"tau{end}"], found[f"torque_measured{end}"] = tau, elastic
    t[_REPEATED] = t[_REPEATED - 1]
    return found


def _loaded(joint: Joint, q: tuple[Array, Array, Array], reach: float) -> Array:
    """Return the deflection of a linear spring under the link's load, as far as it reaches."""
    link = joint.link
    if link is None or link.inertia is None:
        return np.zeros_like(q[0])
    load = link.inertia.value * q[2] + link.damping.value * q[1]
    load = load + link.gravity_torque * np.sin(q[0])
    return np.asarray(-reach * load / np.abs(load).max())


def _sines(t: Array, parts: tuple[tuple[float, float, float], ...]) -> tuple[Array, Array, Array]:
    """Return a sum of sines (amplitude, Hz, phase) with its two derivatives."""
    value, rate, bend = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for amplitude, frequency, phase in parts:
        w = 2.0 * np.pi * frequency
        value += amplitude * np.sin(w * t + phase)
        rate += amplitude * w * np.cos(w * t + phase)
        bend -= amplitude * w**2 * np.sin(w * t + phase)
    return value, rate, bend


def _counted(angle: Array, step: float | None) -> Array:
    return angle if step is None else step * np.round(angle / step)
