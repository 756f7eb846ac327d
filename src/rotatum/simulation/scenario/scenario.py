"""A scenario: who moves, what drives, what is wrong, for how long; and the log of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rotatum.errors import RotatumError, ScenarioError
from rotatum.models.device import Device, load_device
from rotatum.simulation.drivers.compensation import GravityCompensation, gravity_of
from rotatum.simulation.payload import Payload
from rotatum.simulation.plant.bodies import SMOOTHING
from rotatum.simulation.scenario.device_tables import device_toml, plain_channels, replaced
from rotatum.simulation.scenario.dotted import assigned, flat, path_of
from rotatum.simulation.scenario.joint_plan import JointPlan, joint_plans
from rotatum.simulation.scenario.mirror import read
from rotatum.simulation.scenario.sources import anchored, read_tables
from rotatum.simulation.scenario.tables import EstimateTable, ScenarioTable, check_names, parsed
from rotatum.simulation.sensing.inertial import InertialFaults

if TYPE_CHECKING:
    from rotatum.logs.log import Log

__all__ = ["Scenario", "load_scenario", "scenario_from_tables"]

Progress = Callable[[int, int | None], None]
"""Called with samples done and samples expected."""


@dataclass(frozen=True)
class Scenario:
    """A checked scenario.

    Parameters
    ----------
    name : its name.
    source : path of its file, or "ready:NAME".
    tables : of its file, with what it extends; `scenario_from_tables` makes it of them again.
    table : the same, checked.
    device : what the estimator is told: the device, its torques marked as held, the encoders of
        the scenario, and what [told] replaces.
    plant : what is simulated: the device with what [truth] replaces.
    joints : what it says of each joint.
    inertial : accelerometer or gyroscope -> what is wrong with it.
    payloads : masses the links take up.
    """

    name: str
    source: str
    tables: Mapping[str, Any]
    table: ScenarioTable
    device: Device
    plant: Device
    joints: tuple[JointPlan, ...]
    inertial: Mapping[str, InertialFaults]
    payloads: tuple[Payload, ...]

    @property
    def about(self) -> str:
        """What it shows, in a line."""
        return self.table.about

    @property
    def seed(self) -> int:
        """Of all random faults and drives."""
        return self.table.seed

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return self.table.seconds

    @property
    def period(self) -> float:
        """Control period [s]: torques are held for it."""
        return self.table.period

    @property
    def log_period(self) -> float | None:
        """Of the log's rows [s]; None: the control period."""
        return self.table.log_period

    @property
    def estimate(self) -> EstimateTable:
        """How its log is to be estimated; what it does not say is None."""
        return self.table.estimate

    def with_values(self, values: Mapping[str, Any]) -> Scenario:
        """Return the scenario with other values.

        Parameters
        ----------
        values : dotted keys of the file -> value, such as {"sensors.encoders.link": 1024}; of an
            array of tables "payload[0].mass". Paths are relative to the scenario's file.

        Raises
        ------
        ScenarioError for a key or value a scenario cannot have.
        """
        tables = dict(self.tables)
        for key, value in values.items():
            path = path_of(key)
            if path[0] in ("truth", "told") and len(path) > 1:
                # a quoted key is one name here and a dotted key of the device file
                below = str(path[1]) if len(path) == 2 else key.partition(".")[2]
                tables[path[0]] = {**_dotted_values(tables.get(path[0], {})), below: value}
            else:
                tables = assigned(tables, path, value)
        return scenario_from_tables(tables, self.source)

    def device_text(self) -> str:
        """Return the text of the device file that reads its log, in canonical columns."""
        table = self.table
        remarks = [f"What the estimator is told of {self.name}; written with its log."]
        differing = ", ".join(_dotted_values(table.truth))
        if differing:
            remarks.append(f"In the simulation these were others: {differing}.")
        return device_toml(self.device, tuple(remarks))

    def run(self, seed: int | None = None, progress: Progress | None = None) -> Log:
        """Simulate; return the log with its truth.

        Parameters
        ----------
        seed : of all random faults and drives; None: the scenario's.
        progress : called with samples done and expected.

        Raises
        ------
        DeviceError for a device that cannot be simulated, RotatumError for drives and faults that
        do not fit it, SimulationError for a motion that runs away or leaves a law's range; its
        `log` is what was simulated until then.
        """
        from rotatum.simulation.device import simulate

        own = self.seed if seed is None else seed
        pushed = {plan.joint.name: plan.pushed(own) for plan in self.joints}
        return simulate(
            self.plant,
            seconds=self.seconds,
            period=self.period,
            drives=self._drives(own),
            sensors={plan.joint.name: plan.sensors for plan in self.joints},
            inertial=self.inertial,
            effects={plan.joint.name: plan.effects for plan in self.joints},
            external={name: push for name, push in pushed.items() if push is not None},
            payloads=self.payloads,
            start={plan.joint.name: plan.start for plan in self.joints},
            log_period=self.log_period,
            smoothing=self.table.smoothing or SMOOTHING,
            seed=own,
            told=self.device,
            progress=progress,
        )

    def _drives(self, seed: int) -> dict[str, Any]:
        """Return joint -> role -> what drives it."""
        asked = {plan.gravity for plan in self.joints} - {None}
        robot = self.plant.build_robot() if asked else None
        # One for all joints, which then reckon the arm's gravity once.
        gravity: dict[str | None, GravityCompensation] = {
            at: gravity_of(self.plant.joints, robot, at=at) for at in asked if at is not None
        }
        return {
            plan.joint.name: plan.driven(seed, gravity.get(plan.gravity)) for plan in self.joints
        }


