"""What a log holds of one joint: channels recorded, counts of its encoders, columns of truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.motion import Truth
from rotatum.simulation.sensing.sensors import LOGGED, Sensors
from rotatum.simulation.sensing.trajectory import Trajectory

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

Array = NDArray[np.float64]


def recorded(joint: Joint, *, external: bool) -> tuple[str, ...]:
    """Return the roles that sensors record of a joint."""
    return (*LOGGED[joint.actuation], *(("tau_ext",) if external else ()))


def encoder_counts(joint: Joint, sensors: Sensors) -> dict[str, float]:
    """Return role -> counts per turn: the sensors' own, or those of the device's encoders."""
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


def law_truth(
    truth: Truth, time: Array, late: Array | float = 0.0, every: int = 1
) -> dict[str, Array]:
    """Return "stiffness_true", "torque_true", and those of each of several transmissions, (K,).

    Parameters
    ----------
    truth, time
        Of the motion, and its instants (N,) [s].
    late, every
        Wanted for one in `every` instants, that much after it (K,) [s]; straight in between.
    """
    stiffness = [_at(x, time, late, every) for x in truth.stiffness]
    torque = [_at(x, time, late, every) for x in truth.torque]
    columns = {
        "stiffness_true": np.sum(stiffness, axis=0),
        "torque_true": np.sum(torque, axis=0),
    }
    if len(stiffness) > 1:
        for m, (one, other) in enumerate(zip(stiffness, torque, strict=True), start=1):
            columns |= {f"stiffness{m}_true": one, f"torque{m}_true": other}
    return columns


def motion_truth(
    trajectory: Trajectory, joint: Joint, late: Array | float = 0.0, every: int = 1
) -> dict[str, Array]:
    """Return "q_true", "theta_true" and so on [rad], and "dq_true" and so on [rad/s], (K,).

    Parameters
    ----------
    trajectory, joint
        What moved; its set-point counts where the joint has one.
    late, every
        As in `law_truth`.
    """
    then = trajectory.before(-late, every)
    roles = [role for role in then.position if role in LOGGED[joint.actuation]]
    columns = {f"{role}_true": then.position[role] for role in roles}
    return columns | {f"d{role}_true": then.velocity[role] for role in roles}


def _at(x: Array, time: Array, late: Array | float, every: int) -> Array:
    if np.ndim(late) == 0 and late == 0.0:
        return x[::every]
    return np.interp(time[::every] + late, time, x)
