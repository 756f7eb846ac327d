"""What a simulated joint really did, at the sample instants and in between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Records
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.sensing.between import Place, cubic, held_at, straight

Array = NDArray[np.float64]
_ROUNDING = 1e-9


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
        (M,) of (N,) N m, torque of each transmission less its damping times ``q' - theta'``:
        its law's, and what play, hysteresis and drift make of it.
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

    def before(self, seconds: float | Array = 0.0, every: int = 1) -> Trajectory:
        """Return the motion `seconds` before each instant, or each `every`-th, on the same clock.

        Positions follow the cubic through both ends of their interval (fourth order in the
        period: the torques jump at the instants only), velocities its slope; the set-point, whose
        velocity may jump, goes straight. Springs follow their laws; what they do beyond those
        (hysteresis, play, drift) goes straight. Before the first instant the joint stood where it
        started and no torque acted; after the last one nothing is known, and it is taken instead.

        Parameters
        ----------
        seconds
            One for all instants, or (K,) for the K that are kept; below zero: after them.
        every
            Instants kept, 1 in `every`.
        """
        if np.ndim(seconds) == 0 and seconds == 0.0:
            return self if every == 1 else self._thinned(every)
        period = float(self.time[1] - self.time[0])
        kept = np.arange(0, self.time.size, every)
        # in samples; rounding here keeps a delay of whole samples a plain shift
        lag = np.maximum(np.round(np.asarray(seconds) / period, 9), kept - (self.time.size - 1.0))
        whole = np.ceil(lag).astype(np.int64)
        place = Place(kept - whole, whole - lag)
        position, velocity = {}, {}
        for role, x in self.position.items():
            join = straight if role == "setpoint" else cubic
            position[role], velocity[role] = join(x, self.velocity[role], place, period)
        held = {role: held_at(x, place) for role, x in self.held.items()}
        elastic = [
            torque + straight(rest, rest, place, period)[0]
            for torque, rest in zip(self._lawful(position), self._beyond, strict=True)
        ]
        return Trajectory(self.plant, self.time[kept], position, velocity, held, tuple(elastic))

    @property
    def _beyond(self) -> tuple[Array, ...]:
        """Torque of each transmission that is not its law's (M,) of (N,) [N m]."""
        pairs = zip(self.elastic, self._lawful(self.position), strict=True)
        return tuple(_more(tau, torque) for tau, torque in pairs)

    def _lawful(self, position: Mapping[str, Array]) -> list[Array]:
        setpoint = self.plant.setpoint(position["setpoint"])
        pairs = zip(self.plant.motor_roles, self.plant.transmissions, strict=True)
        return [t.torque(position["q"] - position[role], setpoint) for role, t in pairs]

    def _thinned(self, every: int) -> Trajectory:
        kept = slice(None, None, every)
        return Trajectory(
            plant=self.plant,
            time=self.time[kept],
            position={role: x[kept] for role, x in self.position.items()},
            velocity={role: x[kept] for role, x in self.velocity.items()},
            held={role: x[kept] for role, x in self.held.items()},
            elastic=tuple(x[kept] for x in self.elastic),
        )


def trajectory(plant: Plant, inputs: Inputs, at: Records) -> Trajectory:
    """Return what the stage's outputs (N,) under these inputs mean, by role."""
    position = {"q": at["q"], "setpoint": at["angle"]}
    velocity = {"q": at["dq"], "setpoint": at["dangle"]}
    for m, role in enumerate(plant.motor_roles):
        position[role], velocity[role] = at["theta"][:, m], at["dtheta"][:, m]
    held = {role: inputs.tau[:, m] for m, role in enumerate(plant.torque_roles)}
    elastic = []
    for m, (role, t) in enumerate(zip(plant.motor_roles, plant.transmissions, strict=True)):
        torque, damped = at["torque"][:, m], t.damping * (velocity["q"] - velocity[role])
        elastic.append(torque + _more(at["transmitted"][:, m], torque + damped))
    return Trajectory(
        plant=plant,
        time=inputs.time,
        position={role: np.ascontiguousarray(x) for role, x in position.items()},
        velocity={role: np.ascontiguousarray(x) for role, x in velocity.items()},
        held=held | {"tau_ext": inputs.tau_ext},
        elastic=tuple(elastic),
    )


def _more(torque: Array, lawful: Array) -> Array:
    """Return by how much a torque exceeds what a law gives, 0 where that is rounding."""
    rest = torque - lawful
    # the compiled laws round otherwise than these
    small = np.max(np.abs(rest), initial=0.0) <= _ROUNDING * np.max(np.abs(torque), initial=0.0)
    return np.zeros_like(rest) if small else rest
