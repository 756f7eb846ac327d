"""Sensors of one joint, and what goes wrong with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rotatum.simulation.sensing.checks import (
    COUNTS,
    FINITE,
    NOT_NEGATIVE,
    NOT_ZERO,
    POSITIVE,
    RATE,
    Rule,
    check_map,
    check_roles,
    check_value,
    impossible,
)

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
TORQUES = tuple(role for role in ROLES if role not in ENCODERS)

# Faults given role by role: which roles can have them, and what values.
_BY_ROLE: Mapping[str, tuple[tuple[str, ...], Rule]] = {
    "delay": (ROLES, NOT_NEGATIVE),
    "delay_jitter": (ROLES, NOT_NEGATIVE),
    "eccentricity": (ENCODERS, NOT_NEGATIVE),
    "eccentricity_turns": (ENCODERS, POSITIVE),
    "gain": (ROLES, NOT_ZERO),
    "offset": (ROLES, FINITE),
    "noise": (ROLES, NOT_NEGATIVE),
    "saturation": (TORQUES, POSITIVE),
    "counts": (ENCODERS, COUNTS),
    "wrap": (ENCODERS, POSITIVE),
}
_PLAIN = {"deflection_zero": FINITE, "jitter": NOT_NEGATIVE, "clock_rate": RATE}


@dataclass(frozen=True)
class Sensors:
    """How the channels of a joint are recorded; by default without any fault but quantisation.

    The faults act in the order of this list: when a reading is taken, then what the mechanics, the
    electronics, the converter and the transport make of it; those from `jitter` on concern whole
    rows of the log, and are the same for all joints of a device.

    Parameters
    ----------
    delay
        role -> s: the reading is that of an earlier instant, whole samples or not. Different
        delays for "q" and "theta" are an encoder skew.
    delay_jitter
        role -> standard deviation [s] of a delay that varies from sample to sample, white Gaussian
        about `delay` but never below zero.
    eccentricity, eccentricity_turns
        role of an angle -> amplitude [rad] of ``sin(turns x + phase)`` added to the angle x, the
        phase drawn from the seed; and turns of the encoder's disc per turn of the joint (1 if not
        given; a motor encoder's is the gear ratio).
    deflection_zero
        rad, constant added to the measured ``q - theta`` (motor encoders read lower by it).
    gain
        role -> factor of the reading; a torque constant of 1.4 N m/A applied twice is 1.4, a wrong
        sign -1.
    offset
        role -> rad or N m added: index of an encoder, zero of a torque sensor.
    noise
        role -> standard deviation of white Gaussian noise [rad or N m].
    saturation
        role of a torque -> N m, beyond which it reads this limit.
    counts
        role of an angle -> counts per turn at the joint; the reading is rounded to the nearest
        count. None takes those of the device's encoders, an empty mapping quantises nothing.
    wrap
        role of an angle -> angle [rad at the joint] at which it starts again from zero.
    stuck
        role -> (from, for) [s]: the samples in that time show the value of the last one before.
    stale
        Number of samples at which every channel still shows the sample before.
    nans, nan_rows
        Number of runs of NaN, each on one channel drawn at random, and samples in each run.
    jitter
        Standard deviation [s] of the sampling instants about their even grid, white Gaussian and
        cut at 0.45 periods; at most a quarter of the period. Commanded torques do not jitter: the
        log has what was sent in that cycle.
    stamped
        Whether the log's clock shows the jittered instants, or the even ones.
    clock_rate
        The log's clock goes fast by it: ``(1 + rate) t``.
    repeats
        Number of rows written twice, time included.
    dropouts, dropout_rows
        Number of gaps, and rows missing in each.

    Raises `RotatumError` for an unknown role or a value no sensor can have.
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
    delay_jitter: Mapping[str, float] = field(default_factory=dict)
    eccentricity: Mapping[str, float] = field(default_factory=dict)
    eccentricity_turns: Mapping[str, float] = field(default_factory=dict)
    gain: Mapping[str, float] = field(default_factory=dict)
    offset: Mapping[str, float] = field(default_factory=dict)
    saturation: Mapping[str, float] = field(default_factory=dict)
    wrap: Mapping[str, float] = field(default_factory=dict)
    stuck: Mapping[str, Sequence[float]] = field(default_factory=dict)
    jitter: float = 0.0
    stamped: bool = True
    clock_rate: float = 0.0

    def __post_init__(self) -> None:
        """Check roles and values."""
        for name, (roles, rule) in _BY_ROLE.items():
            check_map(f"sensors.{name}", getattr(self, name) or {}, roles, rule)
        check_roles("sensors.stuck", self.stuck, ROLES)
        for role, span in self.stuck.items():
            if len(span) != 2 or not 0.0 <= span[0] < float("inf") or not span[1] > 0.0:
                allowed = "[from, for] in seconds, from 0 or more, for above 0"
                raise impossible(f"sensors.stuck.{role}", span, allowed)
        for name, rule in _PLAIN.items():
            check_value(f"sensors.{name}", getattr(self, name), rule)
        for name in ("stale", "nans", "repeats", "dropouts"):
            if getattr(self, name) < 0:
                raise impossible(f"sensors.{name}", getattr(self, name), "0 or more")
        for name in ("nan_rows", "dropout_rows"):
            if getattr(self, name) < 1:
                raise impossible(f"sensors.{name}", getattr(self, name), "1 or more")

    def fit(self, actuation: str) -> None:
        """Raise `RotatumError` for a channel that joints of this actuation do not have."""
        roles = (*LOGGED[actuation], "tau_ext")
        for name, (possible, _) in _BY_ROLE.items():
            own = tuple(role for role in roles if role in possible)
            check_roles(f"sensors.{name}", getattr(self, name) or {}, own)
        check_roles("sensors.stuck", self.stuck, roles)
