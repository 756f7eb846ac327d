"""A motion in closed form, for sensors to look at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.sensing.trajectory import Trajectory
from tests.simulation.plants import JOINT, PERIOD

# amplitude [rad], rate [rad/s], phase [rad] of each position
SWINGS = {"q": (0.6, 9.0, 0.3), "theta": (0.65, 9.0, 0.1), "setpoint": (0.0, 1.0, 0.0)}


def angle(role: str, t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a position (N,) [rad] at instants (N,) [s]."""
    amplitude, rate, phase = SWINGS[role]
    return amplitude * np.sin(rate * t + phase)


def speed(role: str, t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return its velocity (N,) [rad/s]."""
    amplitude, rate, phase = SWINGS[role]
    return amplitude * rate * np.cos(rate * t + phase)


def torque(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the elastic torque (N,) [N m] of `JOINT`'s spring."""
    phi = angle("q", t) - angle("theta", t)
    return 200.0 * phi + 600.0 * phi**3


def swinging(samples: int = 2000, period: float = PERIOD) -> Trajectory:
    """Return the motion on a clock; its held torque is the number of the sample."""
    t = np.arange(samples) * period
    return Trajectory(
        plant=JOINT,
        time=t,
        position={role: angle(role, t) for role in SWINGS},
        velocity={role: speed(role, t) for role in SWINGS},
        held={"tau": np.arange(samples, dtype=float), "tau_ext": np.zeros(samples)},
        elastic=(torque(t),),
    )
