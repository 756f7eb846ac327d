"""What a simulated joint really did, at the sample instants and in between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.bodies import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Trajectory:
    """Motion and torques of a joint before any sensor saw them.

    Attributes
    ----------
    plant
        What moved.
    time
        (N,) s, evenly spaced.
    position, velocity
        role -> (N,) rad and rad/s, joint side, at the instants: "q", the motors, and "setpoint",
        the angle of the set-point's motor.
    held
        role -> (N,) N m, constant from each instant to the next: the motors' torques, "tau_ext".
    elastic
        (M,) of (N,) N m, torque of each transmission without damping.
    """

    plant: Plant
    time: Array
    position: Mapping[str, Array]
    velocity: Mapping[str, Array]
    held: Mapping[str, Array]
    elastic: tuple[Array, ...]

    @property
    def transmitted(self) -> tuple[Array, ...]:
        """Torque of each transmission (M,) of (N,) [N m], damping included."""
        pairs = zip(self.plant.motor_roles, self.plant.transmissions, self.elastic, strict=True)
        return tuple(
            tau + t.damping * (self.velocity["q"] - self.velocity[role]) for role, t, tau in pairs
        )

    def before(self, seconds: float) -> Trajectory:
        """Return the motion `seconds` before each instant, on the same clock.

        Positions follow the cubic through both ends of their interval (fourth order in the
        period: the torques jump at the instants only), velocities its slope; the set-point, whose
        velocity may jump, goes straight. Before the first instant the joint stood where it started
        and no torque acted.
        """
        if seconds == 0.0:
            return self
        period = float(self.time[1] - self.time[0])
        # in samples; rounding here keeps a delay of whole samples a plain shift
        lag = round(seconds / period, 9)
        whole = int(np.ceil(lag))
        part = whole - lag
        left = np.arange(self.time.size) - whole
        position, velocity = {}, {}
        for role, x in self.position.items():
            dx = self.velocity[role]
            join = _straight if role == "setpoint" else _cubic
            position[role], velocity[role] = join(x, dx, left, part, period)
        held = {
            role: np.where(left >= 0, x[np.maximum(left, 0)], 0.0) for role, x in self.held.items()
        }
        setpoint = self.plant.setpoint(position["setpoint"])
        pairs = zip(self.plant.motor_roles, self.plant.transmissions, strict=True)
        elastic = [t.torque(position["q"] - position[role], setpoint) for role, t in pairs]
        return Trajectory(self.plant, self.time, position, velocity, held, tuple(elastic))


def trajectory(plant: Plant, inputs: Inputs, at: Records) -> Trajectory:
    """Return what the stage's outputs (N,) under these inputs mean, by role."""
    position = {"q": at["q"], "setpoint": at["angle"]}
    velocity = {"q": at["dq"], "setpoint": at["dangle"]}
    for m, role in enumerate(plant.motor_roles):
        position[role], velocity[role] = at["theta"][:, m], at["dtheta"][:, m]
    held = {role: inputs.tau[:, m] for m, role in enumerate(plant.torque_roles)}
    return Trajectory(
        plant=plant,
        time=inputs.time,
        position={role: np.ascontiguousarray(x) for role, x in position.items()},
        velocity={role: np.ascontiguousarray(x) for role, x in velocity.items()},
        held=held | {"tau_ext": inputs.tau_ext},
        elastic=tuple(np.ascontiguousarray(at["torque"].T)),
    )


def _cubic(
    x: Array, dx: Array, left: NDArray[np.int64], part: float, period: float
) -> tuple[Array, Array]:
    """Return value and slope (N,) of the cubic Hermite ``left + part`` samples on, part < 1."""
    i = np.maximum(left, 0)
    j = np.minimum(i + 1, x.size - 1)
    u, v = part, 1.0 - part
    value = v * v * ((1 + 2 * u) * x[i] + u * period * dx[i])
    value += u * u * ((1 + 2 * v) * x[j] - v * period * dx[j])
    slope = 6 * u * v * (x[j] - x[i]) / period
    slope += v * (v - 2 * u) * dx[i] + u * (u - 2 * v) * dx[j]
    before_start = left < 0
    return np.where(before_start, x[0], value), np.where(before_start, 0.0, slope)


def _straight(
    x: Array, dx: Array, left: NDArray[np.int64], part: float, period: float
) -> tuple[Array, Array]:
    """Return value and slope (N,) of the line ``left + part`` samples on, part < 1."""
    i = np.maximum(left, 0)
    j = np.minimum(i + 1, x.size - 1)
    value = (1.0 - part) * x[i] + part * x[j]
    before_start = left < 0
    return np.where(before_start, x[0], value), np.where(before_start, 0.0, (x[j] - x[i]) / period)
