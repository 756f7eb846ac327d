"""One antagonistic joint as a controller knows it, and what its state says of its derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.models.elastic import Elastic

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["AntagonisticJoint", "JointState", "Outputs"]

Array = NDArray[np.float64]


class JointState(NamedTuple):
    """Where an antagonistic joint is, measured or observed.

    Parameters
    ----------
    q, dq : of the link [rad, rad/s].
    theta, dtheta : (2,) of the motors, agonist first [rad, rad/s].
    """

    q: float
    dq: float
    theta: tuple[float, float]
    dtheta: tuple[float, float]

    @property
    def finite(self) -> bool:
        """Whether all are numbers."""
        return all(map(math.isfinite, (self.q, self.dq, *self.theta, *self.dtheta)))

    @property
    def deflections(self) -> tuple[float, float]:
        """phi_i = q - theta_i [rad]."""
        return self.q - self.theta[0], self.q - self.theta[1]


class Outputs(NamedTuple):
    """Link position and total stiffness with their derivatives, up to those the motors move.

    ``(q'''', sigma_t'') = drift + matrix u``.

    Parameters
    ----------
    q : (4,) q, q', q'', q''' [rad, rad/s, ...].
    sigma : (2,) sigma_t, sigma_t' [N m/rad, N m/(rad s)].
    drift : (2,) [rad/s^4, N m/(rad s^2)].
    matrix : (2, 2), of the motor torques [1/N m of these].
    """

    q: tuple[float, float, float, float]
    sigma: tuple[float, float]
    drift: tuple[float, float]
    matrix: Array


@dataclass(frozen=True)
class AntagonisticJoint:
    """Constants of a joint whose link two motors pull on, each through a spring of its own.

    phi_i = q - theta_i, all at the joint side, c_i an offset of the motor's torque::

        M q'' + D q' + G sin(q) + tau_1(phi_1) + tau_2(phi_2) = 0
        B_i theta_i'' + D_i theta_i' - tau_i(phi_i) - c_i = u_i

    Attributes
    ----------
    link, link_damping : M [kg m^2] and D [N m s/rad].
    gravity_torque : G [N m], q = 0 hanging down.
    motors, motor_damping : (2,) B_i [kg m^2] and D_i [N m s/rad].
    limits : (2,) torque limits of the motors [N m]; inf: none.
    """

    link: float
    link_damping: float
    gravity_torque: float
    motors: tuple[float, float]
    motor_damping: tuple[float, float]
    limits: tuple[float, float] = (math.inf, math.inf)

    @classmethod
    def of(cls, joint: Joint) -> AntagonisticJoint:
        """Return what a device file says; dry friction is left out.

        Raises `DeviceError` for a joint that is not antagonistic, one without an inertia, and for
        springs with damping: torques then enter earlier derivatives than those used here.
        """
        if joint.actuation != "antagonistic":
            what = "control of position and stiffness needs two motors on one link"
            where, allowed = f"{joint.name}.actuation", ("antagonistic",)
            raise DeviceError(what, where=where, value=joint.actuation, allowed=allowed)
        for i, spring in enumerate(joint.transmissions):
            if spring.damping != 0.0:
                what = "a damper beside the spring is not taken into account here"
                where = f"{joint.name}.transmission[{i}].damping"
                raise DeviceError(what, where=where, value=spring.damping, allowed="0")
        inertias = [motor.reflected_inertia for motor in joint.motors]
        link = joint.link
        if link is None or link.inertia is None or len(inertias) != 2 or None in inertias:
            what = "a controller needs the inertias of link and motors"
            raise DeviceError(what, where=joint.name)
        first, second = (0.0 if inertia is None else inertia.value for inertia in inertias)
        a, b = joint.motors
        return cls(
            link=link.inertia.value,
            link_damping=link.damping.value,
            gravity_torque=link.gravity_torque,
            motors=(first, second),
            motor_damping=(a.reflected_damping.value, b.reflected_damping.value),
            limits=(a.reflected_torque_limit, b.reflected_torque_limit),
        )

    def held(self, period: float) -> AntagonisticJoint:
        """Return the joint as torques held over a period [s] find it: its motors are heavier.

        ``B theta'' + D theta' = u`` changes the velocity by ``T (u - D theta') / B_T`` in a period,
        exactly, ``B_T = D T / (1 - exp(-D T / B))``.
        """
        heavier = []
        for B, D in zip(self.motors, self.motor_damping, strict=True):
            decay = D * period / B
            heavier.append(D * period / -math.expm1(-decay) if decay > 0.0 else B)
        return replace(self, motors=(heavier[0], heavier[1]))

    def outputs(self, state: JointState, springs: tuple[Elastic, Elastic]) -> Outputs:
        """Return position and stiffness with their derivatives at a state, from the model.

        With ``f = D q' + G sin q``, sigma_i' and sigma_i'' derivatives by the deflection::

            M q''    = -f - sum tau_i
            M q'''   = -f' - sum sigma_i phi_i'
            M q''''  = -f'' - sum sigma_i' phi_i'^2 + sigma_i phi_i''
            sigma_t' = sum sigma_i' phi_i'
            sigma_t'' = sum sigma_i'' phi_i'^2 + sigma_i' phi_i''
            phi_i'' = q'' - (u_i + tau_i + c_i - D_i theta_i') / B_i

        Parameters
        ----------
        state
            Where the joint is.
        springs
            Both transmissions at its deflections, as they are known.
        """
        M, D, G = self.link, self.link_damping, self.gravity_torque
        sine, cosine = G * math.sin(state.q), G * math.cos(state.q)
        dq = state.dq
        ddq = -(D * dq + sine + springs[0].torque + springs[1].torque) / M
        rates = (dq - state.dtheta[0], dq - state.dtheta[1])
        pull = sum(s.stiffness * rate for s, rate in zip(springs, rates, strict=True))
        dddq = -(D * ddq + cosine * dq + pull) / M
        fourth = D * dddq + cosine * ddq - sine * dq * dq
        dsigma, ddsigma = 0.0, 0.0
        matrix = np.empty((2, 2))
        for i, (s, rate) in enumerate(zip(springs, rates, strict=True)):
            B = self.motors[i]
            # of phi_i'' what the motor's own torque does not make
            pull = s.torque + s.offset - self.motor_damping[i] * state.dtheta[i]
            free = ddq - pull / B
            fourth += s.slope * rate * rate + s.stiffness * free
            dsigma += s.slope * rate
            ddsigma += s.curvature * rate * rate + s.slope * free
            matrix[0, i] = s.stiffness / (M * B)
            matrix[1, i] = -s.slope / B
        sigma = springs[0].stiffness + springs[1].stiffness
        drift = (-fourth / M, ddsigma)
        return Outputs((state.q, dq, ddq, dddq), (sigma, dsigma), drift, matrix)
