"""Sensors of one joint, and what goes wrong with them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from rotatum.errors import RotatumError, nearest

# What a simulated joint's log holds, by actuation, beside the truth and an external torque.
LOGGED = {
    "series": ("q", "theta", "tau", "torque_measured"),
    "antagonistic": (
        "q",
        "theta1",
        "theta2",
        "tau1",
        "tau2",
        "torque_measured",
        "torque_measured1",
        "torque_measured2",
    ),
    "serial": ("q", "theta", "setpoint", "tau", "torque_measured"),
}
ENCODERS = ("q", "theta", "theta1", "theta2", "setpoint")
ROLES = (*dict.fromkeys(role for roles in LOGGED.values() for role in roles), "tau_ext")


@dataclass(frozen=True)
class Sensors:
    """How the channels of a joint are recorded; by default without any fault but quantisation.

    The faults act in the order of this list, the last two on whole rows of the log.

    Parameters
    ----------
    delay
        role -> s: the reading is that of an earlier instant, whole samples or not. Different
        delays for "q" and "theta" are an encoder skew.
    deflection_zero
        rad, constant added to the measured ``q - theta`` (motor encoders read lower by it).
    noise
        role -> standard deviation of white Gaussian noise [rad or N m].
    counts
        role of an angle -> counts per turn at the joint; the reading is rounded to the nearest
        count. None takes those of the device's encoders, an empty mapping quantises nothing.
    stale
        Number of samples at which every channel still shows the sample before.
    nans, nan_rows
        Number of runs of NaN, each on one channel drawn at random, and samples in each run.
    repeats
        Number of rows written twice, time included.
    dropouts, dropout_rows
        Number of gaps, and rows missing in each.
    """

    delay: Mapping[str, float] = field(default_factory=dict)
    deflection_zero: float = 0.0
    noise: Mapping[str, float] = field(default_factory=dict)
    counts: Mapping[str, float] | None = None
    stale: int = 0
    nans: int = 0
    nan_rows: int = 5
    repeats: int = 0
    dropouts: int = 0
    dropout_rows: int = 1

    def __post_init__(self) -> None:
        """Raise `RotatumError` for an unknown role or a value no sensor can have."""
        _check_roles("delay", self.delay, ROLES, at_least=0.0)
        _check_roles("noise", self.noise, ROLES, at_least=0.0)
        _check_roles("counts", self.counts or {}, ENCODERS, at_least=1.0)
        if not math.isfinite(self.deflection_zero):
            raise _impossible("deflection_zero", self.deflection_zero, "a finite angle [rad]")
        for name in ("stale", "nans", "repeats", "dropouts"):
            if getattr(self, name) < 0:
                raise _impossible(name, getattr(self, name), "0 or more")
        for name in ("nan_rows", "dropout_rows"):
            if getattr(self, name) < 1:
                raise _impossible(name, getattr(self, name), "1 or more")

    def fit(self, actuation: str) -> None:
        """Raise `RotatumError` for a channel that joints of this actuation do not have."""
        roles = (*LOGGED[actuation], "tau_ext")
        for name, values in (("delay", self.delay), ("noise", self.noise)):
            _check_roles(name, values, roles, at_least=0.0)
        angles = tuple(role for role in roles if role in ENCODERS)
        _check_roles("counts", self.counts or {}, angles, at_least=1.0)


def _check_roles(
    name: str, values: Mapping[str, float], roles: tuple[str, ...], *, at_least: float
) -> None:
    for role, value in values.items():
        if role not in roles:
            close = nearest(role, roles)
            raise RotatumError(
                "sensors have no such channel",
                where=f"sensors.{name}",
                value=role,
                allowed=roles,
                hint=f"Did you mean {close!r}?" if close else None,
            )
        if not at_least <= value < math.inf:
            raise _impossible(f"{name}.{role}", value, f"a finite number, {at_least:g} or more")


def _impossible(name: str, value: float, allowed: str) -> RotatumError:
    return RotatumError(
        "no sensor can have this value", where=f"sensors.{name}", value=value, allowed=allowed
    )
