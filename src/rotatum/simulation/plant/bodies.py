"""A joint as a plant: its bodies and springs out of the device file, and their fastest rate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError, RotatumError
from rotatum.simulation.plant.effects import Effects

if TYPE_CHECKING:
    from rotatum.models.joint import Joint
    from rotatum.models.parts import Motor
    from rotatum.models.transmission import Transmission

# Smaller is truer to a sign but needs more integration steps: with the default ten a millisecond,
# a robot's elbow under friction is then right to 1e-6 rad, far below any encoder's count.
SMOOTHING = 5e-3


@dataclass(frozen=True)
class Body:
    """A turning mass with its friction, at the joint.

    ``sgn(v)`` of Coulomb friction is regularised as ``tanh(v / smoothing)``: within 0.07 % of full
    friction from four times `smoothing` on, and steep viscous friction (a creep, never true
    sticking) below it.
    """

    inertia: float  # [kg m^2]
    damping: float = 0.0  # [N m s/rad]
    coulomb: float = 0.0  # [N m]

    def rate(self, smoothing: float, more: float = 0.0) -> float:
        """Return the fastest rate of its friction alone [1/s].

        Parameters
        ----------
        smoothing
            [rad/s] of its sign.
        more
            Dry friction beyond Coulomb's [N m].
        """
        return (self.damping + (self.coulomb + more) / smoothing) / self.inertia


@dataclass(frozen=True)
class Plant:
    """A link, its motors, the springs between them, and perhaps a motor that moves a set-point.

    flacco2012 eqs 3-4 (series), 7-8 (antagonistic), 12 (serial), all on the joint side::

        M q''       + Dq q' + Cq sgn(q') + G sin(q) + sum tau_e = tau_ext
        B theta''   + D theta' + C sgn(theta')      - tau_e     = tau      for each motor
        Bc theta_c'' + Dc theta_c' + Cc sgn(theta_c') + psi_e   = tau_c    of a serial joint
        tau_e = dU/dphi + Dt phi',  psi_e = dU/ds ds/dtheta_c,  phi = q - theta,  s(theta_c)

    Attributes
    ----------
    name, actuation
        Of the joint.
    link, motors
        Its bodies; two motors for an antagonistic joint, agonist first.
    transmissions
        One for each motor, with a law.
    gravity_torque
        G [N m], q = 0 hanging down.
    setpoint_motor
        Of a serial joint whose device gives it.
    offset, slope
        The set-point is ``offset + slope * theta_c``.
    smoothing
        [rad/s] of all Coulomb friction.
    effects
        What else it does.
    """

    name: str
    actuation: str
    link: Body
    motors: tuple[Body, ...]
    transmissions: tuple[Transmission, ...]
    gravity_torque: float = 0.0
    setpoint_motor: Body | None = None
    offset: float = 0.0
    slope: float = 1.0
    smoothing: float = SMOOTHING
    effects: Effects = field(default_factory=Effects)

    @property
    def stictions(self) -> tuple[float, ...]:
        """Friction of link and motors at breaking away [N m]."""
        link, motor = self.effects.link_stiction, self.effects.motor_stiction
        given = (link, *(motor for _ in self.motors))
        bodies = (self.link, *self.motors)
        return tuple(
            body.coulomb if stiction is None else stiction
            for body, stiction in zip(bodies, given, strict=True)
        )

    @property
    def motor_roles(self) -> tuple[str, ...]:
        """What the motors' positions are called in a log."""
        return ("theta1", "theta2") if len(self.motors) == 2 else ("theta",)

    @property
    def torque_roles(self) -> tuple[str, ...]:
        """What the motors' torques are called in a log."""
        return ("tau1", "tau2") if len(self.motors) == 2 else ("tau",)

    @property
    def springs(self) -> tuple[tuple[str, int], ...]:
        """Name and number of constants of each transmission's law."""
        return tuple((t.model.name, t.constants.size) for t in self.transmissions)

    def setpoint(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the set-point (N,) of set-point motor angles (N,) [rad]."""
        return self.offset + self.slope * angle

    def rest_stiffness(self, setpoint: float) -> tuple[float, ...]:
        """Return the stiffness of each transmission [N m/rad] at no deflection."""
        return tuple(float(t.stiffness(0.0, setpoint)) for t in self.transmissions)

    def oscillation_rate(self, stiffness: Sequence[float]) -> float:
        """Return a bound on the rates [rad/s] at which the joint can swing without friction.

        Parameters
        ----------
        stiffness
            (M,) N m/rad, of the transmissions.
        """
        square = abs(self.gravity_torque) / self.link.inertia
        pairs = zip(stiffness, self._mobility, strict=True)
        return math.sqrt(square + sum(abs(k) * m for k, m in pairs))

    def friction_rate(self, loads: Sequence[float] = ()) -> float:
        """Return a bound on the rates [1/s] at which friction and spring damping stop the bodies.

        Parameters
        ----------
        loads
            (M,) N m, the largest elastic torque of each transmission; none: 0.
        """
        eps = self.smoothing
        dry = list(self.stictions)
        for m, load in enumerate(loads):
            dry[m + 1] += self.effects.load_friction * abs(load)
        bodies = (self.link, *self.motors)
        rates = [b.rate(eps, s - b.coulomb) for b, s in zip(bodies, dry, strict=True)]
        # one with viscous friction can be taken without its inertia where it is too fast
        if self.setpoint_motor is not None and self.setpoint_motor.damping == 0.0:
            rates.append(self.setpoint_motor.rate(eps))
        pairs = zip(self.transmissions, self._mobility, strict=True)
        return max(rates) + sum(t.damping * m for t, m in pairs)

    @property
    def hysteresis_stiffness(self) -> float:
        """Stiffness [N m/rad] that hysteresis adds to a spring where it turns, 2 h / d."""
        return 2.0 * self.effects.hysteresis_torque / self.effects.hysteresis_deflection

    def fastest_rate(self, stiffness: Sequence[float], loads: Sequence[float] = ()) -> float:
        """Return a bound on the plant's fastest rate [rad/s], its springs not moving the set-point.

        In mass-weighted coordinates the linearised plant is ``[[0, W], [-W, -Z]]``, whose spectral
        radius is at most ``|W| + |Z|``: the stiffness part plus the friction part.

        Parameters
        ----------
        stiffness
            (M,) N m/rad, of the transmissions.
        loads
            (M,) N m, the largest elastic torque of each.
        """
        stiffest = [abs(k) + self.hysteresis_stiffness for k in stiffness]
        return self.oscillation_rate(stiffest) + self.friction_rate(loads)

    @property
    def _mobility(self) -> list[float]:
        return [1.0 / self.link.inertia + 1.0 / motor.inertia for motor in self.motors]

    def energy(self, at: NDArray[np.void]) -> NDArray[np.float64]:
        """Return kinetic, gravity and elastic energy (N,) [J] of outputs (N,) of the stage.

        Zero at rest, hanging, springs at their rest. The set-point motor's kinetic energy counts
        where the device gives that motor; what hysteresis holds and a payload do not.
        """
        half = 0.5 * self.effects.backlash
        kinetic = self.link.inertia * at["dq"] ** 2
        elastic = np.zeros_like(kinetic)
        for m, (motor, t) in enumerate(zip(self.motors, self.transmissions, strict=True)):
            kinetic += motor.inertia * at["dtheta"][:, m] ** 2
            x = at["deflection"][:, m] + t.preload
            felt = at["deflection"][:, m] - np.clip(x, -half, half)
            elastic += at["scale"] * t.energy(felt, at["setpoint"])
        if self.setpoint_motor is not None:
            kinetic += self.setpoint_motor.inertia * at["dangle"] ** 2
        gravity = self.gravity_torque * (1.0 - np.cos(at["q"]))
        energy: NDArray[np.float64] = 0.5 * kinetic + elastic + gravity
        return energy


def plant_of(
    joint: Joint, *, smoothing: float = SMOOTHING, effects: Effects | None = None
) -> Plant:
    """Return the plant a device file's joint describes (reflected to the joint side).

    Raises `DeviceError` for a missing motor inertia, link inertia or transmission law, and
    `RotatumError` for a smoothing that is not positive or stiction below Coulomb friction.
    """
    if not joint.motors:
        raise _missing(joint, "motor.inertia")
    if joint.link is None or joint.link.inertia is None:
        raise _missing(joint, "link.inertia")
    if any(t.law is None for t in joint.transmissions):
        raise _missing(joint, "transmission.law")
    if not (smoothing > 0.0 and math.isfinite(smoothing)):
        raise RotatumError(
            "Coulomb friction needs a velocity to change its sign over",
            where=f"{joint.name}, smoothing",
            value=smoothing,
            allowed="above 0 rad/s",
        )
    setpoint = joint.setpoint
    moved = setpoint.motor if setpoint is not None else None
    plant = Plant(
        name=joint.name,
        actuation=joint.actuation,
        link=Body(joint.link.inertia.value, joint.link.damping.value, joint.link.coulomb.value),
        motors=tuple(_body(joint, motor, "motor.inertia") for motor in joint.motors),
        transmissions=joint.transmissions,
        gravity_torque=joint.link.gravity_torque,
        setpoint_motor=_body(joint, moved, "setpoint.motor.inertia") if moved else None,
        offset=setpoint.value(0.0) if setpoint is not None else 0.0,
        slope=setpoint.slope if setpoint is not None else 1.0,
        smoothing=smoothing,
        effects=Effects() if effects is None else effects,
    )
    _check_stiction(plant)
    return plant


def _check_stiction(plant: Plant) -> None:
    """Refuse Stribeck curves that rise."""
    names = ("link_stiction", *("motor_stiction" for _ in plant.motors))
    bodies = (plant.link, *plant.motors)
    for name, body, stiction in zip(names, bodies, plant.stictions, strict=True):
        if stiction < body.coulomb:
            raise RotatumError(
                "friction at breaking away is at least Coulomb friction",
                where=f"{plant.name}, effects.{name}",
                value=stiction,
                allowed=f"{body.coulomb:.6g} N m or more",
            )


def _body(joint: Joint, motor: Motor, key: str) -> Body:
    inertia = motor.reflected_inertia
    if inertia is None:
        raise _missing(joint, key)
    return Body(inertia.value, motor.reflected_damping.value, motor.reflected_coulomb.value)


def _missing(joint: Joint, key: str) -> DeviceError:
    return DeviceError(
        f"simulating the joint needs {key}, which it does not give", where=joint.name
    )
