"""Simulate one elastic joint, of any actuation, into a log with known truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rotatum.logs.log import Log
from rotatum.models.device import Device
from rotatum.simulation.device import simulate
from rotatum.simulation.drivers.drives import JointDrives
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.payload import Payload
from rotatum.simulation.plant.bodies import SMOOTHING
from rotatum.simulation.plant.effects import Effects
from rotatum.simulation.sensing.sensors import Sensors

if TYPE_CHECKING:
    from rotatum.models.joint import Joint


def simulate_joint(
    joint: Joint,
    *,
    seconds: float,
    period: float,
    drives: JointDrives,
    sensors: Sensors | None = None,
    seed: int = 0,
    external: Drive | None = None,
    substeps: int | None = None,
    start: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    payloads: Sequence[Payload] = (),
    smoothing: float = SMOOTHING,
) -> Log:
    """Return the log of a joint, driven open loop or by feedback.

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
        role -> function of time (N,) -> (N,), or feedback on a motor. Motor torques [N m], joint
        side: "tau" (series and serial), "tau1" and "tau2" (antagonistic). Serial joints need one
        more: "setpoint", the set-point s of the law (a lever arm in m, say), or "setpoint_angle",
        the angle of its motor [rad], or "tau_setpoint", the torque at that motor's output [N m].
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
    name = joint.name
    return simulate(
        Device(name, (joint,), source=f"joint {name}"),
        seconds=seconds,
        period=period,
        drives={name: drives},
        sensors=None if sensors is None else {name: sensors},
        effects=None if effects is None else {name: effects},
        external=None if external is None else {name: external},
        payloads=payloads,
        start=None if start is None else {name: start},
        smoothing=smoothing,
        substeps=substeps,
        seed=seed,
    )
