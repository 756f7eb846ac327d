"""What a device file says once for all of its joints: the arm, and the sensors on its links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from rotatum.errors import DeviceError
from rotatum.models.explain import explain
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.models.robot.description import RobotTable
from rotatum.models.robot.names import no_such
from rotatum.models.table import Table

__all__ = ["ARM_KEYS", "Arm", "arm_of"]

ARM_KEYS = ("robot", "accelerometer", "gyroscope")
"""Keys of a device file that are the whole arm's."""


class Arm(Table):
    """The arm, and the sensors on its links."""

    robot: RobotTable | None = None
    accelerometer: tuple[Accelerometer, ...] = ()
    gyroscope: tuple[Gyroscope, ...] = ()


def arm_of(tables: Mapping[str, Any], joints: tuple[str, ...], source: str) -> Arm:
    """Read the arm out of the tables of a device file.

    Parameters
    ----------
    tables : the parsed TOML.
    joints : names of the device's joints, in the order of the file.
    source : where the tables came from, for messages and for paths relative to it.

    Raises
    ------
    DeviceError if the arm has not these joints, or there is no such frame for a sensor.
    """
    given = {key: tables[key] for key in ARM_KEYS if key in tables}
    for key in ARM_KEYS[1:]:
        sensors = given.get(key, [])
        if not isinstance(sensors, list) or not all(isinstance(s, Mapping) for s in sensors):
            raise DeviceError(f"{key} must be an array of tables: [[{key}]]", where=source)
    if not isinstance(given.get("robot", {}), Mapping):
        raise DeviceError("robot must be a table", where=source, value=given["robot"])
    try:
        arm = Arm.model_validate(given)
    except ValidationError as error:
        raise explain(error, Arm, source=source, place="") from None
    robot = None if arm.robot is None else arm.robot.of(joints, source)
    _check_mounting("accelerometer", arm.accelerometer, robot, source)
    _check_mounting("gyroscope", arm.gyroscope, robot, source)
    return arm.model_copy(update={"robot": robot})


def _check_mounting(
    key: str,
    sensors: Sequence[Accelerometer | Gyroscope],
    robot: RobotTable | None,
    source: str,
) -> None:
    """Refuse sensors on links that are not there, and two of one name."""
    if sensors and robot is None:
        what = f"[[{key}]] sits on a link of an arm, and there is no [robot]"
        raise DeviceError(what, where=source)
    for sensor in sensors:
        if robot is not None and sensor.frame not in robot.frames:
            where = f'{source}: {key} "{sensor.name}"'
            raise no_such("frame", sensor.frame, robot.frames, where=where)
    names = [sensor.name for sensor in sensors]
    if len(set(names)) < len(names):
        raise DeviceError(f"two {key}s have the same name", where=source, value=names)
