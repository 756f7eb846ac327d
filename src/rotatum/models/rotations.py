"""Rotations of a sensor against the frame it sits on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["rotation_about", "rotation_of", "rpy_of", "vector_of"]

Array = NDArray[np.float64]

_LOCKED = 1e-9  # cosine of the pitch below which roll and yaw turn about one axis


def rotation_of(rpy: Sequence[float]) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll), (3, 3), of roll, pitch, yaw [rad], as URDF has it."""
    roll, pitch, yaw = rpy
    about_z, about_y = rotation_about((0.0, 0.0, yaw)), rotation_about((0.0, pitch, 0.0))
    turn: Array = about_z @ about_y @ rotation_about((roll, 0.0, 0.0))
    return turn


def rpy_of(rotation: Array) -> tuple[float, float, float]:
    """Return roll, pitch, yaw [rad] of a rotation (3, 3), pitch within pi/2 of 0.

    `rotation_of` undoes it. Where the pitch is pi/2 either way the roll is 0: the yaw has it all.
    """
    down = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], down)
    if down < _LOCKED:
        return 0.0, pitch, math.atan2(-rotation[0, 1], rotation[1, 1])
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    return roll, pitch, math.atan2(rotation[1, 0], rotation[0, 0])


def rotation_about(vector: Sequence[float] | Array) -> Array:
    """Return the rotation (3, 3) by a vector (3,) [rad], by Rodrigues' formula."""
    x, y, z = vector
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = math.sqrt(x * x + y * y + z * z)
    if angle == 0.0:
        return np.eye(3)
    half = math.sin(0.5 * angle) / angle
    turn: Array = np.eye(3) + math.sin(angle) / angle * skew + 2.0 * half * half * (skew @ skew)
    return turn


def vector_of(rotation: Array) -> Array:
    """Return the rotation vector (3,) [rad] of a rotation (3, 3), at most pi long.

    `rotation_about` undoes it.
    """
    from scipy.spatial.transform import Rotation

    vector: Array = Rotation.from_matrix(rotation).as_rotvec()
    return vector
