"""A load the link takes up on the way, untold to the estimator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.models.robot.interface import Robot

__all__ = ["Payload", "added", "loaded"]

GRAVITY = 9.80665  # [m/s^2], of links without a robot; an arm's own says its own


@dataclass(frozen=True)
class Payload:
    """A point mass fixed to a link for some time; the motion's velocities do not jump.

    Parameters
    ----------
    mass
        kg.
    frame, position
        Of an arm: frame of its robot, and (3,) m in it.
    joint, distance
        Of joints without a robot: the joint ("" is the only one), and m from its axis:
        ``M + m d^2`` and ``G + m g d``, g = 9.80665 m/s^2.
    begin, end
        s; None: to the end.
    """

    mass: float
    frame: str | None = None
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    joint: str = ""
    distance: float = 0.0
    begin: float = 0.0
    end: float | None = None

    def __post_init__(self) -> None:
        """Raise `RotatumError` for a mass that is not positive, or an end before the beginning."""
        if not (self.mass > 0.0 and np.isfinite(self.mass)):
            raise RotatumError(
                "a payload needs a positive mass", where="payload.mass", value=self.mass
            )
        if self.end is not None and not self.end > self.begin:
            raise RotatumError(
                "a payload ends after it begins", where="payload.end", value=self.end
            )

    def carried(self, time: NDArray[np.float64]) -> NDArray[np.bool]:
        """Return at which instants (N,) [s] it is there."""
        there: NDArray[np.bool] = time >= self.begin
        return there if self.end is None else there & (time < self.end)


def loaded(
    robot: Robot, payloads: Sequence[Payload], time: NDArray[np.float64]
) -> dict[int, Robot]:
    """Return sample -> robot from there on; empty without payloads.

    Raises `RotatumError` for a frame the robot does not have, or a payload without one.
    """
    if not payloads:
        return {}
    there = np.stack([p.carried(time) for p in payloads], axis=1)
    changes = [0, *(1 + np.flatnonzero(np.any(there[1:] != there[:-1], axis=1))).tolist()]
    robots = {}
    for k in changes:
        now = robot
        for payload, carried in zip(payloads, there[k], strict=True):
            if payload.frame is None:
                raise RotatumError(
                    "a payload of an arm needs the frame it is fixed to",
                    where="payload.frame",
                    allowed=robot.frames,
                )
            if carried:
                now = now.with_payload(payload.frame, payload.mass, payload.position)
        robots[k] = now
    return robots


def added(
    payloads: Sequence[Payload], names: Sequence[str], time: NDArray[np.float64]
) -> Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return joint -> inertia (N,) [kg m^2] and gravity torque (N,) [N m] that payloads add.

    Raises `RotatumError` for a joint that is not there.
    """
    loads: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for payload in payloads:
        joint = payload.joint or (names[0] if len(names) == 1 else "")
        if joint not in names:
            raise RotatumError(
                "a payload needs the joint whose link carries it",
                where="payload.joint",
                value=payload.joint,
                allowed=names,
            )
        there = payload.carried(time) * payload.mass * payload.distance
        before = loads.get(joint, (np.zeros_like(time), np.zeros_like(time)))
        loads[joint] = (before[0] + there * payload.distance, before[1] + there * GRAVITY)
    return loads
