"""Simulate one elastic joint, of any actuation, into a log with known truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.logs.clock import ClockWatch
from rotatum.logs.log import Log
from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs, sample_drives
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.payload import Payload, added
from rotatum.simulation.plant.bodies import SMOOTHING, Plant, plant_of
from rotatum.simulation.plant.effects import Effects
from rotatum.simulation.plant.run import Course, course_warnings, run_plant, until
from rotatum.simulation.sensing.faults import logged_rows, readings
from rotatum.simulation.sensing.sensors import LOGGED, Sensors
from rotatum.simulation.sensing.trajectory import trajectory

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

LEAST = 2  # samples of a log


def simulate_joint(
    joint: Joint,
    *,
    seconds: float,
    period: float,
    drives: Mapping[str, Drive],
    sensors: Sensors | None = None,
    seed: int = 0,
    external: Drive | None = None,
    substeps: int | None = None,
    start: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    payloads: Sequence[Payload] = (),
    smoothing: float = SMOOTHING,
) -> Log:
    """Return the log of a joint driven open loop.

    Drives are sampled at the log's instants. Torques are limited to the motors' `torque_limit` and
    held until the next instant: the logged "tau" ("tau1", "tau2") is that command. A prescribed
    set-point goes straight from each instant to the next. Truth columns belong to the logged
    instants, whatever the sensors' delays: "stiffness_true" [N m/rad] and "torque_true" [N m], the
    joint's elastic law times its drift, 0 inside the play (damping and hysteresis left out;
    "torque_measured" has them); for an antagonistic joint also those of each transmission,
    "stiffness1_true", "torque1_true" and so on.

    Parameters
    ----------
    joint
        Device with motor and link inertia and a transmission law.
    seconds, period
        Duration and sampling period [s]; ``round(seconds / period)`` samples from t = 0.
    drives
        role -> function of time (N,) -> (N,). Motor torques [N m], joint side: "tau" (series and
        serial), "tau1" and "tau2" (antagonistic). Serial joints need one more: "setpoint", the
        set-point s of the law (a lever arm in m, say), or "setpoint_angle", the angle of its motor
        [rad], or "tau_setpoint", the torque at that motor's output [N m].
    sensors
        Faults; none but the device's encoder counts if not given.
    seed
        Of all random faults.
    external
        Time (N,) -> torque on the link (N,) [N m]; logged as "tau_ext" if given.
    substeps
        Integration steps per sample; at least 10, chosen for the plant so that it keeps its energy
        to 1e-6 in 10 s without damping, if not given.
    start
        Where the joint starts: positions [rad] "q", "theta" ("theta1", "theta2") and, where a
        torque drives the set-point, "setpoint_angle"; velocities [rad/s] with a "d" in front.
        What is not named is zero.
    effects
        What the joint does that its device file does not say: Stribeck and load-dependent friction,
        play, hysteresis, drift of the stiffness.
    payloads
        Masses the link takes up, in no log.
    smoothing
        [rad/s] that the sign of dry friction is regularised over.

    The log's "setpoint" is what the encoder on the set-point's motor shows: its angle, before the
    law of the device's [setpoint]. Where that motor's friction is too fast for the sub-steps it is
    taken without its inertia, and the log's warnings say so.

    The integrator's error, measured against scipy's Radau (rtol 1e-10) over 2 s without Coulomb
    friction, is at most 2e-12 rad for an elbow, the VSA-II and the AwAS, its lever prescribed or
    its set-point motor without inertia. Leaving that inertia out moves the AwAS's set-point motor
    by 9 us times its speed (7e-5 rad at 8 rad/s) and the stiffness by 6e-7 of itself. With Coulomb
    friction regularised over 5 mrad/s the error of a robot's elbow is 1e-6 rad.

    Raises `DeviceError` for a joint that cannot be simulated, `RotatumError` for impossible
    durations, sensors, drives or effects and for a period the joint is too fast for, and
    `SimulationError` for a motion that runs away or leaves a law's range: its `log` is what was
    simulated until then.
    """
    plant = plant_of(joint, smoothing=smoothing, effects=effects)
    sensors = sensors if sensors is not None else Sensors()
    sensors.fit(joint.actuation)
    time = _instants(seconds, period)
    inputs = sample_drives(joint, plant, time, drives, external)
    loads = added(payloads, (joint.name,), time).get(joint.name)
    course = run_plant(plant, inputs, start=start, substeps=substeps, added=loads)
    if course.stopped is None:
        return _log(joint, plant, inputs, course, sensors, external is not None, seed)
    if course.at.size >= LEAST:
        done = until(inputs, course.at.size)
        course.stopped.log = _log(joint, plant, done, course, sensors, external is not None, seed)
    raise course.stopped


def _log(
    joint: Joint,
    plant: Plant,
    inputs: Inputs,
    course: Course,
    sensors: Sensors,
    external: bool,
    seed: int,
) -> Log:
    time = inputs.time
    roles = (*LOGGED[joint.actuation], *(("tau_ext",) if external else ()))
    motion = trajectory(plant, inputs, course.at)
    counts = _counts(joint, sensors)
    channels = readings(motion, sensors, roles=roles, counts=counts, seed=seed)
    channels |= _truth(course.at)
    rows = logged_rows(time.size, sensors, seed=seed)
    held = (*plant.torque_roles, "tau_ext")
    watch = ClockWatch(float(time[1] - time[0]))
    watch.add(time[rows])
    clock = watch.clock()
    return Log(
        source=f"simulation of {joint.name}, seed {seed}",
        time=time[rows],
        joints={joint.name: {role: x[rows] for role, x in channels.items()}},
        holds={joint.name: {role: "held" if role in held else "sampled" for role in channels}},
        clock=clock,
        warnings=(*clock.describe(), *course_warnings(plant, course)),
    )


def _instants(seconds: float, period: float) -> NDArray[np.float64]:
    if not (period > 0.0 and np.isfinite(seconds) and round(seconds / period) >= 2):
        raise RotatumError(
            "a simulation needs a positive period and at least two of them",
            where="seconds, period",
            value=(seconds, period),
        )
    return period * np.arange(round(seconds / period), dtype=np.float64)


def _counts(joint: Joint, sensors: Sensors) -> dict[str, float]:
    if sensors.counts is not None:
        return dict(sensors.counts)
    encoders = joint.encoders
    of_device = {
        "q": encoders.link,
        "theta": encoders.motor,
        "theta1": encoders.motor,
        "theta2": encoders.motor,
        "setpoint": encoders.setpoint,
    }
    return {
        role: counts
        for role, counts in of_device.items()
        if counts is not None and role in LOGGED[joint.actuation]
    }


def _truth(at: Records) -> dict[str, NDArray[np.float64]]:
    truth = {"stiffness_true": at["stiffness_total"], "torque_true": at["torque_total"]}
    motors = at["torque"].shape[1]
    if motors > 1:
        for m in range(motors):
            truth[f"stiffness{m + 1}_true"] = at["stiffness"][:, m]
            truth[f"torque{m + 1}_true"] = at["torque"][:, m]
    return truth
