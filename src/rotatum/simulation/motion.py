"""What a device really did: the result of a simulation before any sensor saw it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.simulation.sensing.trajectory import Trajectory

if TYPE_CHECKING:
    from rotatum.errors import SimulationError
    from rotatum.models.robot.interface import Robot

Array = NDArray[np.float64]

__all__ = ["Motion", "Truth"]


@dataclass(frozen=True)
class Truth:
    """Of one joint, at the instants, (N,) each: its elastic laws without damping and hysteresis.

    Attributes
    ----------
    stiffness, torque
        (M,) of (N,) N m/rad and N m, of each transmission.
    """

    stiffness: tuple[Array, ...]
    torque: tuple[Array, ...]


@dataclass(frozen=True)
class Motion:
    """Motion of all joints of a device, and what the simulation has to say about itself.

    Attributes
    ----------
    time
        (N,) s, evenly spaced.
    joints
        joint -> its trajectory.
    truth
        joint -> its truth.
    acceleration
        joint -> (N,) rad/s^2, of the link, just after each instant.
    robot
        The arm the links are; None: every link is a pendulum of its own.
    warnings
        Sentences about how it was simulated.
    stopped
        Why the motion ends before its time: then `time` is what was simulated until there.
    """

    time: Array
    joints: Mapping[str, Trajectory]
    truth: Mapping[str, Truth]
    acceleration: Mapping[str, Array]
    robot: Robot | None = None
    warnings: tuple[str, ...] = ()
    stopped: SimulationError | None = None
