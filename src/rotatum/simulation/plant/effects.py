"""What real joints do beside the device file: friction that is not linear, play, drift."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Effects", "StiffnessDrift"]


@dataclass(frozen=True)
class StiffnessDrift:
    """All of a joint's springs change by a factor: ``1 + rate t + step [t >= at]``.

    The factor multiplies the law's torque, stiffness and energy.
    """

    rate: float = 0.0  # [1/s]
    step: float = 0.0
    at: float = 0.0  # [s]


@dataclass(frozen=True)
class Effects:
    """Effects of one joint's plant that the device file does not describe; by default none.

    Everything at the joint side. Friction of a body that turns at v under the elastic torque t is
    ``D v + (C + (S - C) exp(-(v / v_s)^2) + mu |t|) tanh(v / smoothing)``, D and C being the
    device file's (Stribeck's curve; mu of the motors only: gears under load).

    Parameters
    ----------
    motor_stiction, link_stiction
        S [N m], friction at breaking away; None: C.
    motor_stribeck, link_stribeck
        v_s [rad/s].
    load_friction
        mu, share of the elastic torque that the motors' gears rub away.
    backlash
        Play between each motor and its spring [rad]: the spring feels
        ``phi - clip(phi, -backlash / 2, backlash / 2)``.
    hysteresis_torque, hysteresis_deflection
        h [N m] and d [rad] of Dahl's model (Bouc-Wen's with n = 1) in parallel to each spring:
        torque ``h z``, ``z' = (phi' - |phi'| z) / d``; a loop h high to either side, fully built up
        after a few d.
    drift
        Of the stiffness over time.
    """

    motor_stiction: float | None = None
    link_stiction: float | None = None
    motor_stribeck: float = 0.05
    link_stribeck: float = 0.05
    load_friction: float = 0.0
    backlash: float = 0.0
    hysteresis_torque: float = 0.0
    hysteresis_deflection: float = 0.01
    drift: StiffnessDrift = StiffnessDrift()
