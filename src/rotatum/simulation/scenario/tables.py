"""The tables of a scenario's file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from rotatum.errors import ScenarioError, nearest
from rotatum.models.explain import explain
from rotatum.models.table import NonNegative, Positive, Real
from rotatum.simulation.scenario.drive_tables import AnyDrive
from rotatum.simulation.scenario.motor_tables import AnyLaw
from rotatum.simulation.scenario.part import Part

__all__ = [
    "DrivesTable",
    "EstimateTable",
    "JointTable",
    "ScenarioTable",
    "SensorsTable",
    "check_names",
    "parsed",
]

Anything = Mapping[str, Any]
Named = Mapping[str, Anything]


class EstimateTable(Part):
    """How the log is to be estimated, as the options of `rotatum estimate`; None: not said."""

    method: str | None = None
    side: Literal["motor", "link"] | None = None
    torque: Literal["estimated", "sensor", "model"] | None = None
    cutoff: Positive | None = None
    window: Positive | None = None
    order: Annotated[int, Field(strict=True, gt=0)] | None = None
    stride: Annotated[int, Field(strict=True, gt=0)] | None = None
    fit: tuple[str, ...] | None = None
    forgetting: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] | None = None
    solver: Literal["ud", "covariance", "continuous"] | None = None
    shrinkage: Annotated[bool, Field(strict=True)] | None = None
    selective: NonNegative | None = None
    start: NonNegative | None = None

    def options(self) -> list[str]:
        """Return the options of `rotatum estimate` that say the same."""
        words: list[str] = []
        for name, value in self.model_dump(exclude_none=True).items():
            option = "--from" if name == "start" else f"--{name}"
            if isinstance(value, bool):
                words.append(option if value else f"--no-{name}")
            elif isinstance(value, tuple):
                words += [option, ",".join(value) or "none"]
            else:
                words += [option, f"{value:g}" if isinstance(value, float) else str(value)]
        return words


class ScenarioTable(Part):
    """A scenario; what may differ from joint to joint is checked joint by joint."""

    name: str | None = None
    about: str = ""
    device: Annotated[str, Field(min_length=1)]
    seconds: Positive
    period: Positive
    log_period: Positive | None = None
    smoothing: Positive | None = None
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    truth: Anything = Field(default_factory=dict)
    told: Anything = Field(default_factory=dict)
    drives: Anything = Field(default_factory=dict)
    effects: Anything = Field(default_factory=dict)
    sensors: Anything = Field(default_factory=dict)
    start: Anything = Field(default_factory=dict)
    external: Anything | None = None
    joint: Named = Field(default_factory=dict)
    payload: tuple[Anything, ...] = ()
    accelerometer: tuple[Anything, ...] = ()
    gyroscope: tuple[Anything, ...] = ()
    inertial: Named = Field(default_factory=dict)
    estimate: EstimateTable = EstimateTable()


class DrivesTable(Part):
    """What drives a joint: its motors by a law, or each by a torque; and the set-point."""

    motors: AnyLaw | None = None
    tau: AnyDrive | None = None
    tau1: AnyDrive | None = None
    tau2: AnyDrive | None = None
    setpoint: AnyDrive | None = None
    setpoint_angle: AnyDrive | None = None
    tau_setpoint: AnyDrive | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        """A motor cannot be driven in two ways."""
        torques = self.tau or self.tau1 or self.tau2
        if self.motors is not None and torques is not None:
            raise ValueError("must be motors or torques, not both")
        return self


class StartTable(Part):
    """Where a joint starts: positions [rad] and velocities [rad/s]."""

    q: Real | None = None
    theta: Real | None = None
    theta1: Real | None = None
    theta2: Real | None = None
    setpoint_angle: Real | None = None
    dq: Real | None = None
    dtheta: Real | None = None
    dtheta1: Real | None = None
    dtheta2: Real | None = None
    dsetpoint_angle: Real | None = None


class EncodersTable(Part):
    """Counts per turn at the joint, in the place of the device's; the estimator is told them."""

    link: Positive | None = None
    motor: Positive | None = None
    setpoint: Positive | None = None


class SensorsTable(Part):
    """The encoders apart from the faults, which `Sensors` lists."""

    encoders: EncodersTable = EncodersTable()


class JointTable(Part):
    """All that a scenario says of one joint; effects and sensors mirror their dataclasses."""

    drives: DrivesTable = DrivesTable()
    effects: Anything = Field(default_factory=dict)
    sensors: Anything = Field(default_factory=dict)
    start: StartTable = StartTable()
    external: AnyDrive | None = None


def parsed(tables: Mapping[str, Any], source: str) -> ScenarioTable:
    """Check the tables of a scenario as far as that goes without its device.

    Raises
    ------
    ScenarioError naming the file, the key, the value, what is allowed and the nearest key.
    """
    try:
        return ScenarioTable.model_validate(tables)
    except ValidationError as error:
        raise explain(error, ScenarioTable, source=source, kind=ScenarioError) from None


def check_names(given: Mapping[str, Any], names: tuple[str, ...], what: str, source: str) -> None:
    """Refuse names that are not among those there are, and suggest the nearest."""
    for name in given:
        if name not in names:
            close = nearest(name, names)
            hint = f'Did you mean "{close}"?' if close else None
            raise ScenarioError(what, where=source, value=name, allowed=names, hint=hint)
