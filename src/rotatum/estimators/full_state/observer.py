"""The full state of a robot with elastic joints, sample by sample (deluca2007)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.front import Front, FrontStep
from rotatum.estimators.full_state.links import links_of
from rotatum.estimators.full_state.poles import DAMPING, Pair
from rotatum.estimators.full_state.rescheduling import largest_relative_rate
from rotatum.estimators.full_state.springs import Tangents, law_setpoints
from rotatum.estimators.full_state.stage import (
    designs_of,
    luenberger_params,
    luenberger_stage,
    pole_pairs,
)
from rotatum.estimators.full_state.states import FullState
from rotatum.models import Device
from rotatum.record import Records
from rotatum.runtime.bank import Bank

__all__ = ["StateObserver"]

Array = NDArray[np.float64]


class StateObserver:
    """Observes link and motor positions and velocities beyond elastic joints.

    Each joint has the observer of deluca2007 eq. 6 (eq. 7 with inertial coupling, eq. 12 with
    accelerometers on the links), whose error obeys ``e' = (A - L C) e`` with the poles chosen here,
    whatever the links weigh: nothing of their dynamics is in it but gravity at the start,
    which is taken to be at rest. Accelerations of the links come from the device's accelerometers
    (`JointAccelerations`), each at the pose and the speed the observers themselves tell, one sample
    ahead; or from channels ``acceleration`` of the joints.

    Departs from the paper: the discretisation is exact, not explicit; stiffness may be nonlinear
    (the law's tangent at the observed deflection) or given sample by sample; accelerations that the
    sensors hardly tell are damped and flagged; gyroscopes may take part.

    Args:
        device: series or serial joints, with motor inertia and a transmission law.
        period: s.
        frequency: of both pairs of poles of every joint [rad/s]; None: 250, or 0.3 pi / period
            where that is lower.
        damping: of both pairs.
        poles: joint to its two pairs, in place of these.
        gyro: gain of the gyroscopes [1/s]; None: half of the frequency where a joint has one;
            0: they are not used.
        noise: accelerometer or gyroscope to the standard deviation of its readings, where they
            differ [m/s^2, rad/s].
        accelerations: ``"accelerometers"``, or ``"joints"`` where each link's own acceleration is
            measured; None: accelerometers where the device has any.
        holds: joint to whether its torque is a command that is held until the next sample; None:
            the device's channels.
        follows: whether a stiffness is given with every sample; it is then followed no faster than
            half of `largest_relative_rate`, within which the error is stable under any change.

    Attributes:
        columns, gyro_columns: names of the readings ``update`` takes, in order.
        determined: (n,) joints whose acceleration the sensors determine; the others are ``unseen``
            in every status, and their links follow the motors as springs without a load would.
        designs: per joint (`figures` tells what to expect of them).

    Raises:
        MethodError: a joint that cannot be observed, poles that do not fit the period, a device
            without sensors.
        ExtraError: the arm needs pinocchio.
    """

    def __init__(
        self,
        device: Device,
        *,
        period: float,
        frequency: float | None = None,
        damping: float = DAMPING,
        poles: Mapping[str, tuple[Pair, Pair]] | None = None,
        gyro: float | None = None,
        noise: Mapping[str, float] | None = None,
        accelerations: str | None = None,
        holds: Mapping[str, bool] | None = None,
        follows: bool = False,
    ) -> None:
        self.device = device
        self.period = float(period)
        self._links = links_of(device, accelerations, noise, gyroscopes=gyro != 0.0)
        self.columns, self.gyro_columns = self._links.columns, self._links.gyro_columns
        self.determined = self._links.determined
        self.designs = designs_of(
            device.joints, self.period, pole_pairs(device.joints, self.period, frequency, damping,
            poles or {}), gyro=gyro, turning=self._links.gyro_determined, holds=holds or {},
        )  # fmt: skip
        stage = luenberger_stage(guard=False)
        change = min(_change(design) for design in self.designs) if follows else 0.0
        params = luenberger_params(stage, device.joints, self.designs, change=change)
        self.bank = Bank(stage, params)
        n = len(device.joints)
        self._front = Front(device.joints, self._links.readings, self.period)
        self._tangents = Tangents(device.joints)
        self._zero = np.array([_zero(joint.transmission.zero) for joint in device.joints])
        self._u, self._out = stage.input.zeros(n), stage.output.zeros(n)
        self._state = FullState(self._out, self._zero)
        self._none = np.zeros(n)
        self._last = self._none
        self._samples = 0

    def update(
        self,
        *,
        theta: ArrayLike,
        tau: ArrayLike,
        readings: ArrayLike | None = None,
        rates: ArrayLike | None = None,
        setpoint: ArrayLike | None = None,
        stiffness: ArrayLike | None = None,
        acted: bool = False,
        time: float | None = None,
    ) -> FullState:
        """Take one sample of everything; a bad one is skipped and said in ``status``.

        Args:
            theta: (n,) motor positions at the joint [rad].
            tau: (n,) motor torques at the joint [N m], as a log has them: measured at the instant,
                or commanded from it on.
            readings: (M,) m/s^2, as `columns` says; or (n,) link accelerations [rad/s^2]. A NaN is
                a sensor that said nothing.
            rates: (G,) rad/s, as `gyro_columns` says; None: none came.
            setpoint: (n,) as logged (serial joints).
            stiffness: (n,) N m/rad to be used, an estimate; 0: the device's, NaN: that in use;
                None: the device's law at the observed deflection.
            acted: tau is what has acted since the sample before: all that a controller knows which
                waits for this state.
            time: of the sample [s]; None: one period after the one before.

        Returns:
            The state at the sample; the same object every time.

        Raises:
            MethodError: readings of another number than the device's sensors have.
        """
        now = self._samples * self.period if time is None else time
        self._samples += 1
        inertial = self._links.joined(readings, rates)
        levers = self._none if setpoint is None else np.asarray(setpoint, dtype=np.float64)
        for step in self._front.advance(
            now, np.asarray(theta, dtype=np.float64), np.asarray(tau, dtype=np.float64),
            levers, inertial,
        ):  # fmt: skip
            if acted and not step.hold:
                self.bank.state["torque"] = step.torque
            self._take(step, stiffness)
        return self._state

    def run(
        self,
        time: Array,
        theta: Array,
        tau: Array,
        setpoint: Array,
        readings: Array,
        rates: Array,
    ) -> Records:
        """Take a batch: the same steps as ``update``, one after the other.

        Args:
            time: (N,) s.
            theta, tau, setpoint: (N, n) rad, N m, as logged.
            readings, rates: (N, M) and (N, G), as `columns` and `gyro_columns` say.

        Returns:
            (N, n) records of ``LuenbergerEstimate``, motor positions from the encoders' zero.
        """
        found = np.zeros((len(time), len(self._out)), self._out.dtype)
        for k in range(len(time)):
            self.update(
                theta=theta[k], tau=tau[k], setpoint=setpoint[k], readings=readings[k],
                rates=rates[k], time=float(time[k]),
            )  # fmt: skip
            found[k] = self._out
        found["theta_hat"] -= self._zero
        return found

    def _take(self, step: FrontStep, stiffness: ArrayLike | None) -> None:
        u = self._u
        u["time"], u["status"] = step.time, step.status
        u["hold"], u["fresh"] = step.hold, step.fresh
        if not step.hold:
            theta = u["theta"]
            theta[:] = step.theta + self._zero
            u["torque"] = step.torque
            levers = law_setpoints(self.device.joints, step.setpoint)
            q, dq = self._ahead(step.fresh, theta, levers)
            told = self._links.tell(q, dq, step.inertial)
            u["acceleration"], u["rate"], u["seen"] = told.acceleration, told.rate, told.seen
            u["coupling"] = told.coupling
            u["status"] |= told.status
            self._bend(q - theta, levers, stiffness)
            self._last = told.acceleration
        self.bank.update(u, self._out)

    def _ahead(self, fresh: bool, theta: Array, levers: Array) -> tuple[Array, Array]:
        """Where the links are by what was known before this sample: at rest, or moved on."""
        if fresh:
            q = self._links.rest(theta, levers)
            self._u["rest"] = q - theta
            return q, self._none
        T, q, dq = self.period, self._out["q_hat"], self._out["dq_hat"]
        return q + T * (dq + 0.5 * T * self._last), dq + T * self._last

    def _bend(self, deflection: Array, levers: Array, stiffness: ArrayLike | None) -> None:
        """Fill stiffness and bias: the law's tangent, or the stiffness that was given."""
        u = self._u
        if stiffness is None:
            self._tangents.move(deflection, levers)
            u["stiffness"], u["bias"] = self._tangents.stiffness, self._tangents.bias
        else:
            # Not a number: the one in use stays.
            u["stiffness"], u["bias"] = stiffness, 0.0

    def reset(self) -> None:
        """Forget everything: every joint in its initial state, time back at 0."""
        self._samples = 0
        self._front.reset()
        self.bank.reset()
        self._last = self._none

    def __repr__(self) -> str:
        first = self.designs[0].pairs[0]
        return (
            f"StateObserver({self.device.name}, {self.period:g} s, "
            f"{first.frequency:g} rad/s, {first.damping:g})"
        )


def _change(design: Design) -> float:
    """Largest relative change of the stiffness per sample."""
    spring = design.drivetrain
    found = largest_relative_rate(
        design.period, design.pairs, gyro=design.gyro, relaxation=spring.damping / spring.stiffness
    )
    return 0.5 * found.rate * design.period


def _zero(filed: float | str) -> float:
    """Zero of a spring as far as a motor's encoder can know it."""
    return float(filed) if isinstance(filed, float | int) else 0.0
