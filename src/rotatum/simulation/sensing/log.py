"""From the motion of a device to the log its sensors wrote of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError, check_names
from rotatum.logs.log import Log
from rotatum.simulation.motion import Motion
from rotatum.simulation.sensing.faults import readings
from rotatum.simulation.sensing.inertial import InertialFaults, inertial_readings
from rotatum.simulation.sensing.joint_log import encoder_counts, law_truth, motion_truth, recorded
from rotatum.simulation.sensing.rows import Rows, with_rows_of, with_shared_rows
from rotatum.simulation.sensing.sensors import Sensors

if TYPE_CHECKING:
    from rotatum.models.device import Device

Array = NDArray[np.float64]
_COMMANDED = ("tau", "tau1", "tau2")


def log_of(
    motion: Motion,
    device: Device,
    *,
    sensors: Mapping[str, Sensors] | None = None,
    inertial: Mapping[str, InertialFaults] | None = None,
    control: int = 1,
    every: int = 1,
    seed: int = 0,
    external: frozenset[str] = frozenset(),
) -> Log:
    """Return the log of a device's motion: all joints, inertial sensors, and the truth.

    Truth columns belong to the instants the log's clock names, before any clock skew, whatever the
    sensors' delays: "stiffness_true" and "torque_true" of the elastic laws (and of each of two
    transmissions), "q_true", "theta_true" and so on of the positions, with a "d" in front the
    velocities.

    Parameters
    ----------
    motion
        What moved.
    device
        Says which joints, encoders and inertial sensors there are.
    sensors
        Joint -> faults; none but the device's encoder counts where not given. Faults of whole rows
        (jitter, clock, repeats, dropouts) are the log's: the joints named here agree on them.
    inertial
        Accelerometer or gyroscope -> faults.
    control
        Instants of the motion for which a commanded torque is held.
    every
        One in so many instants of the motion is sampled. Torques are logged as "held" where each
        lasts until the next row: commands where `every` divides `control`, "tau_ext" where it is 1.
    seed
        Of all random faults: each joint and each sensor has its own.
    external
        Names of the joints that record "tau_ext".

    Raises `RotatumError` for unknown joints or sensors, faults that do not fit a joint or the
    number of samples, joints that disagree on whole rows, and fewer than two samples.
    """
    given = dict(sensors or {})
    _check(motion, device, given, external, control, every)
    shared = with_shared_rows(given)
    period = every * float(motion.time[1] - motion.time[0])
    rows = Rows(motion.time[::every], period, shared, seed)
    joints = {}
    for number, joint in enumerate(device.joints):
        of_joint = with_rows_of(given.get(joint.name, Sensors()), shared)
        channels = readings(
            motion.joints[joint.name],
            of_joint,
            roles=recorded(joint, external=joint.name in external),
            counts=encoder_counts(joint, of_joint),
            seed=seed,
            number=number,
            every=every,
        )
        channels |= law_truth(motion.truth[joint.name], motion.time, rows.shown_late, every)
        channels |= motion_truth(motion.joints[joint.name], joint, rows.shown_late, every)
        joints[joint.name] = channels
    faults = inertial or {}
    mounted = inertial_readings(motion, device, faults, seed=seed, every=every, late=rows.late)
    clock = rows.clock
    held = _held(control, every)
    return Log(
        source=f"simulation of {device.name}, seed {seed}",
        time=rows.stamps,
        joints=_rows_of(joints, rows.kept),
        holds={
            name: {role: "held" if role in held else "sampled" for role in channels}
            for name, channels in joints.items()
        },
        clock=clock,
        warnings=(*clock.describe(), *motion.warnings, *_end(motion)),
        inertial=_rows_of(mounted, rows.kept),
    )


def _rows_of(
    columns: Mapping[str, Mapping[str, Array]], kept: NDArray[np.int64]
) -> dict[str, dict[str, Array]]:
    return {name: {part: x[kept] for part, x in of.items()} for name, of in columns.items()}


def _held(control: int, every: int) -> frozenset[str]:
    """Return the roles of torques that last from each row to the next."""
    commanded = _COMMANDED if control % every == 0 else ()
    # an external torque may change at every instant of the motion
    return frozenset((*commanded, *(("tau_ext",) if every == 1 else ())))


def _end(motion: Motion) -> tuple[str, ...]:
    if motion.stopped is None:
        return ()
    return (f"the simulation stopped after {motion.time[-1]:.6g} s: {motion.stopped}",)


def _check(
    motion: Motion,
    device: Device,
    sensors: Mapping[str, Sensors],
    external: frozenset[str],
    control: int,
    every: int,
) -> None:
    if control < 1 or every < 1:
        what = "torques are held, and rows taken, for a whole number of instants"
        raise RotatumError(what, where="control, every", value=(control, every))
    if motion.time[::every].size < 2:
        what = "a log needs at least two samples"
        raise RotatumError(what, where=device.name, value=int(motion.time[::every].size))
    joints = {joint.name: joint for joint in device.joints}
    for where, names in (("sensors", sensors), ("external", sorted(external))):
        check_names(names, tuple(joints), what="the device has no such joint", where=where)
    for name, of_joint in sensors.items():
        of_joint.fit(joints[name].actuation)
