"""One elastic joint of a device: its parts, how it is estimated and where a log keeps it."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from rotatum.models.channel import (
    MOTOR_SIDE_ROLES,
    ROLE_KINDS,
    ROLES,
    SETPOINT_MOTOR,
    Channel,
    check_unit,
)
from rotatum.models.parts import Basis, Encoders, Link, Motor, Setpoint
from rotatum.models.sources import check_key, flat_sources, source_of
from rotatum.models.table import Positive, Real, Table, bad_choice
from rotatum.models.transmission import Transmission
from rotatum.models.units import find_unit

__all__ = ["FIT_QUANTITIES", "Clocked", "EstimatorSettings", "Joint"]

# Quantities that can be fitted beside the stiffness; the second half on the link's side.
FIT_QUANTITIES = (
    "inertia",
    "damping",
    "coulomb",
    "offset",
    "skew",
    "transmission_damping",
    "link_damping",
    "link_coulomb",
    "gravity_torque",
    "payload",
)


class EstimatorSettings(Table):
    """How the device's maker suggests to estimate; the command line overrides.

    method; side "motor" or "link"; torque "estimated", "sensor" or "model"; cutoff [rad/s] (inf:
    the deadbeat form of method "rotatum") or window [s]; fit: quantities fitted beside the
    stiffness; payload_frame, payload_position [m in it]: where a fitted payload is (the origin of
    the arm's last frame); forgetting in (0, 1];
    shrinkage: whether high orders are shrunk as far as the data do not ask for them; selective
    [rad/s]: link speed below which nothing is learnt; period [s]: of
    the logs this device writes (one that differs by more than 1 % is refused; stands in for a time
    channel where a log has none).
    """

    method: str | None = None
    side: Literal["motor", "link"] | None = None
    torque: Literal["estimated", "sensor", "model"] | None = None
    cutoff: Annotated[float, Field(strict=True, gt=0.0)] | None = None
    window: Positive | None = None
    fit: tuple[str, ...] | None = None
    payload_frame: str | None = None
    payload_position: tuple[Real, Real, Real] | None = None
    forgetting: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] | None = None
    shrinkage: Annotated[bool, Field(strict=True)] | None = None
    selective: Annotated[float, Field(strict=True, ge=0.0)] | None = None
    period: Positive | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """Refuse both widths at once and quantities that cannot be fitted."""
        if self.cutoff is not None and self.window is not None:
            raise ValueError("give cutoff (rad/s) or window (s), not both")
        if self.cutoff == inf and self.method != "rotatum":
            raise ValueError('an infinite cutoff is the deadbeat form of method "rotatum"')
        for name in self.fit or ():
            if name not in FIT_QUANTITIES:
                raise bad_choice("unknown quantity to fit", "fit", name, FIT_QUANTITIES)
        return self


class Joint(Table):
    """One elastic joint.

    name; actuation; motors (agonist first; none: the torque is a sensor's); setpoint (serial);
    transmissions (antagonistic: two, agonist first; one table in the file stands for both);
    link; encoders; basis; estimator; channels: role -> where a log keeps it; sources: dotted key
    -> where its number is from.
    """

    name: Annotated[str, Field(min_length=1)]
    actuation: Literal["series", "antagonistic", "serial"] = "series"
    motors: tuple[Motor, ...] = ()
    setpoint: Setpoint | None = None
    transmissions: tuple[Transmission, ...] = Field(
        default=(Transmission(),), validate_default=True
    )
    link: Link | None = None
    encoders: Encoders = Encoders()
    basis: Basis = Basis()
    estimator: EstimatorSettings = EstimatorSettings()
    channels: Mapping[str, Channel] = Field(default_factory=dict)
    sources: Annotated[Mapping[str, str], BeforeValidator(flat_sources)] = Field(
        default_factory=dict
    )

    @property
    def transmission(self) -> Transmission:
        """The transmission, the agonist's of two."""
        return self.transmissions[0]

    @property
    def roles(self) -> tuple[str, ...]:
        """Quantities a log can hold for a joint of this actuation."""
        return ROLES[self.actuation]

    def torque_unit(self, torque: str) -> str:
        """Return the unit torques come out in: "A" where the channel is a current, else "N m".

        Parameters
        ----------
        torque : their source, "estimated", "sensor" or "model".
        """
        if torque == "model":
            return "N m"
        role = "torque_measured" if torque == "sensor" else "tau"
        channel = self.channels.get(role) or self.channels.get(f"{role}1")
        if channel is None or channel.unit is None:
            return "N m"
        return "A" if find_unit(channel.unit, "torque").name in ("A", "mA") else "N m"

    def motor_of(self, role: str) -> Motor | None:
        """Return the motor a role belongs to, of `MOTOR_SIDE_ROLES`; None: not described."""
        number = MOTOR_SIDE_ROLES[role]
        if number == SETPOINT_MOTOR:
            return self.setpoint.motor if self.setpoint is not None else None
        return self.motors[number] if number < len(self.motors) else None

    def gear_ratio(self, role: str) -> float:
        """Return the gear ratio between the motor a role belongs to and the joint."""
        motor = self.motor_of(role)
        return motor.gear_ratio if motor is not None else 1.0

    def source_of(self, key: str) -> str | None:
        """Return where a value is from, as [sources] says of it or of a table around it.

        Parameters
        ----------
        key : dotted key of the file; "motor[1].inertia" is the second motor's.
        """
        return source_of(self.sources, key)

    @field_validator("transmissions", mode="after")
    @classmethod
    def _one_each(
        cls, given: tuple[Transmission, ...], info: ValidationInfo
    ) -> tuple[Transmission, ...]:
        """Let one table stand for both transmissions of an antagonistic joint."""
        actuation = info.data.get("actuation", "series")
        needed = 2 if actuation == "antagonistic" else 1
        if len(given) == 1:
            return given * needed
        if len(given) != needed:
            noun = "1 or 2 transmission tables" if needed == 2 else "1 transmission table"
            raise ValueError(f'actuation "{actuation}" has {noun}, not {len(given)}')
        return given

    @model_validator(mode="after")
    def _motors_of_the_actuation(self) -> Self:
        """Refuse a number of motors the actuation does not have."""
        needed = 2 if self.actuation == "antagonistic" else 1
        if self.motors and len(self.motors) != needed:
            what = f'actuation "{self.actuation}" has {needed} motor tables, not '
            raise ValueError(f"{what}{len(self.motors)}")
        if self.actuation == "serial":
            return self
        if self.setpoint is not None:
            raise ValueError(f'actuation "{self.actuation}" has no set-point')
        for spring in self.transmissions:
            if spring.law is not None and spring.model.uses_setpoint:
                what = f'law "{spring.law}" depends on a set-point, which actuation '
                raise ValueError(f'{what}"{self.actuation}" has not; use actuation = "serial"')
        return self

    @model_validator(mode="after")
    def _channels_of_the_actuation(self) -> Self:
        """Refuse roles, units and sides that make no sense for this joint."""
        for role, channel in self.channels.items():
            if role not in self.roles:
                raise bad_choice("unknown channel", "channels", role, ("time", *self.roles))
            check_unit(role, channel, ROLE_KINDS[role])
            if channel.side == "motor":
                self._check_side(role, channel)
        return self

    def _check_side(self, role: str, channel: Channel) -> None:
        """Refuse a channel on a side it cannot have."""
        total = role == "torque_measured" and self.actuation == "antagonistic"
        if role not in MOTOR_SIDE_ROLES or total:
            raise ValueError(f"channel {role} is always at the joint; side must be joint")
        if self.motor_of(role) is None:
            table = "setpoint.motor" if role == "setpoint" else "motor"
            what = f"channel {role} is on the motor's side, so [{table}] gear_ratio is needed"
            raise ValueError(what)
        if channel.unit is not None and find_unit(channel.unit).kind == "length":
            raise ValueError(f"channel {role} is a length, so it cannot be on the motor's side")

    @model_validator(mode="after")
    def _keys_of_the_sources(self) -> Self:
        """Refuse entries of [sources] about keys that do not exist."""
        parts: dict[str, type[Table]] = {
            "motor": Motor, "setpoint": Setpoint, "setpoint.motor": Motor, "link": Link,
            "encoders": Encoders, "basis": Basis, "estimator": EstimatorSettings,
        }  # fmt: skip
        tables = {name: tuple(kind.model_fields) for name, kind in parts.items()}
        own = dict.fromkeys(name for spring in self.transmissions for name in spring.given)
        tables["transmission"] = (*Transmission.model_fields, *own)
        for key in self.sources:
            check_key(key, tables)
        return self


class Clocked(Table):
    """The clock's entry of a [channels] table, shared by all joints of a log."""

    time: Channel

    @model_validator(mode="after")
    def _unit_of_time(self) -> Self:
        """Refuse a clock that does not measure time."""
        check_unit("time", self.time, ROLE_KINDS["time"], prefix="")
        return self
