"""The arm of section V and its sensors, as the cases take them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.full_state.calibration import Calibration, calibrate_static
from rotatum.estimators.full_state.rest import links_at_rest
from rotatum.models import Accelerometer, Device, Gyroscope, load_device
from rotatum.simulation import InertialFaults, Sensors
from rotatum.simulation.sensing.inertial import Links, inertial_units

__all__ = [
    "BIAS",
    "DEVICES",
    "NOISE",
    "PERIOD",
    "SENSOR",
    "arm",
    "calibrated",
    "encoders",
    "faults",
    "joint_counts",
]

Array = NDArray[np.float64]

DEVICES = ("manutec-r3", "kr15-like")
PERIOD = 1e-3  # s
COUNTS = 2.0**20  # of a motor's encoder, per turn of the motor
NOISE = 0.1  # m/s^2 rms, of a MEMS accelerometer
BIAS = 0.2  # m/s^2 on every axis, before calibration
SENSOR = "link4"  # of the ready scenarios deluca2007/...
_PLACE = (0.0, 0.1, 0.1)  # m in the frame of link 4, theirs too
_SAMPLES = 1000  # read at each pose of the calibration


def arm(
    name: str,
    *,
    place: tuple[float, float, float] = _PLACE,
    gyroscope: bool = False,
) -> Device:
    """Return an arm of the catalogue with a three-axial accelerometer on link 4, as in Figure 1.

    Args:
        name: of `DEVICES`.
        place: of the accelerometer in the link's frame [m].
        gyroscope: whether a three-axial one sits there too.
    """
    sensors = (Accelerometer(name=SENSOR, frame="body4", position=place),)
    turning = (Gyroscope(name="gyro4", frame="body4"),) if gyroscope else ()
    return replace(load_device(name), accelerometers=sensors, gyroscopes=turning)


def joint_counts(device: Device) -> dict[str, float]:
    """Return joint -> counts of its motor's encoder per turn of the joint."""
    return {joint.name: COUNTS * abs(joint.motors[0].gear_ratio) for joint in device.joints}


def encoders(device: Device) -> dict[str, Sensors]:
    """Return joint -> its sensors: the motor's encoder, nothing on the link."""
    return {name: Sensors(counts={"theta": n}) for name, n in joint_counts(device).items()}


def faults(*, bias: float = BIAS) -> Mapping[str, InertialFaults]:
    """Return what is wrong with the accelerometer.

    Args:
        bias: on each of its axes [m/s^2].
    """
    return {SENSOR: InertialFaults(noise=NOISE, bias=(bias, bias, bias))}


def calibrated(device: Device, *, seed: int = 7) -> Calibration:
    """Return the accelerometer's bias from six static poses, links from the motors by gravity.

    Args:
        device: with the accelerometer.
        seed: of its noise.
    """
    robot = device.build_robot()
    assert robot is not None  # the catalogue's arms have one
    unit = inertial_units(device, faults(), seed=seed)[0]
    poses, shown = [], []
    for axis2 in (0.2, 0.8, 1.4):
        for axis3 in (-0.6, 0.8):
            q = links_at_rest(robot, device.joints, np.array([0.3, axis2, axis3])).q
            still = np.zeros((_SAMPLES, q.size))
            readings = unit.show(robot, Links(np.tile(q, (_SAMPLES, 1)), still, still))
            poses.append(q)
            shown.append(readings.mean(axis=0))
    std = NOISE / np.sqrt(_SAMPLES)
    return calibrate_static(robot, device.accelerometers[0], np.array(poses), np.array(shown), std)
