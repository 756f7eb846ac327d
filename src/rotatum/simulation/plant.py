"""The series-elastic joint as a plant: equations of motion, energy, fastest rate."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from rotatum.errors import DeviceError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rotatum.models.joint import Joint

# Smaller is truer to a sign but needs more integration steps: with the default ten a millisecond,
# a robot's elbow under friction is then right to 1e-6 rad, far below any encoder's count.
SMOOTHING = 5e-3


class SeriesPlant(NamedTuple):
    """Constants of a motor and a link joined by one spring, all on the joint side.

    With the deflection ``phi = q - theta``::

        M q''     + Dq q' + Cq sgn(q') + G sin(q) + tau_e = tau_ext
        B theta'' + D theta' + C sgn(theta')      - tau_e = tau
        tau_e = K phi + K3 phi^3 + Dt phi'

    ``sgn(v)`` is regularised as ``tanh(v / smoothing)``: within 0.04 % of full Coulomb friction
    from four times `smoothing` on, and steep viscous friction (a creep, never true sticking)
    below it.
    """

    link_inertia: float  # M [kg m^2]
    link_damping: float  # Dq [N m s/rad]
    link_coulomb: float  # Cq [N m]
    gravity_torque: float  # G [N m], q = 0 hanging down
    motor_inertia: float  # B [kg m^2]
    motor_damping: float  # D [N m s/rad]
    motor_coulomb: float  # C [N m]
    stiffness: float  # K [N m/rad]
    cubic: float = 0.0  # K3 [N m/rad^3]
    spring_damping: float = 0.0  # Dt [N m s/rad]
    smoothing: float = SMOOTHING  # [rad/s]

    def elastic_torque(self, phi: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``K phi + K3 phi^3`` (N,) [N m] at deflections (N,) [rad], without damping."""
        return (self.stiffness + self.cubic * phi * phi) * phi

    def elastic_stiffness(self, phi: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``K + 3 K3 phi^2`` (N,) [N m/rad] at deflections (N,) [rad]."""
        return self.stiffness + 3.0 * self.cubic * phi * phi


class State(NamedTuple):
    """Positions [rad] and velocities [rad/s] of link and motor, on the joint side."""

    q: float = 0.0
    dq: float = 0.0
    theta: float = 0.0
    dtheta: float = 0.0


def accelerations(
    plant: SeriesPlant, state: tuple[float, ...], tau: float, tau_ext: float
) -> tuple[float, float]:
    """Return ``(q'', theta'')`` [rad/s^2] under torques `tau` and `tau_ext` [N m]."""
    M, Dq, Cq, G, B, D, C, K, K3, Dt, eps = plant
    q, dq, theta, dtheta = state
    phi = q - theta
    tau_e = (K + K3 * phi * phi) * phi + Dt * (dq - dtheta)
    link = tau_ext - tau_e - G * math.sin(q) - Dq * dq
    motor = tau + tau_e - D * dtheta
    # tanh is the dearest operation of the loop, so joints without Coulomb friction skip it
    if Cq != 0.0:
        link -= Cq * math.tanh(dq / eps)
    if C != 0.0:
        motor -= C * math.tanh(dtheta / eps)
    return link / M, motor / B


def energy(plant: SeriesPlant, state: State) -> float:
    """Return kinetic, gravity and elastic energy [J]; zero at rest, hanging, spring unloaded."""
    phi = state.q - state.theta
    kinetic = plant.link_inertia * state.dq**2 + plant.motor_inertia * state.dtheta**2
    elastic = plant.stiffness * phi**2 + 0.5 * plant.cubic * phi**4
    return 0.5 * (kinetic + elastic) + plant.gravity_torque * (1.0 - math.cos(state.q))


def fastest_rate(plant: SeriesPlant) -> float:
    """Return a bound on the plant's fastest rate at small deflection [rad/s].

    In mass-weighted coordinates the linearised plant is ``[[0, W], [-W, -Z]]``, whose spectral
    radius is at most ``|W| + |Z|``: the stiffness part plus the friction part.
    """
    M, Dq, Cq, G, B, D, C, K, _, Dt, eps = plant
    mobility = 1.0 / M + 1.0 / B
    oscillation = math.sqrt(abs(K) * mobility + abs(G) / M)
    return oscillation + max((Dq + Cq / eps) / M, (D + C / eps) / B) + Dt * mobility


def plant_of(joint: Joint, *, smoothing: float = SMOOTHING) -> SeriesPlant:
    """Return the plant a device file's series joint describes (reflected to the joint side).

    Raises `DeviceError` for another actuation, or a missing motor inertia, link inertia or
    transmission law.
    """
    if joint.actuation != "series":
        raise DeviceError(
            "only series joints can be simulated",
            where=f"{joint.name}.actuation",
            value=joint.actuation,
            allowed=("series",),
        )
    motor = joint.motors[0] if joint.motors else None
    inertia = motor.reflected_inertia if motor is not None else None
    if motor is None or inertia is None:
        raise _missing(joint, "motor.inertia")
    link, spring = joint.link, joint.transmission
    if link is None or link.inertia is None:
        raise _missing(joint, "link.inertia")
    if spring.stiffness is None:
        raise _missing(joint, "transmission.law")
    return SeriesPlant(
        link_inertia=link.inertia.value,
        link_damping=link.damping.value,
        link_coulomb=link.coulomb.value,
        gravity_torque=link.gravity_torque,
        motor_inertia=inertia.value,
        motor_damping=motor.reflected_damping.value,
        motor_coulomb=motor.reflected_coulomb.value,
        stiffness=spring.stiffness,
        cubic=spring.cubic or 0.0,
        spring_damping=spring.damping,
        smoothing=smoothing,
    )


def _missing(joint: Joint, key: str) -> DeviceError:
    return DeviceError(
        f"simulating the joint needs {key}, which it does not give", where=joint.name
    )
