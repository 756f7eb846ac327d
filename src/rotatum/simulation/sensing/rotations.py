"""Rotations of a sensor against the frame it sits on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rotation_of(rpy: Sequence[float]) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll), (3, 3), of roll, pitch, yaw [rad], as URDF has it."""
    roll, pitch, yaw = rpy
    about_z, about_y = rotation_about((0.0, 0.0, yaw)), rotation_about((0.0, pitch, 0.0))
    turn: Array = about_z @ about_y @ rotation_about((roll, 0.0, 0.0))
    return turn


def rotation_about(vector: Sequence[float]) -> Array:
    """Return the rotation (3, 3) by a vector (3,) [rad], by Rodrigues' formula."""
    x, y, z = vector
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = math.sqrt(x * x + y * y + z * z)
    if angle == 0.0:
        return np.eye(3)
    half = math.sin(0.5 * angle) / angle
    turn: Array = np.eye(3) + math.sin(angle) / angle * skew + 2.0 * half * half * (skew @ skew)
    return turn
