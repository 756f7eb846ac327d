"""A law in closed loop on a simulated device: what it does, and what it was told of the state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.control import Desired, StateFeedback
from rotatum.errors import MethodError
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.evaluation.loop.observed import ObservedState, true_state
from rotatum.logs import Log
from rotatum.models.device import Device
from rotatum.simulation import (
    ArmControl,
    InertialFaults,
    LiveSensors,
    Readings,
    Seen,
    Sensors,
    simulate,
)

__all__ = ["TAIL", "ClosedLoop", "StateEstimate", "at_rest", "closed_loop", "vibration"]

Array = NDArray[np.float64]

StateEstimate = Callable[[Readings], Array]
"""What the sensors show -> theta, q, theta', q' in rows, (4, n)."""

TAIL = 0.05
"""s at the end over which a link is taken to have come to rest."""


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """A run in closed loop.

    Attributes:
        desired: states and torques that were asked for, (N, ...).
        log: of the N instants, with the truth.
        estimate: (N, 4, n) theta, q, theta', q' as they were fed back [rad, rad/s].
        status: (N, n) status bits of the observer; 0 without one.
    """

    desired: Desired
    log: Log
    estimate: Array
    status: NDArray[np.int64]

    def vibration(self, joint: str, stop: float) -> float:
        """Return the vibration of a joint's link after a stop [rad^2 s], see `vibration`."""
        return vibration(self.log, joint, stop)


def closed_loop(
    device: Device,
    desired: Desired,
    law: StateFeedback,
    *,
    observer: StateObserver | None = None,
    estimate: StateEstimate | None = None,
    sensors: Mapping[str, Sensors] | None = None,
    inertial: Mapping[str, InertialFaults] | None = None,
    seed: int = 0,
) -> ClosedLoop:
    """Let a device follow a motion under a law, ``tau = K_P (x_d - xi) + tau_d``.

    At every instant the sensors are read, xi is made of what they show and of the torques that
    acted until then, and the law's torques act until the next. Without `observer` and `estimate`
    xi is the truth. The device starts where the motion does, at rest, its motors where the motion
    wants them: springs and weight that are not as told swing from there, so a motion should wait.

    Args:
        device: what is simulated: the arm as it is, one motor a joint.
        desired: of the arm as it is told; its instants are those of control.
        law: of the arm as it is told.
        observer: of the arm as it is told, with the sensors of the device.
        estimate: in its place.
        sensors: joint -> faults; none but the device's encoder counts where not given.
        inertial: accelerometer or gyroscope -> faults.
        seed: of all noise.

    Raises:
        MethodError: an observer and an estimate.
        RotatumError, DeviceError, SimulationError: as `rotatum.simulation.simulate`.
    """
    if observer is not None and estimate is not None:
        raise MethodError("one of observer and estimate tells the state", where="estimate")
    names = tuple(joint.name for joint in device.joints)
    period = float(desired.time[1] - desired.time[0])
    seen_by = estimate if observer is None else ObservedState(observer)
    live = LiveSensors(device, sensors, inertial, seed=seed, period=period)
    fed: list[Array] = []
    status: list[NDArray[np.int64]] = []

    def controller(seen: Seen) -> Array:
        state = true_state(seen, names) if seen_by is None else seen_by(live.read(seen))
        fed.append(state)
        if isinstance(seen_by, ObservedState):
            status.append(seen_by.status)
        return law.torques(desired.state(seen.time), desired.torques(seen.time), state)

    log = simulate(
        device,
        seconds=desired.time.size * period,
        period=period,
        drives=ArmControl(controller, device.joints).drives(),
        sensors=sensors,
        inertial=inertial,
        start=at_rest(desired, names),
        seed=seed,
    )
    bits = np.array(status) if status else np.zeros((len(fed), len(names)), dtype=np.int64)
    return ClosedLoop(desired, log, np.array(fed), bits)


def vibration(log: Log, joint: str, stop: float) -> float:
    """Return the integral of (q - its final mean)^2 from a stop to the end [rad^2 s].

    The final mean is that of the last `TAIL` seconds; q is the true link position.

    Args:
        log: simulated.
        joint: whose link.
        stop: when it is to stand [s].
    """
    q = log.joints[joint]["q_true"]
    after = q[log.time >= stop - 0.5 * log.period]
    last = max(1, round(TAIL / log.period))
    return float(np.sum((after - np.mean(after[-last:])) ** 2)) * log.period


def at_rest(desired: Desired, names: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """Return where joints start that start where a motion wants them, for `simulate`.

    Args:
        desired: the motion.
        names: of the joints, in its order.
    """
    rows = zip(names, desired.q[0].tolist(), desired.theta[0].tolist(), strict=True)
    return {name: {"q": q, "theta": theta} for name, q, theta in rows}
