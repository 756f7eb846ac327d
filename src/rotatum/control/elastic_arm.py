"""An arm of elastic joints as a controller knows it: links, rotors, springs, couplings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.robot.interface import Robot
from rotatum.models.robot.pendulum import Pendulum

if TYPE_CHECKING:
    from rotatum.models.device import Device
    from rotatum.models.joint import Joint
    from rotatum.models.quantity import Uncertain
    from rotatum.models.transmission import Transmission

__all__ = ["ElasticArm"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ElasticArm:
    """Constants of an arm whose joints have one motor and one spring each, at the joint side.

    deluca2007 eqs 1 and 2 with friction on both sides, phi = q - theta::

        M(q) q'' + S theta'' + C q' + g + F q' + D phi' + tau_e(phi) = 0
        S^T q'' + B theta'' + V theta' + C_m sgn(theta') - D phi' - tau_e(phi) = tau

    Attributes
    ----------
    names : of the joints.
    robot : the links.
    inertia, viscous, coulomb : (n,) B [kg m^2], V [N m s/rad] and C_m [N m] of the motors.
    springs : tau_e, one for each joint, with its damping D [N m s/rad].
    link_viscous : (n,) F [N m s/rad].
    coupling : (n, n) S [kg m^2], strictly upper triangular.
    limits : (n,) torque limits of the motors [N m]; inf: none.
    """

    names: tuple[str, ...]
    robot: Robot
    inertia: Array
    viscous: Array
    coulomb: Array
    springs: tuple[Transmission, ...]
    link_viscous: Array
    coupling: Array
    limits: Array

    @classmethod
    def of(cls, device: Device) -> ElasticArm:
        """Return what a device file says.

        Without a table [robot] the device must have one joint, a pendulum.

        Raises `DeviceError` for joints that are not driven by one motor through one spring of a
        known law, for a motor without inertia, and for several joints without an arm.
        """
        for joint in device.joints:
            _check(joint)
        motors = [joint.motors[0] for joint in device.joints]
        links = [joint.link for joint in device.joints]
        n = len(motors)
        return cls(
            names=tuple(joint.name for joint in device.joints),
            robot=_links(device),
            inertia=np.array([_known(m.reflected_inertia) for m in motors]),
            viscous=np.array([m.reflected_damping.value for m in motors]),
            coulomb=np.array([m.reflected_coulomb.value for m in motors]),
            springs=tuple(joint.transmission for joint in device.joints),
            link_viscous=np.array([0.0 if x is None else x.damping.value for x in links]),
            coupling=np.zeros((n, n)) if device.robot is None else device.robot.coupling_matrix,
            limits=np.array([m.reflected_torque_limit for m in motors]),
        )

    @property
    def size(self) -> int:
        """Number of joints n."""
        return len(self.names)

    @property
    def damping(self) -> Array:
        """D of the springs, (n,) N m s/rad."""
        return np.array([spring.damping for spring in self.springs])

    def stiffness(self, deflection: Array | None = None) -> Array:
        """Return d tau_e/d phi at deflections (n,) [rad], by default none, (n,) N m/rad."""
        at = np.zeros(self.size) if deflection is None else deflection
        return np.array(
            [spring.stiffness(x).item() for spring, x in zip(self.springs, at, strict=True)]
        )


def _check(joint: Joint) -> None:
    if joint.actuation != "series" or not joint.motors:
        what = "inverse dynamics needs joints with one motor and one spring"
        raise DeviceError(
            what, where=f"{joint.name}.actuation", value=joint.actuation, allowed=("series",)
        )
    if joint.motors[0].inertia is None:
        raise DeviceError("a controller needs the rotor's inertia", where=f"{joint.name}.motor")
    if joint.transmission.law is None:
        raise DeviceError("a controller needs the spring's law", where=f"{joint.name}.transmission")
    if joint.transmission.preload != 0.0:
        what = "a preload is not taken into account here"
        where = f"{joint.name}.transmission.preload"
        raise DeviceError(what, where=where, value=joint.transmission.preload, allowed="0")


def _links(device: Device) -> Robot:
    robot = device.build_robot()
    if robot is not None:
        return robot
    if len(device.joints) > 1:
        hint = "Give the device file a table [robot], or take one joint."
        raise DeviceError("several joints need an arm", where=device.name, hint=hint)
    joint = device.joints[0]
    if joint.link is None or joint.link.inertia is None:
        raise DeviceError("a controller needs the link's inertia", where=f"{joint.name}.link")
    return Pendulum(joint.link.inertia.value, joint.link.gravity_torque, name=joint.name)


def _known(inertia: Uncertain | None) -> float:
    assert inertia is not None  # checked before
    return inertia.value
