"""Simulate a device, of any joints and with or without an arm, into a log with known truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.logs.log import Log
from rotatum.simulation.drivers.drives import JointDrives, sample_drives
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.moving import Progress, move
from rotatum.simulation.payload import Payload
from rotatum.simulation.plant.bodies import SMOOTHING
from rotatum.simulation.plant.effects import Effects
from rotatum.simulation.plants import plants_of
from rotatum.simulation.sensing.inertial import InertialFaults
from rotatum.simulation.sensing.log import log_of
from rotatum.simulation.sensing.sensors import Sensors

if TYPE_CHECKING:
    from rotatum.models.device import Device

__all__ = ["simulate"]


def simulate(
    device: Device,
    *,
    seconds: float,
    period: float,
    drives: Mapping[str, JointDrives],
    sensors: Mapping[str, Sensors] | None = None,
    inertial: Mapping[str, InertialFaults] | None = None,
    effects: Mapping[str, Effects] | None = None,
    external: Mapping[str, Drive] | None = None,
    payloads: Sequence[Payload] = (),
    start: Mapping[str, Mapping[str, float]] | None = None,
    log_period: float | None = None,
    smoothing: float = SMOOTHING,
    substeps: int | None = None,
    seed: int = 0,
    told: Device | None = None,
    progress: Progress | None = None,
) -> Log:
    """Return the log of a device, driven open loop or by feedback.

    With a table [robot] the links are those of the arm (`rotatum.simulation.plant.arm`), else each
    link is a pendulum of its own. Torques are limited to the motors' `torque_limit` and held for a
    control period. Truth columns belong to the logged instants, whatever the sensors' delays.

    Parameters
    ----------
    device
        Joints with motor inertia and transmission law, and a robot or links' inertia.
    seconds, period
        Duration and control period [s].
    drives
        joint -> role -> function of time or feedback (`rotatum.simulation.drivers`).
    sensors, effects
        joint -> what is wrong with its sensors, and what else its plant does.
    inertial
        accelerometer or gyroscope of the device -> what is wrong with it.
    external
        joint -> torque on its link [N m]; logged as "tau_ext".
    payloads
        Masses the links take up, in no log.
    start
        joint -> where it starts, as in `simulate_joint`.
    log_period
        Of the log's rows [s], the control period times or divided by a whole number; None: the
        control period.
    smoothing
        [rad/s] that the sign of Coulomb friction is regularised over.
    substeps
        Integration steps per sample of joints without an arm; chosen for the plant if not given.
    seed
        Of all random faults.
    told
        The device as the log's reader knows it, for its encoders; None: `device`.
    progress
        Called with samples done and expected.

    Raises `RotatumError` for impossible durations, names, sensors or drives, `DeviceError` for a
    device that cannot be simulated, and `SimulationError` for a motion that runs away or leaves a
    law's range: its `log` is what was simulated until then.
    """
    _check(device, drives, sensors, effects, external, start)
    grid, control, every = grids(period, log_period)
    time = _instants(seconds, grid)
    robot = device.build_robot()
    plants = plants_of(device, effects or {}, smoothing=smoothing)
    pushes = [(external or {}).get(joint.name) for joint in device.joints]
    inputs = [
        sample_drives(joint, plant, time, drives.get(joint.name, {}), push, control=control)
        for joint, plant, push in zip(device.joints, plants, pushes, strict=True)
    ]
    motion = move(
        device,
        robot,
        plants,
        inputs,
        payloads=payloads,
        start=start or {},
        substeps=substeps,
        progress=progress,
    )

    def log() -> Log:
        return log_of(
            motion,
            device if told is None else told,
            sensors=sensors or {},
            inertial=inertial or {},
            control=control,
            every=every,
            seed=seed,
            external=frozenset(external or ()),
        )

    if motion.stopped is not None:
        # too short for the faults asked for, or for a log at all: the reason it stopped comes first
        with suppress(RotatumError):
            motion.stopped.log = log()
        raise motion.stopped
    return log()


def grids(period: float, log_period: float | None) -> tuple[float, int, int]:
    """Return the motion's period [s], samples per control period, and samples per row of the log.

    Raises `RotatumError` unless one period is a whole number of the other.
    """
    rows = period if log_period is None else log_period
    for name, value in (("period", period), ("log_period", rows)):
        if not (value > 0.0 and np.isfinite(value)):
            raise RotatumError("a period must be positive", where=name, value=value)
    slow, fast = max(period, rows), min(period, rows)
    ratio = round(slow / fast)
    if abs(slow / fast - ratio) > 1e-9 * ratio:
        raise RotatumError(
            "the log's period and the control's must be whole multiples of one another",
            where="log_period",
            value=rows,
            allowed=f"{period:g} s times or divided by a whole number",
        )
    return fast, ratio if period > rows else 1, ratio if rows > period else 1


def _instants(seconds: float, period: float) -> NDArray[np.float64]:
    if not (np.isfinite(seconds) and round(seconds / period) >= 2):
        raise RotatumError(
            "a simulation needs at least two periods", where="seconds", value=seconds
        )
    return period * np.arange(round(seconds / period), dtype=np.float64)


def _check(
    device: Device,
    drives: Mapping[str, object],
    sensors: Mapping[str, Sensors] | None,
    effects: Mapping[str, object] | None,
    external: Mapping[str, object] | None,
    start: Mapping[str, object] | None,
) -> None:
    """Refuse joints the device has not, and sensors its joints have not, before anything moves."""
    names = tuple(joint.name for joint in device.joints)
    for where, given in (
        ("drives", drives),
        ("sensors", sensors),
        ("effects", effects),
        ("external", external),
        ("start", start),
    ):
        check_names(given or (), names, what="the device has no such joint", where=where)
    for joint in device.joints:
        if sensors and joint.name in sensors:
            sensors[joint.name].fit(joint.actuation)
