"""State and stiffness together: an observer whose stiffness is estimated from its own torque."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.estimator import Estimator
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.estimators.full_state.states import FullState
from rotatum.estimators.readings import Readings
from rotatum.kernels.status import INFORMATIVE, SETTLING
from rotatum.models import Device

__all__ = ["Both", "CombinedEstimator"]

Array = NDArray[np.float64]


class Both(NamedTuple):
    """What one ``CombinedEstimator.update`` returns.

    Args:
        state: positions and velocities of links and motors.
        readings: stiffness, its standard deviation and verdict.
    """

    state: FullState
    readings: Readings


class CombinedEstimator:
    """Observes the full state with the stiffness it estimates while the robot moves.

    The observer's elastic torque is right at low frequencies whatever stiffness it is given,
    because it balances the motor's; against the deflection of *measured* positions it is a torque
    sensor to the estimator. Where the verdict is ``informative`` the stiffness goes back into the
    observer, no faster than its error stays stable under any change (`largest_relative_rate`). With
    the observed link position instead of the encoder's the stiffness would confirm itself.

    Initial state: at rest, with the device's stiffness.

    Args:
        device: series or serial joints with link encoders and what `StateObserver` needs.
        period: s.
        observer: in place of ``StateObserver(device, period=period, follows=True)``.
        estimator: in place of ``Estimator(device, period=period, torque="sensor")``.

    Raises:
        MethodError: as the two do.
    """

    def __init__(
        self,
        device: Device,
        *,
        period: float,
        observer: StateObserver | None = None,
        estimator: Estimator | None = None,
    ) -> None:
        self.observer = observer or StateObserver(device, period=period, follows=True)
        self.estimator = estimator or Estimator(device, period=period, torque="sensor")
        self._stiffness = np.zeros(len(device.joints))

    def update(
        self,
        *,
        q: ArrayLike,
        theta: ArrayLike,
        tau: ArrayLike,
        readings: ArrayLike,
        rates: ArrayLike | None = None,
        setpoint: ArrayLike | None = None,
        acted: bool = False,
        time: float | None = None,
    ) -> Both:
        """Take one sample of every joint; arguments as those of observer and estimator.

        Args:
            q, theta: (n,) measured positions at the joint [rad].
            tau: (n,) motor torques at the joint [N m].
            readings, rates: of the links' sensors.
            setpoint: (n,) as logged (serial joints).
            acted: tau is what has acted since the sample before, as of ``StateObserver.update``.
            time: of the sample [s]; None: one period after the one before.
        """
        state = self.observer.update(
            theta=theta, tau=tau, readings=readings, rates=rates, setpoint=setpoint,
            stiffness=self._stiffness, acted=acted, time=time,
        )  # fmt: skip
        settled = (state.status & SETTLING) == 0
        found = self.estimator.update(
            q=q, theta=theta, torque_measured=state.torque, setpoint=setpoint, time=time,
            enable=settled.astype(np.int64),
        )  # fmt: skip
        known = found["verdict"] == INFORMATIVE
        np.copyto(self._stiffness, found.stiffness, where=known)
        return Both(state, found)

    def reset(self) -> None:
        """Forget everything: the device's stiffness again."""
        self.observer.reset()
        self.estimator.reset()
        self._stiffness[:] = 0.0
