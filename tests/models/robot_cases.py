"""The arms of the tests, their random states, and differences of high order."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from rotatum.models.robot.interface import Robot
from rotatum.models.robot.packaged import read_urdf
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from rotatum.models.robot.urdf import UrdfRobot

Array = NDArray[np.float64]

# No two alike, positive definite, with products of inertia.
INERTIA = ((0.03, 0.004, -0.002), (0.004, 0.02, 0.001), (-0.002, 0.001, 0.025))


def planar_2r() -> Planar:
    """Flacco2012 section 6.3, in the vertical plane."""
    return Planar((0.5, 0.5), (0.1, 0.1), motor_masses=(0.345,))


@cache
def arm(name: str) -> Robot:
    wrist = {"axis4": 0.4, "axis5": -0.7, "axis6": 1.1}
    r3 = read_urdf("manutec-r3")
    made: dict[str, Callable[[], Robot]] = {
        "pendulum": lambda: Pendulum(0.4, 3.0, 0.5),
        "pendulum-loaded": lambda: arm("pendulum").with_payload("tip", 0.7, (0.1, 0.2, -0.3)),
        "planar": planar_2r,
        "planar-flat": lambda: Planar((0.3, 0.2), (1.0, 0.6), inertias=(0.02, 0.0), gravity=0.0),
        "planar-loaded": lambda: planar_2r().with_payload("tip", 0.3, (0.12, 0.05, -0.07), INERTIA),
        "planar-2r": lambda: UrdfRobot(read_urdf("planar-2r")),
        "seven-axis": lambda: UrdfRobot(read_urdf("seven-axis")),
        "seven-loaded": lambda: arm("seven-axis").with_payload(
            "flange", 3.0, (0.1, -0.05, 0.08), INERTIA
        ),
        "r3": lambda: UrdfRobot(r3),
        "r3-elastic": lambda: UrdfRobot(r3, ("axis1", "axis2", "axis3"), wrist).with_payload(
            "flange", 15.0, (0.1, 0.1, 0.25)
        ),
    }
    return made[name]()


ARMS = (
    "pendulum", "pendulum-loaded", "planar", "planar-flat", "planar-loaded", "planar-2r",
    "seven-axis", "seven-loaded", "r3", "r3-elastic",
)  # fmt: skip


def states(size: int) -> st.SearchStrategy[Array]:
    """Rows q, q', q'', q''', of up to pi rad, and 2 of each of the others."""
    rows = st.floats(-2.0, 2.0, allow_subnormal=False)
    return arrays(np.float64, (4, size), elements=rows).map(
        lambda rows: rows * np.array([[np.pi / 2], [1.0], [1.0], [1.0]])
    )


def along(state: Array, t: float) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration on the cubic through a state."""
    q, dq, ddq, dddq = state
    return (
        q + t * (dq + t * (ddq / 2 + t * dddq / 6)),
        dq + t * (ddq + t * dddq / 2),
        ddq + t * dddq,
    )


# The angles of seven joints that turn at 2 rad/s add up to 14 rad/s: the seventh derivative is
# below 14^7 = 1e8 of a quantity, so that of order six at this step is off by 1e8 h^6 / 140 = 1e-12,
# and by rounding, 1e-16 / h = 1e-13.
STEP = 1e-3


def rate(function: Callable[[float], Array]) -> Array:
    """Derivative at 0 by central differences of order six."""
    pairs = [function(i * STEP) - function(-i * STEP) for i in (1, 2, 3)]
    slope: Array = (45.0 * pairs[0] - 9.0 * pairs[1] + pairs[2]) / (60.0 * STEP)
    return slope


def close(found: Array, told: Array, scale: float, tolerance: float = 1e-8) -> None:
    """Largest difference against the size of the quantity."""
    assert np.abs(found - told).max() <= tolerance * (1.0 + scale)