def scenario_from_tables(tables: Mapping[str, Any], source: str) -> Scenario:
    """Check a scenario and load its device.

    Parameters
    ----------
    tables : the parsed TOML, with what it extends.
    source : where they came from, for messages; paths in them are relative to it.

    Raises
    ------
    ScenarioError naming the file, the key, the value, what is allowed and the nearest key;
    DeviceError for its device.
    """
    whole = anchored(tables, source)
    table = parsed(whole, source)
    filed = load_device(table.device)
    given = joint_plans(table, filed.joints, source)
    counts = {
        f"{plan.joint.name}.encoders.{side}": count
        for plan in given
        for side, count in plan.encoders.items()
    }
    shown = replaced(filed, counts, source=source, place="sensors.encoders")
    mounted = {"accelerometer": table.accelerometer, "gyroscope": table.gyroscope}
    more = {key: list(sensors) for key, sensors in mounted.items() if sensors}
    shown = replaced(shown, more, source=source, place="accelerometer, gyroscope")
    truth, told = _dotted_values(table.truth), _dotted_values(table.told)
    plant = replaced(shown, truth, source=source, place="truth")
    known = replaced(shown, told, source=source, place="told")
    _same_joints(filed, (plant, known), source)
    device = plain_channels(known, _held(table, given, known))
    plans = joint_plans(table, plant.joints, source)
    for plan in plans:
        _check_drives(plan, source)
    sensors = tuple(s.name for s in (*plant.accelerometers, *plant.gyroscopes))
    check_names(table.inertial, sensors, "[inertial]: the device has no such sensor", source)
    return Scenario(
        name=table.name or source,
        source=source,
        tables=whole,
        table=table,
        device=device,
        plant=plant,
        joints=plans,
        inertial={
            name: read(InertialFaults, raw, source=source, place=f"inertial.{name}.")
            for name, raw in table.inertial.items()
        },
        payloads=tuple(
            read(Payload, raw, source=source, place=f"payload[{k}].")
            for k, raw in enumerate(table.payload)
        ),
    )


def load_scenario(name_or_path: str | Path) -> Scenario:
    """Read a scenario from a file, or a ready one.

    Parameters
    ----------
    name_or_path : a name of `scenario_names()`, or a path.

    Raises
    ------
    ScenarioError and DeviceError as `scenario_from_tables` does, and for files that cannot be
    read or extend one another in a circle.
    """
    tables, source = read_tables(name_or_path)
    return scenario_from_tables(tables, source)


def _dotted_values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of [truth] or [told] by dotted key, whichever way it is written."""
    return dict(flat(table))


def _held(
    table: ScenarioTable, plans: tuple[JointPlan, ...], device: Device
) -> dict[str, tuple[str, ...]]:
    """Return joint -> roles of the log that last until its next row, as `simulate` marks them."""
    if table.log_period is not None and table.log_period > table.period * (1.0 + 1e-9):
        return {}
    held = {}
    for plan, joint in zip(plans, device.joints, strict=True):
        torques = tuple(role for role in ("tau", "tau1", "tau2") if role in joint.roles)
        held[joint.name] = (*torques, *(("tau_ext",) if plan.external is not None else ()))
    return held


def _same_joints(filed: Device, others: tuple[Device, ...], source: str) -> None:
    """Refuse a [truth] or [told] that makes other joints of it."""
    for device in others:
        for one, other in zip(filed.joints, device.joints, strict=True):
            if (one.name, one.actuation) != (other.name, other.actuation):
                what = "[truth] and [told] cannot change a joint's name or actuation"
                raise ScenarioError(what, where=source, value=f"{other.name}, {other.actuation}")


def _check_drives(plan: JointPlan, source: str) -> None:
    """Refuse numbers no drive can have, before anything is simulated."""
    try:
        plan.driven(0, None)
        plan.pushed(0)
    except RotatumError as error:
        at = f" ({error.where})" if error.where else ""
        raise ScenarioError(
            f"drives of {plan.joint.name}{at}: {error.what}",
            where=source,
            value=error.value,
            allowed=error.allowed,
            hint=error.hint,
        ) from None
