"""What a scenario says of one joint: the tables for all joints, and over them its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from rotatum.errors import RotatumError, ScenarioError, nearest
from rotatum.models.explain import explain
from rotatum.simulation.drivers.compensation import GravityCompensation
from rotatum.simulation.drivers.feedback import Feedback
from rotatum.simulation.drivers.waves import Drive
from rotatum.simulation.plant.effects import Effects
from rotatum.simulation.scenario.merge import merged
from rotatum.simulation.scenario.mirror import read
from rotatum.simulation.scenario.tables import (
    DrivesTable,
    JointTable,
    ScenarioTable,
    SensorsTable,
    check_names,
)
from rotatum.simulation.scenario.wave_tables import DriveTable
from rotatum.simulation.sensing.sensors import LOGGED, ROLES, Sensors

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["JointPlan", "joint_plans"]

SECTIONS = tuple(JointTable.model_fields)
_SETPOINTS = ("setpoint", "setpoint_angle", "tau_setpoint")
_DRIVEN = {
    "series": ("motors", "tau"),
    "antagonistic": ("motors", "tau1", "tau2"),
    "serial": ("motors", "tau", *_SETPOINTS),
}


@dataclass(frozen=True)
class JointPlan:
    """A joint of a scenario, checked.

    Parameters
    ----------
    joint : as it is simulated, which is also what its controllers reckon with.
    index : its place among the device's joints.
    drives : tables of what drives it.
    effects, sensors : of its plant, and of its log.
    encoders : counts per turn that replace the device's, by the keys of its [encoders].
    start : where it starts.
    external : torque on its link; None: none.
    """

    joint: Joint
    index: int
    drives: DrivesTable
    effects: Effects
    sensors: Sensors
    encoders: Mapping[str, float]
    start: Mapping[str, float]
    external: DriveTable | None

    @property
    def gravity(self) -> str | None:
        """The angles at which its law compensates gravity; None: it does not."""
        return self.drives.motors.gravity if self.drives.motors is not None else None

    def driven(self, seed: int, gravity: GravityCompensation | None) -> dict[str, Drive | Feedback]:
        """Return role -> what drives it.

        Parameters
        ----------
        seed : of random drives that give none themselves.
        gravity : of the device, at the angles of `self.gravity`.

        Raises `RotatumError` for numbers no drive can have.
        """
        made: dict[str, Drive | Feedback] = {}
        for number, role in enumerate(DrivesTable.model_fields):
            table = getattr(self.drives, role)
            own = self._seed(seed, number)
            if role == "motors" and self.drives.motors is not None:
                made |= self.drives.motors.feedback(self.joint, self.index, gravity, own)
            elif table is not None:
                made[role] = table.drive(own)
        return made

    def pushed(self, seed: int) -> Drive | None:
        """Return the torque on the link; None: there is none."""
        number = len(DrivesTable.model_fields)
        return None if self.external is None else self.external.drive(self._seed(seed, number))

    def _seed(self, seed: int, number: int) -> int:
        """Return a seed of its own for each joint and role."""
        return int(np.random.SeedSequence((seed, self.index, number)).generate_state(1)[0])


def joint_plans(
    table: ScenarioTable, joints: tuple[Joint, ...], source: str
) -> tuple[JointPlan, ...]:
    """Check and merge what a scenario says of each joint of its device.

    Raises
    ------
    ScenarioError naming the file, the key, the value, what is allowed and the nearest key.
    """
    names = tuple(joint.name for joint in joints)
    check_names(table.joint, names, "[joint]: the device has no such joint", source)
    for name, own in table.joint.items():
        check_names(own, SECTIONS, f"[joint.{name}]: unknown key", source)
    mixed = len({joint.actuation for joint in joints}) > 1
    return tuple(_plan(table, joint, k, source, mixed) for k, joint in enumerate(joints))


def _plan(table: ScenarioTable, joint: Joint, index: int, source: str, mixed: bool) -> JointPlan:
    own = table.joint.get(joint.name, {})
    whole = merged(_for_all(table, joint, mixed), own)
    try:
        found = JointTable.model_validate(whole)
    except ValidationError as error:
        place = _place(own, joint.name, error.errors()[0]["loc"])
        raise explain(error, JointTable, source=source, place=place, kind=ScenarioError) from None
    place = _place(own, joint.name, ("effects",))
    effects = read(Effects, found.effects, source=source, place=f"{place}effects.")
    sensors, encoders = _sensors(found.sensors, own, joint, source)
    return JointPlan(
        joint=joint,
        index=index,
        drives=found.drives,
        effects=effects,
        sensors=sensors,
        encoders=encoders,
        start=found.start.model_dump(exclude_none=True),
        external=found.external,
    )


def _sensors(
    raw: Mapping[str, Any], own: Mapping[str, Any], joint: Joint, source: str
) -> tuple[Sensors, dict[str, float]]:
    """Read the table [sensors]: faults, and counts of the encoders."""
    place = _place(own, joint.name, ("sensors",)) + "sensors."
    faults = {name: value for name, value in raw.items() if name != "encoders"}
    known = ("encoders", *(field.name for field in fields(Sensors)))
    for name in faults:
        if name not in known:
            close = nearest(name, known)
            raise ScenarioError(
                f'unknown key "{place}{name}"',
                where=source,
                allowed=known,
                hint=f'Did you mean "{close}"?' if close else None,
            )
    try:
        table = SensorsTable.model_validate({k: v for k, v in raw.items() if k not in faults})
    except ValidationError as error:
        raise explain(error, SensorsTable, source=source, place=place, kind=ScenarioError) from None
    sensors = read(Sensors, faults, source=source, place=place)
    encoders = table.encoders.model_dump(exclude_none=True)
    if encoders and sensors.counts is not None:
        what = f"{place}counts and {place}encoders say the same; give one of them"
        raise ScenarioError(what, where=source)
    try:
        sensors.fit(joint.actuation)
    except RotatumError as error:
        raise ScenarioError(
            f"{error.where} of {joint.name}: {error.what}",
            where=source,
            value=error.value,
            allowed=error.allowed,
            hint=error.hint,
        ) from None
    return sensors, encoders


def _for_all(table: ScenarioTable, joint: Joint, mixed: bool) -> dict[str, Any]:
    """Return what holds for all joints; of joints of several kinds, to each what it has."""
    given = {name: getattr(table, name) for name in SECTIONS if name in table.model_fields_set}
    if not mixed:
        return given
    driven, logged = _DRIVEN[joint.actuation], (*LOGGED[joint.actuation], "tau_ext")
    others = {role for roles in _DRIVEN.values() for role in roles if role not in driven}
    silent = {role for role in ROLES if role not in logged}
    if "drives" in given:
        given["drives"] = {k: v for k, v in given["drives"].items() if k not in others}
    if "sensors" in given:
        given["sensors"] = {
            name: {k: v for k, v in value.items() if k not in silent}
            if isinstance(value, Mapping) and name != "encoders"
            else value
            for name, value in given["sensors"].items()
        }
    return given


def _place(own: Mapping[str, Any], name: str, location: tuple[str | int, ...]) -> str:
    """Return the prefix of a key: the joint's, if the table is its own."""
    table: Any = own
    for part in location[:2]:
        if not isinstance(table, Mapping) or part not in table:
            return ""
        table = table[part]
    return f"joint.{name}."
