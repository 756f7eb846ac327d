"""Accelerometers calibrated on the log they are to be used on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError, MethodError
from rotatum.estimators.full_state.calibration import Calibration, calibrate_static
from rotatum.estimators.full_state.calibration_motion import calibrate_motion
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.estimators.full_state.spells import poses_at_rest
from rotatum.evaluation.inputs import log_names
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.models.inertial import Accelerometer
from rotatum.models.robot.interface import Robot

__all__ = ["Calibrated", "calibrate", "corrected"]

Array = NDArray[np.float64]

LONGEST = 60.0
"""s of a log that are looked at: a bias is known by then, and every row costs a pose of the arm."""
_PASSES = 2
_SETTLED = 0.1  # s after its start, of an observer with the default poles


class Calibrated(NamedTuple):
    """A device and a log whose accelerometers are what was found.

    Args:
        device: its accelerometers sit as they really do.
        log: readings without bias and scale, at the instant of the encoders' samples.
        found: sensor to its calibration.
    """

    device: Device
    log: Log
    found: dict[str, Calibration]


def calibrate(log: Log, device: Device) -> Calibrated:
    """Find bias, misalignment and delay of every accelerometer, and take them off the log.

    Static poses first, links by springs and weight; then the motion, against the links' encoders,
    or without them against the links' positions as observed: with what is not calibrated yet, and
    once more with what that gave. What the log does not tell stays as the device file has it.

    Args:
        log: in memory, evenly sampled, with the device's accelerometers.
        device: with a robot and accelerometers, and what ``StateObserver`` needs.

    Raises:
        MethodError: a device without accelerometers, or a log too short to tell anything.
        LogError: the log lacks a sensor's axis.
    """
    robot = device.build_robot()
    if robot is None or not device.accelerometers:
        raise MethodError(
            "there is nothing to calibrate: no accelerometer on an arm", where=device.source
        )
    names = log_names(log, device)
    part = slice(0, min(log.samples, round(LONGEST / log.period)))
    joints = [log.joints[names[joint.name]] for joint in device.joints]
    theta = np.column_stack([own["theta"][part] for own in joints])
    encoders = all("q" in own and np.isfinite(own["q"][part]).all() for own in joints)
    better = Calibrated(device, log, {})
    for _ in range(1 if encoders else _PASSES):
        if encoders:
            q, first = np.column_stack([own["q"][part] for own in joints]), 0
        else:
            q = _observed(better.log, better.device, names, part)
            first = round(_SETTLED / log.period)
        found = {}
        for sensor in device.accelerometers:
            shown = _readings(log, sensor)[part]
            static = _static(robot, device, sensor, theta, shown, log.period)
            found[sensor.name] = calibrate_motion(
                robot, sensor, log.period, q[first:], shown[first:], prior=static
            )
        better = corrected(log, device, found)
    return better


def corrected(log: Log, device: Device, found: Mapping[str, Calibration]) -> Calibrated:
    """Return a log and a device with what calibrations found taken off.

    A delay is taken off by straight lines between readings: what a reading will have shown that
    much later. A loop in real time cannot do that; it has to delay its encoders instead.

    Args:
        log: in memory.
        device: the log's.
        found: accelerometer to its calibration.
    """
    inertial = {name: dict(axes) for name, axes in log.inertial.items()}
    for sensor in device.accelerometers:
        if sensor.name not in found:
            continue
        own = found[sensor.name]
        better = own.correct(_readings(log, sensor))
        for axis, values in zip(sensor.axes, better.T, strict=True):
            inertial[sensor.name][f"a{axis}"] = np.interp(log.time + own.delay, log.time, values)
    sensors = tuple(
        found[s.name].mounted() if s.name in found else s for s in device.accelerometers
    )
    return Calibrated(
        replace(device, accelerometers=sensors), replace(log, inertial=inertial), dict(found)
    )


def _observed(log: Log, device: Device, names: Mapping[str, str], part: slice) -> Array:
    """Links' positions with the sensors as they are, (N, n) rad."""
    own = [log.joints[names[joint.name]] for joint in device.joints]
    loop = StateObserver(
        device, period=log.period, gyro=0.0, accelerations="accelerometers",
        holds={j.name: log.holds.get(names[j.name], {}).get("tau") == "held"
               for j in device.joints},
    )  # fmt: skip
    theta, tau = (np.column_stack([each[role][part] for each in own]) for role in ("theta", "tau"))
    none = np.zeros_like(theta)
    levers = np.column_stack([each.get("setpoint", none[:, 0])[part] for each in own])
    readings = np.column_stack([_readings(log, sensor)[part] for sensor in device.accelerometers])
    states = loop.run(log.time[part], theta, tau, levers, readings, none[:, :0])
    return np.asarray(states["q_hat"])


def _static(
    robot: Robot, device: Device, sensor: Accelerometer, theta: Array, shown: Array, period: float
) -> Calibration | None:
    """What poses at rest tell; None: there are none."""
    poses = poses_at_rest(robot, device.joints, theta, shown, period)
    if not len(poses.spells):
        return None
    return calibrate_static(robot, sensor, poses.q, poses.readings, poses.std)


def _readings(log: Log, sensor: Accelerometer) -> Array:
    """Readings of a sensor's axes, (N, A) m/s^2."""
    axes = log.inertial.get(sensor.name, {})
    missing = [f"{sensor.name}.a{axis}" for axis in sensor.axes if f"a{axis}" not in axes]
    if missing:
        raise LogError(f"the log lacks the readings {', '.join(missing)}", where=log.source)
    return np.column_stack([axes[f"a{axis}"] for axis in sensor.axes])
