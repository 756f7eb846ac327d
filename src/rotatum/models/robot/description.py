"""The table [robot] of a device file: the rigid arm whose joints its [[joint]] tables are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from rotatum.errors import DeviceError
from rotatum.models.robot.names import no_such
from rotatum.models.robot.packaged import read_urdf
from rotatum.models.robot.urdf_tree import read_tree
from rotatum.models.sources import check_key, flat_sources
from rotatum.models.table import NonNegative, Positive, Real, Table, bad_value

if TYPE_CHECKING:
    from rotatum.models.robot.interface import Robot

__all__ = ["PayloadTable", "RobotTable"]

Vector = tuple[Real, Real, Real]

_SIZES = {"pendulum": 1, "planar": 2}
_CLOSED_FRAMES = {"pendulum": ("link", "tip"), "planar": ("link1", "link2", "elbow", "tip")}
_OF_MODELS = ("lengths", "masses", "centres", "inertias", "motor_masses")
_OF_URDF = ("joints", "locked")


class PayloadTable(Table):
    """A body fixed to a frame of the arm.

    frame; mass [kg]; position [m], of its centre of mass in the frame; inertia [kg m^2], three rows
    about that centre in the frame's axes (absent: a point).
    """

    frame: str
    mass: Positive
    position: Vector = (0.0, 0.0, 0.0)
    inertia: tuple[Vector, Vector, Vector] | None = None


class RobotTable(Table):
    """The rigid arm.

    model "pendulum" or "planar", with lengths [m], masses [kg], centres of mass [m from the joint]
    (absent: the middle), inertias [kg m^2] about them (absent: uniform thin rods), motor_masses
    [kg] at the joints after the first; or urdf, a packaged name or a path relative to the device
    file, with joints (its names of the device's joints; absent: the same) and locked (joint ->
    [rad], of those that are no joint of the device; 0 if not named). gravity [m/s^2]; coupling:
    rows of S [kg m^2] between link i and motor j > i (deluca2007 eq. 2); payload; sources: key ->
    where its number is from.
    """

    model: Literal["pendulum", "planar"] | None = None
    urdf: Annotated[str, Field(min_length=1)] | None = None
    lengths: tuple[Positive, ...] | None = None
    masses: tuple[Positive, ...] | None = None
    centres: tuple[Real, ...] | None = None
    inertias: tuple[NonNegative, ...] | None = None
    motor_masses: tuple[NonNegative, ...] = ()
    joints: tuple[str, ...] | None = None
    locked: Mapping[str, Real] = Field(default_factory=dict)
    gravity: NonNegative = 9.81
    coupling: tuple[tuple[Real, ...], ...] | None = None
    payload: PayloadTable | None = None
    sources: Annotated[Mapping[str, str], BeforeValidator(flat_sources)] = Field(
        default_factory=dict
    )
    _names: tuple[str, ...] = PrivateAttr(default=())
    _text: str = PrivateAttr(default="")

    @property
    def coupling_matrix(self) -> NDArray[np.float64]:
        """S of deluca2007 eq. 2, (n, n) kg m^2: links in rows, motors in columns."""
        n = len(self._names)
        return np.zeros((n, n)) if self.coupling is None else np.array(self.coupling)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames of its links."""
        if self.model is not None:
            return _CLOSED_FRAMES[self.model]
        return tuple(read_tree(self._text, self.urdf or "").links)

    def of(self, names: tuple[str, ...], source: str) -> RobotTable:
        """Return the table bound to the device's joints, its URDF file read and checked.

        Parameters
        ----------
        names : of the device's joints, in the order along the arm.
        source : the device file, which the path of a URDF file is relative to.

        Raises
        ------
        DeviceError if the arm has not these joints, or the URDF file cannot be used.
        """
        bound = self.model_copy()
        bound._names = names
        if self.urdf is not None:
            bound._text = read_urdf(self.urdf, Path(source).parent, where=f"{source}: robot.urdf")
            tree = read_tree(bound._text, f"{source}: {self.urdf}")
            bound._check_count(self.joints or names, "robot.joints", source)
            tree.check_locked(tree.arm(self.joints or names), self.locked)
        else:
            bound._check_closed(source)
        bound._check_coupling(source)
        if self.payload is not None and self.payload.frame not in bound.frames:
            where = f"{source}: robot.payload"
            raise no_such("frame", self.payload.frame, bound.frames, where=where)
        return bound

    def build(self) -> Robot:
        """Return the arm, its payload fixed to it; the table must be bound to joints.

        Raises
        ------
        DeviceError for numbers that no arm has; ExtraError where pinocchio is needed and not there.
        """
        robot = self._closed() if self.urdf is None else self._from_urdf(self.urdf)
        load = self.payload
        if load is None:
            return robot
        return robot.with_payload(load.frame, load.mass, load.position, load.inertia)

    def _from_urdf(self, name: str) -> Robot:
        from rotatum.models.robot.urdf import UrdfRobot

        joints = self.joints or self._names
        return UrdfRobot(self._text, joints, self.locked, self.gravity, name, names=self._names)

    def _closed(self) -> Robot:
        """Return the arm of a closed form."""
        from rotatum.models.robot.pendulum import Pendulum
        from rotatum.models.robot.planar import Planar, rod

        lengths, masses = self.lengths or (), self.masses or ()
        if self.model == "planar":
            return Planar(
                lengths, masses, centres=self.centres, inertias=self.inertias,
                motor_masses=self.motor_masses, gravity=self.gravity, names=self._names,
            )  # fmt: skip
        centre = 0.5 * lengths[0] if self.centres is None else self.centres[0]
        own = None if self.inertias is None else self.inertias[0]
        body = rod(lengths[0], masses[0], centre, own)
        torque = body.along * self.gravity
        return Pendulum(body.inertia, torque, lengths[0], gravity=self.gravity, name=self._names[0])

    def _check_closed(self, source: str) -> None:
        """Refuse lists of another length than the arm's."""
        n = _SIZES[self.model or "planar"]
        if len(self._names) != n:
            what = f'robot.model "{self.model}" has {n} joint{"s" if n > 1 else ""}'
            raise DeviceError(what, where=source, value=list(self._names))
        for key in ("lengths", "masses", "centres", "inertias"):
            numbers = getattr(self, key)
            if numbers is not None:
                self._check_count(numbers, f"robot.{key}", source)
        if len(self.motor_masses) > n - 1:
            what = f"robot.motor_masses has one number for each joint after the first, so {n - 1}"
            raise DeviceError(what, where=source, value=list(self.motor_masses))

    def _check_count(self, given: tuple[object, ...], key: str, source: str) -> None:
        """Refuse a list that has not one entry for each joint."""
        n = len(self._names)
        if len(given) != n:
            what = f"{key} needs one entry for each [[joint]], so {n}"
            raise DeviceError(what, where=source, value=list(given))

    def _check_coupling(self, source: str) -> None:
        """Refuse an S that is not strictly upper triangular."""
        if self.coupling is None:
            return
        for row in (self.coupling, *self.coupling):
            self._check_count(row, "robot.coupling", source)
        if np.any(np.tril(self.coupling_matrix)):
            what = "robot.coupling must be 0 on and below its diagonal"
            hint = "Row i, column j > i: rotor j turns about its own axis as link i does."
            raise DeviceError(what, where=source, value=[list(r) for r in self.coupling], hint=hint)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        """Refuse keys of the other kind of arm."""
        if (self.model is None) == (self.urdf is None):
            raise ValueError('give model ("pendulum" or "planar") or urdf, one of them')
        foreign, kind = (_OF_URDF, "model") if self.model is not None else (_OF_MODELS, "urdf")
        for key in foreign:
            if getattr(self, key):
                raise ValueError(f"{key} does not go with {kind}")
        for key in ("lengths", "masses"):
            if self.model is not None and getattr(self, key) is None:
                raise bad_value("is needed with model", key, None)
        tables: dict[str, tuple[str, ...]] = dict.fromkeys(RobotTable.model_fields, ())
        tables["payload"] = tuple(PayloadTable.model_fields)
        for key in self.sources:
            check_key(key, tables)
        return self
