"""A body fixed to a frame of a robot: its numbers, checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.names import no_such

__all__ = ["Payload"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Payload:
    """A body fixed to a frame.

    Attributes
    ----------
    frame : name.
    mass : kg.
    position : (3,) m, of its centre of mass in the frame.
    inertia : (3, 3) kg m^2 about that centre, in the frame's axes; zeros: a point.
    """

    frame: str
    mass: float
    position: Array
    inertia: Array

    @classmethod
    def checked(
        cls,
        frame: str,
        mass: float,
        position: Sequence[float],
        inertia: Sequence[Sequence[float]] | None,
        frames: Sequence[str],
    ) -> Payload:
        """Return the body, if it can be and the frame is one of `frames`.

        Raises
        ------
        DeviceError naming the number that cannot be.
        """
        if frame not in frames:
            raise no_such("frame", frame, frames, where="payload")
        if not (np.isfinite(mass) and mass > 0.0):
            raise DeviceError("mass must be greater than 0", where="payload", value=mass)
        centre = np.array(position, dtype=np.float64)
        if centre.shape != (3,) or not np.isfinite(centre).all():
            what = "position must be three finite numbers"
            raise DeviceError(what, where="payload", value=list(position))
        about = np.zeros((3, 3)) if inertia is None else np.array(inertia, dtype=np.float64)
        if about.shape != (3, 3) or not np.isfinite(about).all():
            what = "inertia must be three rows of three finite numbers"
            raise DeviceError(what, where="payload", value=inertia)
        scale = float(np.abs(about).max())
        # Numbers typed in with a few digits: a mirror entry off in the ninth is no mistake.
        if not np.allclose(about, about.T, rtol=0.0, atol=1e-9 * scale):
            raise DeviceError("inertia must be symmetric", where="payload", value=inertia)
        if float(np.linalg.eigvalsh(about)[0]) < -1e-9 * scale:
            what = "inertia must not be negative about any axis"
            raise DeviceError(what, where="payload", value=inertia)
        return cls(frame, float(mass), centre, about)
