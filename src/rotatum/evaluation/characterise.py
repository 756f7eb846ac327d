"""Static characterisation: the constants of an elastic law, from a torque sensor over presets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError, MethodError
from rotatum.evaluation.inputs import log_names, log_roles, pieces
from rotatum.evaluation.statics.asking import (
    Asked,
    asked,
    known_constants,
    model_of,
    signals_of,
)
from rotatum.evaluation.statics.fitting import fit
from rotatum.evaluation.statics.joint import Run, joint_of
from rotatum.evaluation.statics.model import LENGTH, Scales, Signal
from rotatum.evaluation.statics.result import Characterisation, JointCharacteristic
from rotatum.evaluation.statics.samples import Samples, cells_of, samples_of
from rotatum.evaluation.statics.warnings import warnings_of
from rotatum.logs import Log, LogReader
from rotatum.models import Device, Joint

__all__ = ["characterise"]

Array = NDArray[np.float64]
_BACKWARD = -0.5  # correlation of torque and deflection from which a sign must be wrong


def characterise(
    log: Log | LogReader,
    device: Device,
    *,
    law: str = "sinh",
    tied: bool = False,
    fit: Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    terms: int = 3,
    max_speed: float | None = None,
    floor: float | None = None,
    joints: Sequence[str] | None = None,
) -> Characterisation:
    """Fit an elastic law to a torque sensor, quasi-statically (trumic2022 section V-A).

    ``tau_measured = sum_i T(q - theta_i - zero_i; constants_i) + offset``, by trust-region
    reflective least squares from several starts, positive constants kept positive. An antagonistic
    joint's sensor on the shaft reads the sum of both transmissions; where ``torque_measured1`` and
    ``2`` are logged each has its own row. Constants that the data do not tell (half of their 95 %
    interval beyond half of their value) have no value.

    Departs from the paper, whose two transmissions always share their constants, whose sensor has
    no offset, and whose relative error takes every sample: here torques below three deviations of
    the sensor's noise are left out of it.

    Args:
        log: from ``read_log`` or ``open_log``; read whole into memory.
        device: from ``load_device``; needs no motor, no link and no law.
        law: name of an elastic law, any but ``table``.
        tied: whether both transmissions of an antagonistic joint share their constants.
        fit: nuisances fitted beside them, of ``offset`` (of each sensor, N m) and ``zero`` (of each
            deflection, rad); ``None``: the offset, and zeros where the file leaves them to the log
            and the law is odd.
        fixed: constants by name that are known, in the law's units.
        terms: coefficients of the laws ``odd_polynomial`` and ``polynomial``.
        max_speed: rad/s of link or motor beyond which a sample is left out; ``None``: four times
            the median.
        floor: N m below which a torque is left out of the relative error; ``None``: three standard
            deviations of the sensor's noise.
        joints: names of the joints wanted; ``None``: all.

    Raises:
        MethodError, RotatumError: no such law, constant or nuisance; suggests the nearest.
        LogError: the log lacks a channel, has too few slow samples, or units that cannot be.
    """
    wanted = asked(law, tied, fit, fixed, terms, device.source)
    for name, value in (("--max-speed", max_speed), ("--floor", floor)):
        if value is not None and not value >= 0.0:
            raise MethodError("must be at least 0", where=name, value=value)
    names = log_names(log, device.only(joints))
    roles = log_roles(log)
    chosen = [joint for joint in device.joints if joint.name in names]
    signals = {j.name: signals_of(j, roles[names[j.name]], wanted, log.source) for j in chosen}
    time, channels = _read(log)
    found: dict[str, JointCharacteristic] = {}
    told: list[str] = []
    for joint in chosen:
        own = signals[joint.name]
        samples = samples_of(
            channels[names[joint.name]],
            time,
            joint,
            own,
            zeros="zero" in wanted.nuisances(joint),
            max_speed=max_speed,
            source=log.source,
        )
        _refuse_backward(samples, own, joint, log.source)
        run = _run(joint, wanted, own, samples)
        found[joint.name] = joint_of(run, floor)
        told += warnings_of(run, found[joint.name])
    return Characterisation(
        source=log.source,
        device=device,
        law=law,
        tied=tied,
        period=log.period,
        joints=found,
        warnings=(*log.warnings, *told),
    )


def _run(joint: Joint, wanted: Asked, signals: tuple[Signal, ...], samples: Samples) -> Run:
    model = model_of(joint, wanted, signals, _scales(samples, wanted))
    cells, starts = cells_of(samples)
    found = fit(model, cells, known_constants(model, joint))
    return Run(joint, model, samples, cells, starts, found)


def _read(log: Log | LogReader) -> tuple[Array, dict[str, dict[str, Array]]]:
    """Return the clock and the channels of a whole log."""
    whole = list(pieces(log))
    channels = {
        name: {role: np.concatenate([p.joints[name][role] for p in whole]) for role in roles}
        for name, roles in whole[0].joints.items()
    }
    return np.concatenate([piece.time for piece in whole]), channels


def _scales(samples: Samples, wanted: Asked) -> Scales:
    torque = float(np.sqrt(np.mean(samples.torque**2)))
    low, high = np.percentile(samples.phi, [0.5, 99.5], axis=1)
    reach = float(np.max(high - low))
    size = float(np.sqrt(np.mean(samples.setpoint**2)))
    length = size if wanted.law.setpoint_unit == "m" and size > 0.0 else LENGTH
    return Scales(torque or 1.0, 0.5 * reach or 1.0, length)


def _refuse_backward(
    samples: Samples, signals: Sequence[Signal], joint: Joint, source: str
) -> None:
    """Refuse a sensor whose torque falls where the deflection grows."""
    for torque, signal in zip(samples.torque, signals, strict=True):
        phi = samples.phi[list(signal.parts)].mean(axis=0)
        if not (np.ptp(phi) > 0.0 and np.ptp(torque) > 0.0):
            what = f"the deflection or {signal.role} of joint {joint.name} never changes"
            raise LogError(what, where=source)
        alike = float(np.corrcoef(phi, torque)[0, 1])
        if alike < _BACKWARD:
            raise LogError(
                f"{signal.role} of joint {joint.name} falls where q - theta grows",
                where=source,
                value=round(alike, 2),
                allowed="a correlation above 0",
                hint=f"In the device's [channels]: {signal.role} = {{ sign = -1 }}.",
            )
