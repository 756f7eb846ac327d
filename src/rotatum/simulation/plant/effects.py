"""What real joints do beside the device file: friction that is not linear, play, drift."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError

__all__ = ["Effects", "StiffnessDrift"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StiffnessDrift:
    """All of a joint's springs change by a factor: ``1 + rate t + step [t >= at]``.

    The factor multiplies the law's torque, stiffness and energy. It changes evenly between the
    samples; the step comes with the first sample from `at` on.

    Raises `RotatumError` for what is not a finite number.
    """

    rate: float = 0.0  # [1/s]
    step: float = 0.0
    at: float = 0.0  # [s]

    def __post_init__(self) -> None:
        """Check that all are numbers."""
        for name in ("rate", "step", "at"):
            _finite(f"effects.drift.{name}", getattr(self, name))

    def factors(self, time: Array, period: float) -> tuple[Array, Array]:
        """Return the factor at instants (N,) [s] and at the end of the period of each.

        Raises `RotatumError` where it is not positive: a spring without stiffness.
        """
        step = np.where(time >= self.at, self.step, 0.0)
        now = 1.0 + self.rate * time + step
        end = now + self.rate * period
        lowest = np.minimum(now, end)
        if lowest.size and not np.min(lowest) > 0.0:
            where = int(np.argmax(lowest <= 0.0))
            raise RotatumError(
                "the stiffness drifts to zero",
                where=f"effects.drift, t = {time[where]:.6g} s",
                value=float(f"{lowest[where]:.6g}"),
                allowed="a factor above 0",
            )
        return now, end


@dataclass(frozen=True)
class Effects:
    """Effects of one joint's plant that the device file does not describe; by default none.

    Everything at the joint side. Friction of a body that turns at v under the elastic torque t is
    ``D v + (C + (S - C) exp(-(v / v_s)^2) + mu |t|) tanh(v / smoothing)``, D and C being the
    device file's (Stribeck's curve; mu of the motors only: gears under load). A set-point motor
    has D and C alone.

    Parameters
    ----------
    motor_stiction, link_stiction
        S [N m], friction at breaking away, at least C; None: C.
    motor_stribeck, link_stribeck
        v_s [rad/s].
    load_friction
        mu, share of the elastic torque that the motors' gears rub away, below 1.
    backlash
        b [rad], play in series with each spring: it feels ``x - clip(x, -b / 2, b / 2)``, x being
        deflection and preload. Inside the play the spring has no stiffness and no damping.
    hysteresis_torque, hysteresis_deflection
        h [N m] and d [rad] of Dahl's model (Bouc-Wen's with n = 1) in parallel to each spring and
        its play: torque ``h z``, ``z' = (phi' - |phi'| z) / d``, z = 0 at the start; a loop h high
        to either side, fully built up after a few d.
    drift
        Of the stiffness over time.

    Raises `RotatumError` naming the field for what cannot be.
    """

    motor_stiction: float | None = None
    link_stiction: float | None = None
    motor_stribeck: float = 0.05
    link_stribeck: float = 0.05
    load_friction: float = 0.0
    backlash: float = 0.0
    hysteresis_torque: float = 0.0
    hysteresis_deflection: float = 0.01
    drift: StiffnessDrift = field(default_factory=StiffnessDrift)

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("motor_stribeck", "link_stribeck", "hysteresis_deflection"):
            _finite(f"effects.{name}", getattr(self, name))
            if not getattr(self, name) > 0.0:
                raise _refused(f"effects.{name}", getattr(self, name), "above 0")
        for name in ("motor_stiction", "link_stiction", "backlash", "hysteresis_torque"):
            value = getattr(self, name)
            if value is None:
                continue
            _finite(f"effects.{name}", value)
            if value < 0.0:
                raise _refused(f"effects.{name}", value, "0 or more")
        _finite("effects.load_friction", self.load_friction)
        if not 0.0 <= self.load_friction < 1.0:
            raise _refused("effects.load_friction", self.load_friction, "0 or more, below 1")


def _finite(where: str, value: object) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise _refused(where, value, "a finite number")


def _refused(where: str, value: object, allowed: str) -> RotatumError:
    return RotatumError("this effect cannot be", where=where, value=value, allowed=allowed)
