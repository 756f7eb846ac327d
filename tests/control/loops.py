"""Arms to control, told wrong, and the loop around them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotatum.control import Desired, StateFeedback
from rotatum.logs.log import Log
from rotatum.models.device import Device, device_from_tables
from rotatum.models.quantity import Uncertain
from rotatum.models.transmission import Transmission
from rotatum.simulation import Seen, simulate
from rotatum.simulation.drivers.arm_control import ArmControl
from rotatum.simulation.sensing.live import LiveSensors, Readings

Array = NDArray[np.float64]
Estimate = Callable[[Readings], Array]
"""What the sensors show -> theta, q, theta', q' in rows, (4, n)."""

PERIOD = 1e-3


def without_friction(device: Device) -> Device:
    """Return the device with motors that rub nowhere."""
    none = {"damping": Uncertain(0.0), "coulomb": Uncertain(0.0)}
    joints = tuple(
        joint.model_copy(
            update={"motors": tuple(motor.model_copy(update=none) for motor in joint.motors)}
        )
        for joint in device.joints
    )
    return replace(device, joints=joints)


def told_wrong(device: Device, stiffness: float) -> Device:
    """Return the arm as its controller is told: no payload, springs that many times as stiff."""
    joints = []
    for joint in device.joints:
        spring = joint.transmission
        told = {"law": "linear", "stiffness": spring.given["stiffness"][0] * stiffness}
        other = Transmission.model_validate({**told, "damping": spring.damping})
        joints.append(joint.model_copy(update={"transmissions": (other,)}))
    assert device.robot is not None
    bare = device.robot.model_copy(update={"payload": None})
    names = tuple(joint.name for joint in device.joints)
    return replace(device, joints=tuple(joints), robot=bare.of(names, device.source))


def planar_arm() -> Device:
    """Return a planar 2R arm of series joints, its second rotor coupled to the first link."""
    joint = {
        "motor": {"inertia": 0.05},
        "transmission": {"law": "linear", "stiffness": 400.0, "damping": 0.8},
    }
    tables = {
        "name": "planar",
        "joint": [{"name": "shoulder", **joint}, {"name": "elbow", **joint}],
        "robot": {
            "model": "planar",
            "lengths": [0.4, 0.3],
            "masses": [2.0, 1.0],
            "coupling": [[0.0, 0.01], [0.0, 0.0]],
        },
    }
    return device_from_tables(tables, "planar.toml")


def at_rest(desired: Desired, names: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """Return where the joints start."""
    rows = zip(names, desired.q[0].tolist(), desired.theta[0].tolist(), strict=True)
    return {name: {"q": q, "theta": theta} for name, q, theta in rows}


def closed_loop(
    device: Device,
    desired: Desired,
    law: StateFeedback,
    *,
    sensors: LiveSensors | None = None,
    estimate: Estimate | None = None,
) -> Log:
    """Return the log of a device that follows a motion under a law.

    With `sensors` the law gets what `estimate` makes of their readings, else the true state.
    """
    names = tuple(joint.name for joint in device.joints)

    def controller(seen: Seen) -> Array:
        if sensors is None or estimate is None:
            state = true_state(seen, names)
        else:
            state = estimate(sensors.read(seen))
        return law.torques(desired.state(seen.time), desired.torques(seen.time), state)

    return simulate(
        device,
        seconds=desired.time.size * PERIOD,
        period=PERIOD,
        drives=ArmControl(controller, device.joints).drives(),
        start=at_rest(desired, names),
    )


def true_state(seen: Seen, names: tuple[str, ...]) -> Array:
    """Return theta, q, theta', q' in rows, (4, n)."""
    theta, dtheta = (
        np.concatenate([of[name] for name in names]) for of in (seen.theta, seen.dtheta)
    )
    return np.array([theta, seen.q, dtheta, seen.dq])


def vibration(log: Log, joint: str, stop: float) -> float:
    """Return the integral of (q - its final value)^2 from `stop` on [rad^2 s]."""
    q = log.joints[joint]["q_true"]
    after = q[log.time >= stop - 0.5 * PERIOD]
    return float(np.sum((after - np.mean(after[-50:])) ** 2)) * PERIOD
