"""Inputs for the test vector of an export: a log's, or made-up ones that try everything."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.estimator import CHANNELS, Estimator, Group, batch_records
from rotatum.evaluation.run import log_names
from rotatum.logs import Log, LogReader
from rotatum.models import Device, Joint
from rotatum.record import Records

__all__ = ["SAMPLES", "group_of", "holds_of", "period_of", "records", "zeros_of"]

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


def zeros_of(device: Device, log: LogReader | None) -> dict[str, float]:
    """Return the deflection at rest of joints that take the log's mean.

    Parameters
    ----------
    device : to be exported.
    log : for the test vector, or None.
    """
    wanted = [joint.name for joint in device.joints if joint.transmission.zero == "mean"]
    if log is None:
        return {}
    return {name: log.mean_deflection(log_names(log, device)[name]) for name in wanted}


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
        made = [_made_up(prepared.joint, loop.period) for prepared in group.prepared]
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
        for field in ("q", "theta", group.torque_field):
            u[field][:, place] = channels[field]
    return u


def _logged(pieces: list[Log], joint: str, group: Group, source: str) -> dict[str, Array]:
    role = CHANNELS[group.prepared[0].settings.torque]
    found: dict[str, Array] = {}
    for field, wanted in (("q", "q"), ("theta", "theta"), (group.torque_field, role)):
        if wanted not in pieces[0].joints.get(joint, {}):
            raise MethodError(f"the log lacks the channel {wanted} of joint {joint}", where=source)
        whole = np.concatenate([piece.joints[joint][wanted] for piece in pieces])
        found[field] = np.resize(whole, SAMPLES)
    return found


def _again(time: Array, period: float) -> Array:
    """Continue a clock by repeating its steps."""
    steps = np.diff(time, append=time[-1] + period)
    shifts = np.concatenate([[0.0], np.cumsum(np.resize(steps, SAMPLES - 1))])
    return np.asarray(time[0] + shifts)


def _made_up(joint: Joint, period: float) -> dict[str, Array]:
    """Return a motion that obeys the motor's balance, with gaps and bad samples in it."""
    missing = np.concatenate([np.arange(first, first + many) for first, many in _GAPS])
    kept = np.setdiff1d(np.arange(SAMPLES + missing.size), missing)
    t = period * kept
    slow = min(1.0, 0.02 / period)  # no faster than the sampling can follow
    theta, dtheta, ddtheta = _sines(t, ((0.3, 0.2 * slow, 0.0), (0.05, 1.3 * slow, 0.5)))
    reach = 0.8 * (joint.basis.deflection_range or _RANGE)
    phi, _, _ = _sines(t, ((0.6 * reach, 0.9 * slow, 0.2), (0.4 * reach, 2.7 * slow, 1.0)))
    spring = joint.transmission
    elastic = (spring.stiffness or _STIFFNESS) * phi + (spring.cubic or 0.0) * phi**3
    tau = -elastic
    for motor in joint.motors[:1]:
        inertia = motor.reflected_inertia
        tau = tau + motor.reflected_damping.value * dtheta
        tau = tau + motor.reflected_coulomb.value * np.sign(dtheta)
        tau = tau + (inertia.value if inertia is not None else 0.0) * ddtheta
    t[_REPEATED] = t[_REPEATED - 1]
    tau[_NOT_FINITE] = np.nan
    q = _counted(theta + phi, joint.encoders.resolution("link"))
    theta = _counted(theta, joint.encoders.resolution("motor"))
    return {"time": t, "q": q, "theta": theta, "tau": tau, "torque": elastic}


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
