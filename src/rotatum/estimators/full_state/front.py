"""What stands before the observers of an arm: one judgement of a sample, missing ones filled in."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.samples import MISSING, largest_jump
from rotatum.kernels import channels, guard
from rotatum.models.joint import Joint
from rotatum.record import Field, Layout
from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage

__all__ = ["Front", "FrontStep", "front_stage"]

Array = NDArray[np.float64]


@lru_cache(maxsize=16)
def front_stage(c: int) -> Stage:
    """Make the stage that judges samples of c channels together."""
    name, doc = f"front_of_{c}", "Channels of several joints, judged together."
    params = {"guard": Field(guard.GuardParams.layout(c=c))}
    state = {"guard": Field(guard.GuardState.layout(c=c))}
    return Stage(
        name,
        Layout(f"{name}_params", doc, params),
        Layout(f"{name}_state", doc, state),
        channels.ChannelsSample.layout(c=c),
        channels.ChannelsSteps.layout(c=c, m=MISSING + 1),
        channels.init,
        channels.step,
    )


class FrontStep(NamedTuple):
    """One sample for the observers, as measured or filled in.

    Args:
        time: s.
        theta, torque, setpoint: (n,) rad, N m, and as logged.
        inertial: (M,) readings of the links' sensors; NaN where there has been none for too long.
        fresh: whether what came before does not adjoin.
        hold: whether the sample was refused.
        status: status bits of the sample.
    """

    time: float
    theta: Array
    torque: Array
    setpoint: Array
    inertial: Array
    fresh: bool
    hold: bool
    status: int


class Front:
    """Judges the samples of n joints with M readings of inertial sensors.

    Motor positions, torques and set-points are judged by the guard all methods share
    (`rotatum.kernels.guard`): one that is bad makes the sample bad; a torque at its limit is not,
    because a motor at its limit gives what it is told to have given. A sensor on a link that falls
    silent does not: its reading is held for as many samples as are bridged, and then left out.

    Args:
        joints: n joints; where their encoders wrap is read off them.
        readings: M.
        period: s.
    """

    def __init__(self, joints: Sequence[Joint], readings: int, period: float) -> None:
        n = len(joints)
        stage = front_stage(3 * n)
        params = stage.params.zeros(1)
        record = params["guard"][0]
        record["period"], record["missing"] = period, MISSING
        for i, joint in enumerate(joints):
            record["jump"][i] = largest_jump(period)
            record["wrap"][i] = joint.encoders.wrap_motor or 0.0
        self.bank = Bank(stage, params)
        self._u, self._out = stage.input.zeros(1), stage.output.zeros(1)
        self._theta, self._torque, self._setpoint = self._u["y"][0].reshape(3, n)
        self._now, self._before = np.full((2, readings), np.nan)
        self._silent = np.zeros(readings, dtype=np.int64)

    def reset(self) -> None:
        """Forget everything."""
        self.bank.reset()
        self._before[:] = np.nan
        self._silent[:] = 0

    def advance(
        self, time: float, theta: Array, torque: Array, setpoint: Array, inertial: Array
    ) -> list[FrontStep]:
        """Take a sample; returns what the observers are to take, a refusal being one step.

        Args:
            time: s.
            theta, torque, setpoint: (n,) rad, N m, as logged.
            inertial: (M,) readings.
        """
        self._u["time"][0] = time
        self._theta[:], self._torque[:], self._setpoint[:] = theta, torque, setpoint
        self.bank.update(self._u, self._out)
        out = self._out[0]
        steps, status = int(out["steps"]), int(out["status"])
        if steps == 0:
            now = (self._theta, self._torque, self._setpoint, self._now)
            return [FrontStep(time, *now, fresh=False, hold=True, status=status)]
        fresh = bool(out["fresh"])
        self._listen(inertial, fresh)
        before = np.where(np.isfinite(self._before), self._before, self._now)
        found = []
        for k in range(steps):
            last = k == steps - 1
            theta, torque, setpoint = out["y"][k].reshape(3, -1)
            reading = self._now if last else before + (k + 1.0) / steps * (self._now - before)
            found.append(
                FrontStep(
                    time if last else float(out["time"][k]), theta, torque, setpoint, reading,
                    fresh=fresh and k == 0, hold=False, status=status if last else 0,
                )
            )  # fmt: skip
        self._before[:] = self._now
        return found

    def _listen(self, inertial: Array, fresh: bool) -> None:
        """Take the readings; hold those that are missing, but not for long."""
        if fresh:
            self._before[:] = np.nan
        silent = ~np.isfinite(inertial)
        self._silent[:] = np.where(silent, self._silent + 1, 0)
        held = silent & (self._silent <= MISSING)
        self._now[:] = np.where(held, self._before, inertial)
