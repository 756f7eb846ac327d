"""Simulate a series-elastic joint into a log with known truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.logs.clock import ClockWatch
from rotatum.logs.log import Log
from rotatum.simulation.excitation import Torque
from rotatum.simulation.faults import logged_rows, readings
from rotatum.simulation.integrate import integrate
from rotatum.simulation.plant import SeriesPlant, plant_of
from rotatum.simulation.sensors import Sensors
from rotatum.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from rotatum.models.joint import Joint


def simulate_series(
    joint: Joint,
    *,
    seconds: float,
    period: float,
    torque: Torque,
    sensors: Sensors | None = None,
    seed: int = 0,
    external: Torque | None = None,
    substeps: int | None = None,
) -> Log:
    """Return the log of a series joint driven from rest by an open-loop motor torque.

    The torque is sampled at the log's instants, limited to the motor's `torque_limit`, and held
    until the next: "tau" is that command. Truth columns belong to the logged instants, whatever
    the sensors' delays: "stiffness_true" [N m/rad] and "torque_true" [N m], the elastic torque
    (damping left out; "torque_measured" has it).

    Parameters
    ----------
    joint
        Device with motor and link inertia and a transmission law.
    seconds, period
        Duration and sampling period [s]; ``round(seconds / period)`` samples from t = 0.
    torque
        Time (N,) -> motor torque (N,) [N m], joint side.
    sensors
        Faults; none but the device's encoder counts if not given.
    seed
        Of all random faults.
    external
        Time (N,) -> torque on the link (N,) [N m]; logged as "tau_ext" if given.
    substeps
        Integration steps per sample; at least 10, chosen for the plant, if not given.

    Raises `DeviceError` for a joint that cannot be simulated, `RotatumError` for impossible
    durations, sensors or torques, and for a motion that runs away.
    """
    plant = plant_of(joint)
    time = _instants(seconds, period)
    tau = _limited(joint, _sampled(torque, time, "torque"))
    tau_ext = np.zeros_like(time) if external is None else _sampled(external, time, "external")
    motion = integrate(plant, time, tau, tau_ext, substeps=substeps)

    sensors = sensors if sensors is not None else Sensors()
    roles = ("q", "theta", "tau", "torque_measured", *(("tau_ext",) if external else ()))
    channels = readings(
        plant, motion, sensors, roles=roles, counts=_counts(joint, sensors), seed=seed
    )
    channels |= _truth(plant, motion)
    rows = logged_rows(time.size, sensors, seed=seed)
    held = ("tau", "tau_ext")
    watch = ClockWatch(period)
    watch.add(time[rows])
    clock = watch.clock()
    return Log(
        source=f"simulation of {joint.name}, seed {seed}",
        time=time[rows],
        joints={joint.name: {role: x[rows] for role, x in channels.items()}},
        holds={joint.name: {role: "held" if role in held else "sampled" for role in channels}},
        clock=clock,
        warnings=tuple(clock.describe()),
    )


def _instants(seconds: float, period: float) -> NDArray[np.float64]:
    if not (period > 0.0 and np.isfinite(seconds) and round(seconds / period) >= 2):
        raise RotatumError(
            "a simulation needs a positive period and at least two of them",
            where="seconds, period",
            value=(seconds, period),
        )
    return period * np.arange(round(seconds / period), dtype=np.float64)


def _sampled(torque: Torque, time: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    values = np.asarray(torque(time), dtype=np.float64)
    if values.shape != time.shape or not np.all(np.isfinite(values)):
        raise RotatumError(
            "a torque must be one finite number for each instant",
            where=name,
            value=values.shape,
            allowed=f"shape {time.shape}",
        )
    return values


def _limited(joint: Joint, tau: NDArray[np.float64]) -> NDArray[np.float64]:
    motor = joint.motors[0]
    if motor.torque_limit is None:
        return tau
    limit = motor.torque_limit * abs(motor.gear_ratio)
    return np.clip(tau, -limit, limit)


def _counts(joint: Joint, sensors: Sensors) -> dict[str, float]:
    if sensors.counts is not None:
        return dict(sensors.counts)
    of_device = {"q": joint.encoders.link, "theta": joint.encoders.motor}
    return {role: counts for role, counts in of_device.items() if counts is not None}


def _truth(plant: SeriesPlant, motion: Trajectory) -> dict[str, NDArray[np.float64]]:
    phi = motion.q - motion.theta
    return {
        "stiffness_true": plant.elastic_stiffness(phi),
        "torque_true": plant.elastic_torque(phi),
    }
